#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "sim/wire/can/axis_bus.h"
#include "sim/wire/sockets.h"

namespace luxrig::sim {
namespace {

constexpr int kMaxCanFramesAtOnce = 1000;  // per serve(), so that a flood cannot delay the world
constexpr std::size_t kMaxMasters = 4;
constexpr Duration kForgetMaster = std::chrono::seconds(5);

/// A CAN bus as datagrams: recent senders of frames receive the nodes' frames.
class CanEndpoint final : public BusEndpoint {
 public:
  CanEndpoint(const EndpointParts& parts, BoundSocket socket, std::uint32_t address)
      : parts_(parts), bus_(parts), socket_(std::move(socket)), port_(socket_.port), address_(address) {}

  [[nodiscard]] int port() const override { return port_; }

  void serve(Time now) override {
    if (parts_.faults.find(parts_.rig.buses[parts_.bus].name, FaultKind::dead)) {
      socket_.descriptor.reset();
    } else if (!socket_.descriptor.open()) {
      if (auto again = bind_udp(port_, address_)) socket_ = std::move(*again);
    }
    bus_.advance(now);  // the axes run even without a listener
    take(now);
    for (const BusFrame& frame : bus_.take_sent()) {
      const auto bytes = packed(frame);
      for (const Master& master : masters_) {
        if (!socket_.descriptor.open()) break;
        ::sendto(socket_.descriptor.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
                 reinterpret_cast<const sockaddr*>(&master.address), sizeof master.address);
      }
    }
  }

  void descriptors(std::vector<int>& into) const override {
    if (socket_.descriptor.open()) into.push_back(socket_.descriptor.get());
  }

 private:
  struct Master {
    sockaddr_in address;
    Time heard;
  };

  void take(Time now) {
    std::erase_if(masters_, [now](const Master& master) { return now - master.heard > kForgetMaster; });
    std::array<std::uint8_t, 64> buffer;
    for (int i = 0; i < kMaxCanFramesAtOnce && socket_.descriptor.open(); ++i) {
      sockaddr_in from{};
      socklen_t length = sizeof from;
      const auto received = ::recvfrom(socket_.descriptor.get(), buffer.data(), buffer.size(), 0,
                                       reinterpret_cast<sockaddr*>(&from), &length);
      if (received < 0) {
        if (errno == EINTR || errno == ECONNREFUSED) continue;
        break;
      }
      const auto frame = unpacked({buffer.data(), static_cast<std::size_t>(received)});
      if (!frame) continue;
      const auto known = std::find_if(masters_.begin(), masters_.end(), [&](const Master& master) {
        return master.address.sin_port == from.sin_port && master.address.sin_addr.s_addr == from.sin_addr.s_addr;
      });
      if (known != masters_.end()) {
        known->heard = now;
      } else if (masters_.size() < kMaxMasters) {
        masters_.push_back({from, now});
      }
      bus_.receive(now, *frame);
    }
  }

  EndpointParts parts_;
  AxisBus bus_;
  BoundSocket socket_;
  int port_;
  std::uint32_t address_;
  std::vector<Master> masters_;
};

}  // namespace

Result<std::unique_ptr<BusEndpoint>> open_can_endpoint(const EndpointParts& parts, const EndpointPlace& place) {
  auto socket = bind_udp(place.port, place.address);
  if (!socket) return tl::unexpected(socket.error());
  return std::make_unique<CanEndpoint>(parts, std::move(*socket), place.address);
}

}  // namespace luxrig::sim
