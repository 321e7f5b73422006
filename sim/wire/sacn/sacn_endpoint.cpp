#include "sim/wire/dmx_endpoint.h"
#include "sim/wire/sacn/sacn_receiver.h"

namespace luxrig::sim {
namespace {

class SacnEndpoint final : public DmxEndpoint {
 public:
  using DmxEndpoint::DmxEndpoint;

 private:
  std::vector<Answer> receive(Time now, std::uint32_t, std::span<const std::uint8_t> packet) override {
    receiver_.receive(now, packet);
    return {};
  }
  std::optional<std::array<std::uint8_t, kDmxSlots>> levels(int universe, Time now) override {
    return receiver_.levels(universe, now);
  }

  SacnReceiver receiver_;
};

}  // namespace

Result<std::unique_ptr<BusEndpoint>> open_sacn_endpoint(const EndpointParts& parts, int port) {
  auto socket = bind_udp(port);
  if (!socket) return tl::unexpected(socket.error());
  return std::make_unique<SacnEndpoint>(parts, std::move(*socket));
}

}  // namespace luxrig::sim
