#include "tools/luxrig/addresses.h"

#include <fmt/format.h>

#include "core/rig/null_bus.h"

namespace luxrig {

std::string fixture_address(const Rig& rig, const Fixture& fixture) {
  if (is_null_bus(rig.buses[fixture.bus])) return "none yet";
  if (fixture.axes) {
    Fixture lamp = fixture;
    lamp.axes.reset();
    return fmt::format("{}; axes {}: nodes {}, {}", fixture_address(rig, lamp), rig.buses[fixture.axes->bus].name,
                       fixture.axes->pan.node, fixture.axes->tilt.node);
  }
  if (const auto* dmx = std::get_if<DmxPatch>(&fixture.patch)) {
    const auto last = dmx->address + static_cast<int>(dmx->slots.size()) - 1;
    return last > dmx->address ? fmt::format("{}.{}-{}", dmx->universe, dmx->address, last)
                               : fmt::format("{}.{}", dmx->universe, dmx->address);
  }
  const auto& modbus = std::get<ModbusPatch>(fixture.patch);
  return fmt::format("unit {} {} {}", modbus.unit, modbus.coil ? "coil" : "register", modbus.holding_register);
}

std::string meter_address(const Luxmeter& meter) {
  return fmt::format("unit {} {} {}", meter.patch.unit, meter.patch.input_registers ? "input register" : "register",
                     meter.patch.first_register);
}

std::string bus_address(const Bus& bus) {
  const auto option = [&bus](const char* key) -> std::string {
    const auto found = bus.options.find(key);
    if (found == bus.options.end()) return "";
    if (const auto* text = std::get_if<std::string>(&found->second.value)) return *text;
    if (const auto* number = std::get_if<std::int64_t>(&found->second.value)) return fmt::format("{}", *number);
    return "";
  };
  for (const char* key : {"host", "destination", "device", "interface", "serial", "usb_port"}) {
    const std::string where = option(key), port = option("port");
    if (!where.empty()) return port.empty() ? where : where + ":" + port;
  }
  return "";
}

}  // namespace luxrig
