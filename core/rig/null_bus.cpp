#include "core/rig/null_bus.h"

#include <fmt/format.h>

#include <algorithm>

namespace luxrig {

std::vector<Problem> null_buses_in_use(const Rig& rig) {
  std::vector<Problem> problems;
  for (std::size_t b = 0; b < rig.buses.size(); ++b) {
    const Bus& bus = rig.buses[b];
    if (!is_null_bus(bus)) continue;
    const auto lamp = std::find_if(rig.fixtures.begin(), rig.fixtures.end(), [&](const Fixture& fixture) {
      return fixture.bus == b || (fixture.axes && fixture.axes->bus == b);
    });
    const auto meter =
        std::find_if(rig.luxmeters.begin(), rig.luxmeters.end(), [&](const Luxmeter& m) { return m.bus == b; });
    if (lamp == rig.fixtures.end() && meter == rig.luxmeters.end()) continue;
    problems.push_back(
        {rig.file.string(), bus.in_file.line, bus.in_file.column,
         fmt::format("bus \"{}\" is a null bus: what hangs on it, such as {}, can be planned and not run", bus.name,
                     lamp != rig.fixtures.end() ? lamp->name : meter->name),
         "give it the driver of the real one, and what hangs on it its address"});
  }
  return problems;
}

}  // namespace luxrig
