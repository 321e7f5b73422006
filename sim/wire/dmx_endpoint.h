#pragma once
/// What sACN and Art-Net have in common here: a UDP port, frames that may be lost, late or spoiled, and fixtures that
/// read their slots.

#include <array>
#include <deque>
#include <optional>

#include "sim/devices/dmx_fixture.h"
#include "sim/wire/bus_endpoint.h"
#include "sim/wire/sockets.h"

namespace luxrig::sim {

class DmxEndpoint : public BusEndpoint {
 public:
  DmxEndpoint(const EndpointParts& parts, BoundSocket socket);

  [[nodiscard]] int port() const override { return port_; }
  void serve(Time now) override;
  void descriptors(std::vector<int>& into) const override;

 protected:
  using Packet = std::vector<std::uint8_t>;
  /// One packet from the network; returns what to send back to its sender. `from`: IPv4 address.
  virtual std::vector<Packet> receive(Time now, std::uint32_t from, std::span<const std::uint8_t> packet) = 0;
  virtual std::optional<std::array<std::uint8_t, kDmxSlots>> levels(int universe, Time now) = 0;

  EndpointParts parts_;

 private:
  struct Arrived {
    Time due;
    std::uint32_t address;  ///< IPv4, host order
    std::uint16_t port;
    Packet bytes;
  };

  void take(Time now);

  BoundSocket socket_;
  int port_;
  std::deque<Arrived> arrived_;
  std::uint64_t packets_ = 0, frames_ = 0;
};

}  // namespace luxrig::sim
