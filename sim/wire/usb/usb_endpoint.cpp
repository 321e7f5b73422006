#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>

#include "sim/devices/usb/usb_widgets.h"
#include "sim/wire/bus_endpoint.h"
#include "sim/wire/dmx_fixtures.h"
#include "sim/wire/rdm_fixtures.h"
#include "sim/wire/sockets.h"
#include "sim/wire/usb/usbip_session.h"

namespace luxrig::sim {
namespace {

/// A widget behind a USB/IP server. The fault `dead` unplugs it; plugged in again, it has forgotten everything.
class UsbEndpoint final : public BusEndpoint {
 public:
  UsbEndpoint(const EndpointParts& parts, std::unique_ptr<UsbDevice> device, BoundSocket listener,
              std::uint32_t address)
      : parts_(parts),
        device_(std::move(device)),
        fixtures_(parts.rig, parts.bus, parts.world, parts.faults),
        listener_(std::move(listener)),
        port_(listener_.port),
        address_(address) {
    // A widget has one line, whatever its universe number.
    device_->connect([this](Time now, std::span<const std::uint8_t> packet) {
      auto& lines = fixtures_.lines();
      return lines.empty() ? std::vector<std::uint8_t>{} : lines.begin()->second.exchange(now, packet).bytes;
    });
  }

  [[nodiscard]] int port() const override { return port_; }

  void serve(Time now) override {
    lamp_faults_.obey(parts_.rig, parts_.bus, parts_.faults, parts_.world);
    if (parts_.faults.find(parts_.rig.buses[parts_.bus].name, FaultKind::dead)) {
      listener_.descriptor.reset();
      hang_up();
      plugged_in_ = false;
      return;
    }
    if (!listener_.descriptor.open()) {
      if (auto again = listen_tcp(port_, address_)) listener_ = std::move(*again);
    }
    if (!plugged_in_) {
      plugged_in_ = true;
      device_->power_on(now);
    }
    accept();
    if (!session_) return;
    const std::uint64_t before = session_->begun();
    take(now);
    if (!session_) return;
    session_->serve(now);
    send();
    if (session_ && session_->begun() == before) return;
    ++frames_;
    fixtures_.shine(now);
    obey_dmx(
        parts_, frames_, [&](int) { return device_->line(now); },
        [this](std::size_t fixture) { return fixtures_.moved_by(fixture); });
  }

  void descriptors(std::vector<int>& into) const override {
    if (listener_.descriptor.open()) into.push_back(listener_.descriptor.get());
    if (client_.open()) into.push_back(client_.get());
  }

 private:
  void accept() {
    while (listener_.descriptor.open()) {
      Descriptor client(::accept4(listener_.descriptor.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
      if (!client.open()) return;
      const int yes = 1;
      ::setsockopt(client.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
      hang_up();  // one host at a time: the newest wins
      client_ = std::move(client);
      session_.emplace(*device_, UsbipSession::Beginning::handshake, [this] {
        return parts_.faults.disturbance({&parts_.rig.buses[parts_.bus].name, 1}, transfers_++);
      });
    }
  }

  void take(Time now) {
    std::array<std::uint8_t, 4096> bytes;
    while (client_.open()) {
      const auto got = ::recv(client_.get(), bytes.data(), bytes.size(), 0);
      if (got < 0 && errno == EINTR) continue;
      if (got < 0 && errno == EAGAIN) return;
      if (got <= 0) return hang_up();
      session_->receive(now, {bytes.data(), static_cast<std::size_t>(got)});
      if (session_->is_broken()) return hang_up();
    }
  }

  void send() {
    const auto more = session_->take_output();
    unsent_.insert(unsent_.end(), more.begin(), more.end());
    if (unsent_.empty() || !client_.open()) return;
    const auto sent = ::send(client_.get(), unsent_.data(), unsent_.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && errno != EAGAIN && errno != EINTR) return hang_up();
    if (sent > 0) unsent_.erase(unsent_.begin(), unsent_.begin() + sent);
    if (session_->is_broken()) hang_up();
  }

  void hang_up() {
    client_.reset();
    session_.reset();
    unsent_.clear();
  }

  EndpointParts parts_;
  LampFaults lamp_faults_;
  std::unique_ptr<UsbDevice> device_;
  RdmFixtures fixtures_;
  BoundSocket listener_;
  int port_;
  std::uint32_t address_;
  Descriptor client_;
  std::optional<UsbipSession> session_;
  std::vector<std::uint8_t> unsent_;
  bool plugged_in_ = false;
  std::uint64_t transfers_ = 0, frames_ = 0;
};

}  // namespace

Result<std::unique_ptr<BusEndpoint>> open_usb_endpoint(const EndpointParts& parts, const EndpointPlace& place) {
  auto device = make_usb_widget(parts.rig.buses[parts.bus].driver);
  if (!device) return tl::unexpected(Fault{Cause::invalid, "", "no simulated widget for this driver", {}});
  auto listener = listen_tcp(place.port, place.address);
  if (!listener) return tl::unexpected(listener.error());
  return std::make_unique<UsbEndpoint>(parts, std::move(device), std::move(*listener), place.address);
}

}  // namespace luxrig::sim
