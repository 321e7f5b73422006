#include "sim/wire/rig_server.h"

namespace luxrig::sim {

Result<std::unique_ptr<RigServer>> RigServer::open(const Rig& rig, World& world, Faults& faults,
                                                   const std::map<std::string, EndpointPlace>& places) {
  auto server = std::make_unique<RigServer>();
  for (std::size_t b = 0; b < rig.buses.size(); ++b) {
    const auto place = places.find(rig.buses[b].name);
    auto endpoint = open_endpoint({rig, b, world, faults}, place != places.end() ? place->second : EndpointPlace{});
    if (!endpoint) {
      Fault fault = endpoint.error();
      fault.device = rig.buses[b].name;
      return tl::unexpected(std::move(fault));
    }
    server->endpoints_.emplace_back(rig.buses[b].name, std::move(*endpoint));
  }
  return server;
}

std::map<std::string, int> RigServer::ports() const {
  std::map<std::string, int> ports;
  for (const auto& [bus, endpoint] : endpoints_) {
    if (endpoint->path().empty()) ports[bus] = endpoint->port();
  }
  return ports;
}

std::map<std::string, std::string> RigServer::paths() const {
  std::map<std::string, std::string> paths;
  for (const auto& [bus, endpoint] : endpoints_) {
    if (!endpoint->path().empty()) paths[bus] = endpoint->path();
  }
  return paths;
}

void RigServer::serve(Time now) {
  for (const auto& [bus, endpoint] : endpoints_) endpoint->serve(now);
}

std::vector<int> RigServer::descriptors() const {
  std::vector<int> descriptors;
  for (const auto& [bus, endpoint] : endpoints_) endpoint->descriptors(descriptors);
  return descriptors;
}

}  // namespace luxrig::sim
