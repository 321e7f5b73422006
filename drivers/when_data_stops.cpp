#include "drivers/when_data_stops.h"

#include <fmt/format.h>

#include "core/check.h"
#include "core/rig/null_bus.h"
#include "drivers/can/canopen_driver.h"
#include "drivers/registry.h"

namespace luxrig {

const char* name_of(WithoutData does) {
  switch (does) {
    case WithoutData::holds:
      return "holds";
    case WithoutData::goes_dark:
      return "goes_dark";
    case WithoutData::makers_choice:
      return "makers_choice";
  }
  return "unknown";
}

std::vector<OutputWithoutData> outputs_without_data(const Rig& rig) {
  std::vector<OutputWithoutData> outputs;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    const Fixture& fixture = rig.fixtures[f];
    const Bus& bus = rig.buses[fixture.bus];
    WhenDataStops lamp{WithoutData::makers_choice, std::nullopt, "its bus is yet to be chosen"};
    if (!is_null_bus(bus)) {
      const DriverEntry* entry = find_driver(bus.driver);
      LUXRIG_CHECK(entry != nullptr && entry->when_data_stops != nullptr, "no lamp hangs on {}", bus.driver);
      lamp = entry->when_data_stops(rig, f);
    }
    outputs.push_back({f, std::move(lamp), std::nullopt});
    if (fixture.axes && !is_null_bus(rig.buses[fixture.axes->bus]))
      outputs.back().axes = canopen_axes_without_data(rig, f);
  }
  return outputs;
}

std::string told(const WhenDataStops& lamp) {
  const std::string when = lamp.after_s ? fmt::format(" after {:g} s", *lamp.after_s) : "";
  switch (lamp.does) {
    case WithoutData::holds:
      return "holds its last level";
    case WithoutData::goes_dark:
      return "goes dark" + when;
    case WithoutData::makers_choice:
      return lamp.after_s ? "noticed" + when + "; then its maker's choice" : "nobody says";
  }
  return "";
}

std::string told(const AxesWithoutData& axes) {
  return fmt::format("pan and tilt stop after {:g} s and {}", axes.after_s,
                     axes.released ? "are switched off" : "hold their place");
}

}  // namespace luxrig
