#pragma once
/// A simulated rig on the wire: one endpoint per [[bus]], all on one World. The caller owns the clock:
///
///   world.advance(now); server->serve(now); … poll(server->descriptors(), until the next tick) …

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sim/wire/bus_endpoint.h"

namespace luxrig::sim {

class RigServer {
 public:
  /// `places`: wanted places of endpoints, by bus name; any other gets a free one on 127.0.0.1. The other arguments
  /// outlive the server.
  static Result<std::unique_ptr<RigServer>> open(const Rig& rig, World& world, Faults& faults,
                                                 const std::map<std::string, EndpointPlace>& places = {});

  [[nodiscard]] std::map<std::string, int> ports() const;          ///< by bus name; only buses with a port
  [[nodiscard]] std::map<std::string, std::string> paths() const;  ///< by bus name; only serial lines
  void serve(Time now);                                            ///< never blocks
  [[nodiscard]] std::vector<int> descriptors() const;              ///< to poll for reading

 private:
  std::vector<std::pair<std::string, std::unique_ptr<BusEndpoint>>> endpoints_;
};

}  // namespace luxrig::sim
