#include "sim/wire/standard_ports.h"

#include <fmt/format.h>

namespace luxrig::sim {
namespace {

struct StandardPort {
  std::string_view driver, protocol;
  int port;
  int unprivileged = 0;  ///< where the port needs a privilege
};

constexpr StandardPort kStandardPorts[] = {
    {"sacn", "sACN", 5568}, {"artnet", "Art-Net", 6454}, {"modbus_tcp", "Modbus TCP", 502, 1502}};

}  // namespace

std::vector<std::string> use_standard_ports(const Rig& rig, const std::function<bool(int)>& may_listen_on,
                                            std::map<std::string, EndpointPlace>& places) {
  std::vector<std::string> notes;
  for (const StandardPort& standard : kStandardPorts) {
    int port = standard.port;
    if (standard.unprivileged != 0 && !may_listen_on(port)) port = standard.unprivileged;
    std::string first;
    for (const Bus& bus : rig.buses) {
      if (bus.driver != standard.driver) continue;
      EndpointPlace& place = places[bus.name];
      place.port = port++;
      place.among_others = true;
      if (!first.empty()) {
        notes.push_back(fmt::format("{}: {} has {} port {}, so this bus has {}: tell your software", bus.name, first,
                                    standard.protocol, places[first].port, place.port));
        continue;
      }
      first = bus.name;
      if (place.port != standard.port)
        notes.push_back(fmt::format("{}: {} on port {}, as {} needs root or CAP_NET_BIND_SERVICE", bus.name,
                                    standard.protocol, place.port, standard.port));
    }
  }
  return notes;
}

}  // namespace luxrig::sim
