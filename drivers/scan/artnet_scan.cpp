#include <fmt/format.h>

#include "drivers/dmx/artnet/artnet_controller.h"
#include "drivers/io/udp.h"
#include "drivers/scan/scan.h"

namespace luxrig {
namespace {

constexpr int kAnswersPerStep = 256;

class ArtnetScan final : public Scan {
 public:
  explicit ArtnetScan(const ScanOptions& options) : poll_to_{0xFFFFFFFF, artnet::kPort} {
    if (const auto address = parse_ipv4(options.broadcast)) poll_to_.ipv4 = *address;
    UdpSettings settings;
    settings.local_port = artnet::kPort;  // nodes answer to this port, some by broadcast
    settings.share_local_port = true;
    settings.broadcast = true;
    channel_ = make_udp(std::move(settings));
  }

  Result<void> step(Time now) override {
    if (auto opened = channel_->open(); !opened) return opened;
    while (channel_->take_error()) {
    }
    if (controller_.poll_due(now)) {
      if (auto sent = channel_->send(poll_to_, artnet::encode_poll()); !sent) return sent;
    }
    for (int i = 0; i < kAnswersPerStep; ++i) {
      const auto datagram = channel_->receive();
      if (!datagram) break;
      (void)controller_.hear(now, *datagram);
    }
    return {};
  }

  std::vector<FoundDevice> found() const override {
    std::vector<FoundDevice> devices;
    for (const auto& [address, node] : controller_.nodes()) {
      std::string universes;
      for (const auto& [bind_index, outputs] : node.outputs) {
        for (const artnet::PortOutput& output : outputs) {
          universes += fmt::format("{}{} ({}){}", universes.empty() ? "puts out universe " : ", ", output.port_address,
                                   artnet::text_of_port_address(output.port_address),
                                   output.merging ? ", merging two senders" : "");
        }
      }
      devices.push_back({"artnet", text_of(address.ipv4), node.name,
                         universes.empty() ? "puts out no universe" : std::move(universes)});
    }
    return devices;
  }

 private:
  SocketAddress poll_to_;
  std::unique_ptr<DatagramChannel> channel_;
  artnet::Controller controller_{{}};
};

}  // namespace

std::unique_ptr<Scan> make_artnet_scan(const ScanOptions& options) { return std::make_unique<ArtnetScan>(options); }

}  // namespace luxrig
