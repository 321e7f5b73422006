#include "sim/wire/artnet/artnet_node.h"
#include "sim/wire/dmx_endpoint.h"

namespace luxrig::sim {
namespace {

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
      : DmxEndpoint(parts, std::move(socket)), node_(port_addresses_of(parts)) {}

 private:
  std::vector<Packet> receive(Time now, std::uint32_t from, std::span<const std::uint8_t> packet) override {
    return node_.receive(now, from, packet);
  }
  std::optional<std::array<std::uint8_t, kDmxSlots>> levels(int universe, Time now) override {
    return node_.levels(universe, now);
  }

  ArtnetNode node_;
};

}  // namespace

Result<std::unique_ptr<BusEndpoint>> open_artnet_endpoint(const EndpointParts& parts, int port) {
  auto socket = bind_udp(port);
  if (!socket) return tl::unexpected(socket.error());
  return std::make_unique<ArtnetEndpoint>(parts, std::move(*socket));
}

}  // namespace luxrig::sim
