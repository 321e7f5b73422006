#include "drivers/modbus/modbus_data_loss.h"

#include "core/rig/register_map/register_map.h"

namespace luxrig {

WhenDataStops modbus_when_data_stops(const Rig& rig, std::size_t fixture) {
  const auto& patch = std::get<ModbusPatch>(rig.fixtures[fixture].patch);
  if (!patch.map) return {WithoutData::makers_choice, std::nullopt, "Modbus does not: give its product's register_map"};
  const RegisterMap& map = *patch.map;
  if (map.when_data_stops == DataLoss::hold || !map.stops_after) return {WithoutData::holds, std::nullopt, map.name};
  return {WithoutData::goes_dark, to_seconds(*map.stops_after),
          map.name + (map.when_data_stops == DataLoss::watchdog ? ", its watchdog, which Luxrig arms" : "")};
}

}  // namespace luxrig
