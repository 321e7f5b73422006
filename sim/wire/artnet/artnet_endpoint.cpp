#include "sim/wire/artnet/artnet_node.h"
#include "sim/wire/artnet/artnet_rdm_gate.h"
#include "sim/wire/dmx_endpoint.h"
#include "sim/wire/rdm_fixtures.h"

namespace luxrig::sim {
namespace {

constexpr Duration kWarmEvery = std::chrono::milliseconds(100);

class ArtnetEndpoint final : public DmxEndpoint {
 public:
  ArtnetEndpoint(const EndpointParts& parts, const EndpointPlace& place, std::vector<std::uint32_t> groups, Ear ear)
      : DmxEndpoint(parts, place, std::move(groups), std::move(ear)),
        node_(universes_of(parts.rig, parts.bus)),
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
    for (Packet& reply : node_.receive(now, from, packet, is_art_poll(packet) ? address_for(from) : kLoopback))
      answers.push_back({std::move(reply), {}});
    for (ArtnetRdmGate::Answer& answer : gate_.receive(now, packet)) {
      answers.push_back({std::move(answer.packet), answer.late});
    }
    return answers;
  }
  [[nodiscard]] int moved_by(std::size_t fixture) const override { return fixtures_.moved_by(fixture); }
  std::optional<std::array<std::uint8_t, kDmxSlots>> levels(int universe, Time now) override {
    return node_.levels(universe, now);
  }

  [[nodiscard]] std::uint32_t address_for(std::uint32_t peer) const {
    return place_.address == kAnyAddress ? own_address_towards(peer) : place_.address;
  }

  ArtnetNode node_;
  RdmFixtures fixtures_;
  ArtnetRdmGate gate_;
  Time shone_{};
};

}  // namespace

Result<std::unique_ptr<BusEndpoint>> open_artnet_endpoint(const EndpointParts& parts, const EndpointPlace& place) {
  return open_dmx_endpoint<ArtnetEndpoint>(parts, place, {});
}

}  // namespace luxrig::sim
