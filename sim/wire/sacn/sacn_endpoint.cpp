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

Result<std::unique_ptr<BusEndpoint>> open_sacn_endpoint(const EndpointParts& parts, const EndpointPlace& place) {
  std::vector<std::uint32_t> groups;
  for (const int universe : universes_of(parts.rig, parts.bus)) groups.push_back(sacn_group(universe));
  return open_dmx_endpoint<SacnEndpoint>(parts, place, std::move(groups));
}

}  // namespace luxrig::sim
