#pragma once
/// The far end of one [[bus]]: a loopback port, or a pseudo terminal for a serial line, that behaves as the devices of
/// that bus do.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/rig/rig.h"
#include "sim/faults/faults.h"
#include "sim/lamp_faults.h"
#include "sim/world/world.h"

namespace luxrig::sim {

class BusEndpoint {
 public:
  virtual ~BusEndpoint() = default;
  [[nodiscard]] virtual int port() const = 0;  ///< 0: it has a path
  /// Where a program opens it as its serial port; empty: it has a port.
  [[nodiscard]] virtual std::string path() const { return {}; }
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

/// Where an endpoint shall be: at a port (0 = any free one), or at a path (empty: a new one).
struct EndpointPlace {
  int port = 0;
  std::string path{};
};

/// Cause::invalid for a driver that has no far end here.
[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_endpoint(const EndpointParts& parts,
                                                                 const EndpointPlace& place);
[[nodiscard]] inline Result<std::unique_ptr<BusEndpoint>> open_endpoint(const EndpointParts& parts, int port) {
  return open_endpoint(parts, EndpointPlace{port});
}

[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_sacn_endpoint(const EndpointParts& parts, int port);
[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_artnet_endpoint(const EndpointParts& parts, int port);
/// A widget behind a USB/IP server.
[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_usb_endpoint(const EndpointParts& parts, int port);
[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_modbus_endpoint(const EndpointParts& parts, int port);
[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_modbus_rtu_endpoint(const EndpointParts& parts,
                                                                            const std::string& path);
[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_can_endpoint(const EndpointParts& parts, int port);

}  // namespace luxrig::sim
