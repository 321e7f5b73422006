#pragma once
/// The far end of one [[bus]]: a port of this machine, or a pseudo terminal for a serial line, that behaves like the
/// devices of that bus.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/rig/rig.h"
#include "sim/faults/faults.h"
#include "sim/lamp_faults.h"
#include "sim/wire/sockets.h"
#include "sim/world/world.h"

namespace luxrig::sim {

class BusEndpoint {
 public:
  virtual ~BusEndpoint() = default;
  [[nodiscard]] virtual int port() const = 0;  ///< 0 = it has a path
  /// Path of the serial port that a program opens; empty = it has a port.
  [[nodiscard]] virtual std::string path() const { return {}; }
  /// Takes received data and sends due answers. Never blocks.
  virtual void serve(Time now) = 0;
  /// Adds descriptors that a caller may poll for reading.
  virtual void descriptors(std::vector<int>& into) const = 0;
};

/// Context of an endpoint. All parts outlive it.
struct EndpointParts {
  const Rig& rig;
  std::size_t bus;
  World& world;
  Faults& faults;
};

/// Wanted place of an endpoint: a port (0 = any free one) of an address, or a path (empty = a new one).
struct EndpointPlace {
  int port = 0;
  std::string path{};
  std::uint32_t address = kLoopback;
  /// As a device in a network of others, for sACN and Art-Net: hears multicast and broadcast as well, shares the port
  /// with programs on this machine, and answers to the standard port of a sender too.
  bool among_others = false;
};

/// Cause::invalid for a driver that the simulator does not support.
[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_endpoint(const EndpointParts& parts,
                                                                 const EndpointPlace& place);
[[nodiscard]] inline Result<std::unique_ptr<BusEndpoint>> open_endpoint(const EndpointParts& parts, int port) {
  return open_endpoint(parts, EndpointPlace{port});
}

[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_sacn_endpoint(const EndpointParts& parts,
                                                                      const EndpointPlace& place);
[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_artnet_endpoint(const EndpointParts& parts,
                                                                        const EndpointPlace& place);
/// A widget behind a USB/IP server.
[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_usb_endpoint(const EndpointParts& parts,
                                                                     const EndpointPlace& place);
[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_modbus_endpoint(const EndpointParts& parts,
                                                                        const EndpointPlace& place);
[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_modbus_rtu_endpoint(const EndpointParts& parts,
                                                                            const EndpointPlace& place);
[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_can_endpoint(const EndpointParts& parts,
                                                                     const EndpointPlace& place);

}  // namespace luxrig::sim
