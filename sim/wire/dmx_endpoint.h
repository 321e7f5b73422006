#pragma once
/// Common part of sACN and Art-Net: a UDP port, multicast and broadcast if it is among others, frames that may be lost, late or garbled, and fixtures that read their
/// slots.

#include <array>
#include <deque>
#include <optional>

#include "sim/devices/dmx_fixture.h"
#include "sim/wire/bus_endpoint.h"
#include "sim/wire/sockets.h"

namespace luxrig::sim {

/// Universes (Art-Net: port addresses) of the fixtures on a bus, each once.
[[nodiscard]] std::vector<int> universes_of(const Rig& rig, std::size_t bus);
/// IPv4 multicast group of a sACN universe (E1.31, 9.3.1).
[[nodiscard]] constexpr std::uint32_t sacn_group(int universe) {
  return 0xefff0000u | (static_cast<std::uint32_t>(universe) & 0xffff);
}

class DmxEndpoint : public BusEndpoint {
 public:
  struct Ear {
    BoundSocket own;                 ///< receives what is sent to its address; answers
    std::vector<Descriptor> shared;  ///< receive multicast and broadcast
  };
  /// `groups`: of multicast, if the place is among others.
  [[nodiscard]] static Result<Ear> listen(const EndpointPlace& place, std::span<const std::uint32_t> groups);

  /// `place`: with the port that `ear` has.
  DmxEndpoint(const EndpointParts& parts, EndpointPlace place, std::vector<std::uint32_t> groups, Ear ear);
  void keep(Descriptor claim) { claim_ = std::move(claim); }

  [[nodiscard]] int port() const override { return place_.port; }
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
  EndpointPlace place_;

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

  void take(Time now, int descriptor);
  void obey(Time now, const Arrived& packet);
  void send_owed(Time now);

  std::vector<std::uint32_t> groups_;
  Ear ear_;
  Descriptor claim_;  ///< on the port, while the endpoint exists
  std::deque<Arrived> arrived_;
  std::vector<Arrived> overtaken_;
  std::vector<Owed> owed_;  ///< in order of creation
  LampFaults lamp_faults_;
  std::uint64_t packets_ = 0, frames_ = 0;
};

template <class Endpoint>
[[nodiscard]] Result<std::unique_ptr<BusEndpoint>> open_dmx_endpoint(const EndpointParts& parts, EndpointPlace place,
                                                                     std::vector<std::uint32_t> groups) {
  auto ear = DmxEndpoint::listen(place, groups);
  if (!ear) return tl::unexpected(ear.error());
  place.port = ear->own.port;
  Descriptor claim;
  if (place.among_others) {
    auto claimed = claim_udp(place.port, place.address);
    if (!claimed) return tl::unexpected(claimed.error());
    claim = std::move(*claimed);
  }
  auto endpoint = std::make_unique<Endpoint>(parts, place, std::move(groups), std::move(*ear));
  endpoint->keep(std::move(claim));
  return endpoint;
}

}  // namespace luxrig::sim
