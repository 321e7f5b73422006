#include "sim/wire/bus_endpoint.h"

#include <fmt/format.h>

namespace luxrig::sim {
namespace {

struct EndpointEntry {
  std::string_view driver;
  /// One of the two is set: at a port, or at a path.
  Result<std::unique_ptr<BusEndpoint>> (*at_port)(const EndpointParts& parts, int port);
  Result<std::unique_ptr<BusEndpoint>> (*at_path)(const EndpointParts& parts, const std::string& path) = nullptr;
};

// One line per driver that the simulator can stand in for.
constexpr EndpointEntry kEndpoints[] = {
    {"sacn", open_sacn_endpoint},
    {"artnet", open_artnet_endpoint},
    {"enttec_pro", open_usb_endpoint},
    {"open_dmx", open_usb_endpoint},
    {"udmx", open_usb_endpoint},
    {"modbus_tcp", open_modbus_endpoint},
    {"modbus_rtu", nullptr, open_modbus_rtu_endpoint},
    {"canopen", open_can_endpoint},
};

}  // namespace

Result<std::unique_ptr<BusEndpoint>> open_endpoint(const EndpointParts& parts, const EndpointPlace& place) {
  const Bus& bus = parts.rig.buses[parts.bus];
  std::string known;
  for (const EndpointEntry& entry : kEndpoints) {
    if (entry.driver == bus.driver) {
      return entry.at_port != nullptr ? entry.at_port(parts, place.port) : entry.at_path(parts, place.path);
    }
    known += fmt::format("{}{}", known.empty() ? "" : ", ", entry.driver);
  }
  return tl::unexpected(
      Fault{Cause::invalid,
            bus.name,
            fmt::format("driver '{}' cannot be simulated over the wire: use one of {}", bus.driver, known),
            {}});
}

}  // namespace luxrig::sim
