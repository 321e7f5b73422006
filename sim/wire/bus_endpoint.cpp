#include "sim/wire/bus_endpoint.h"

#include <fmt/format.h>

namespace luxrig::sim {
namespace {

struct EndpointEntry {
  std::string_view driver;
  Result<std::unique_ptr<BusEndpoint>> (*open)(const EndpointParts& parts, const EndpointPlace& place);
};

// One line per driver that the simulator can stand in for.
constexpr EndpointEntry kEndpoints[] = {
    {"sacn", open_sacn_endpoint},
    {"artnet", open_artnet_endpoint},
    {"enttec_pro", open_usb_endpoint},
    {"open_dmx", open_usb_endpoint},
    {"udmx", open_usb_endpoint},
    {"modbus_tcp", open_modbus_endpoint},
    {"modbus_rtu", open_modbus_rtu_endpoint},
    {"canopen", open_can_endpoint},
};

}  // namespace

Result<std::unique_ptr<BusEndpoint>> open_endpoint(const EndpointParts& parts, const EndpointPlace& place) {
  const Bus& bus = parts.rig.buses[parts.bus];
  std::string known;
  for (const EndpointEntry& entry : kEndpoints) {
    if (entry.driver == bus.driver) return entry.open(parts, place);
    known += fmt::format("{}{}", known.empty() ? "" : ", ", entry.driver);
  }
  return tl::unexpected(
      Fault{Cause::invalid,
            bus.name,
            fmt::format("driver '{}' cannot be simulated over the wire: use one of {}", bus.driver, known),
            {}});
}

}  // namespace luxrig::sim
