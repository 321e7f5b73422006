#include "sim/wire/artnet/artnet_node.h"
#include "sim/wire/artnet/artnet_rdm_gate.h"
#include "sim/wire/dmx_endpoint.h"
#include "sim/wire/rdm_fixtures.h"

namespace luxrig::sim {
namespace {

constexpr Duration kWarmEvery = std::chrono::milliseconds(100);

std::vector<int> port_addresses_of(const EndpointParts& parts) {
  std::vector<int> port_addresses;
  for (const Fixture& fixture : parts.rig.fixtures) {
    const auto* patch = std::get_if<DmxPatch>(&fixture.patch);
    if (fixture.bus == parts.bus && patch != nullptr) port_addresses.push_back(patch->universe);
  }
  return port_addresses;
}

class ArtnetEndpoint final : public DmxEndpoint {
 public:
  ArtnetEndpoint(const EndpointParts& parts, BoundSocket socket)
      : DmxEndpoint(parts, std::move(socket)),
        node_(port_addresses_of(parts)),
        fixtures_(parts.rig, parts.bus, parts.world, parts.faults),
        gate_(fixtures_.lines()) {}

  void serve(Time now) override {
    if (now - shone_ >= kWarmEvery) {
      shone_ = now;
      fixtures_.shine(now);
    }
    DmxEndpoint::serve(now);
  }

 private:
  std::vector<Answer> receive(Time now, std::uint32_t from, std::span<const std::uint8_t> packet) override {
    std::vector<Answer> answers;
    for (Packet& reply : node_.receive(now, from, packet)) answers.push_back({std::move(reply), {}});
    for (ArtnetRdmGate::Answer& answer : gate_.receive(now, packet)) {
      answers.push_back({std::move(answer.packet), answer.late});
    }
    return answers;
  }
  [[nodiscard]] int moved_by(std::size_t fixture) const override { return fixtures_.moved_by(fixture); }
  std::optional<std::array<std::uint8_t, kDmxSlots>> levels(int universe, Time now) override {
    return node_.levels(universe, now);
  }

  ArtnetNode node_;
  RdmFixtures fixtures_;
  ArtnetRdmGate gate_;
  Time shone_{};
};

}  // namespace

Result<std::unique_ptr<BusEndpoint>> open_artnet_endpoint(const EndpointParts& parts, int port) {
  auto socket = bind_udp(port);
  if (!socket) return tl::unexpected(socket.error());
  return std::make_unique<ArtnetEndpoint>(parts, std::move(*socket));
}

}  // namespace luxrig::sim
