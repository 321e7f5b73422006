#pragma once
/// The far end of one [[bus]]: a loopback port that behaves as the devices of that bus do.

#include <memory>
#include <string_view>
#include <vector>

#include "core/rig/rig.h"
#include "sim/faults/faults.h"
#include "sim/world/world.h"

namespace luxrig::sim {

class BusEndpoint {
 public:
  virtual ~BusEndpoint() = default;
  [[nodiscard]] virtual int port() const = 0;
  /// Takes what has arrived and answers what is due. Never blocks.
  virtual void serve(Time now) = 0;
  /// Adds what a caller may poll for reading.
  virtual void descriptors(std::vector<int>& into) const = 0;
};

/// What an endpoint stands between. All outlive it.
struct EndpointParts {
  const Rig& rig;
  std::size_t bus;
  World& world;
  Faults& faults;
};

/// `port` 0 = any free one. Cause::invalid for a driver that has no far end here.
[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_endpoint(const EndpointParts& parts, int port);

[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_sacn_endpoint(const EndpointParts& parts, int port);
[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_artnet_endpoint(const EndpointParts& parts, int port);
[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_modbus_endpoint(const EndpointParts& parts, int port);
[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_can_endpoint(const EndpointParts& parts, int port);

}  // namespace luxrig::sim
