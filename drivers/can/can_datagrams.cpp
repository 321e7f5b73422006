#include "drivers/can/can_datagrams.h"

namespace luxrig::can {
namespace {

class CanDatagrams final : public CanChannel {
 public:
  CanDatagrams(SocketAddress bus, std::unique_ptr<DatagramChannel> udp) : bus_(bus), udp_(std::move(udp)) {}

  Result<void> open() override { return udp_->open(); }
  void close() override { udp_->close(); }
  bool is_open() const override { return udp_->is_open(); }

  Result<Sent> send(const CanFrame& frame) override {
    if (auto sent = udp_->send(bus_, to_bytes(frame)); !sent) return tl::unexpected(sent.error());
    return Sent::yes;
  }
  std::optional<CanFrame> receive() override {
    while (udp_->is_open()) {
      const auto datagram = udp_->receive();
      if (!datagram) break;
      if (datagram->from != bus_) continue;
      if (auto frame = from_bytes(datagram->bytes)) return frame;
    }
    return std::nullopt;
  }
  std::optional<Fault> take_error() override { return udp_->is_open() ? udp_->take_error() : std::nullopt; }

 private:
  SocketAddress bus_;
  std::unique_ptr<DatagramChannel> udp_;
};

}  // namespace

std::unique_ptr<CanChannel> make_can_datagrams(SocketAddress bus, std::unique_ptr<DatagramChannel> udp) {
  return std::make_unique<CanDatagrams>(bus, std::move(udp));
}

}  // namespace luxrig::can
