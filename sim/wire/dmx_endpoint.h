#pragma once
/// Common part of sACN and Art-Net: a UDP port, frames that may be lost, late or garbled, and fixtures that read their
/// slots.

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
  struct Answer {
    Packet packet;
    Duration late{};  ///< delay of the answer
  };
  /// Takes one packet from the network; returns the answers to its sender. `from`: IPv4 address.
  virtual std::vector<Answer> receive(Time now, std::uint32_t from, std::span<const std::uint8_t> packet) = 0;
  virtual std::optional<std::array<std::uint8_t, kDmxSlots>> levels(int universe, Time now) = 0;
  /// Offset in slots from the rig file's address to the fixture's present one.
  [[nodiscard]] virtual int moved_by(std::size_t) const { return 0; }

  EndpointParts parts_;

 private:
  struct Arrived {
    Time due;
    std::uint32_t address;  ///< IPv4, host order
    std::uint16_t port;
    Packet bytes;
  };

  struct Owed {
    Time due;
    std::uint32_t address;  ///< IPv4, host order
    std::uint16_t port;
    Packet bytes;
  };

  void take(Time now);
  void obey(Time now, const Arrived& packet);
  void send_owed(Time now);

  BoundSocket socket_;
  int port_;
  std::deque<Arrived> arrived_;
  std::vector<Arrived> overtaken_;
  std::vector<Owed> owed_;  ///< in order of creation
  LampFaults lamp_faults_;
  std::uint64_t packets_ = 0, frames_ = 0;
};

}  // namespace luxrig::sim
