#include <fmt/format.h>

#include <map>
#include <set>

#include "drivers/dmx/sacn/sacn_codec.h"
#include "drivers/io/udp.h"
#include "drivers/scan/scan.h"

namespace luxrig {
namespace {

constexpr int kPacketsPerStep = 256;
constexpr std::size_t kMaxSources = 4096;  ///< bounds memory if a network invents sources

class SacnScan final : public Scan {
 public:
  explicit SacnScan(const ScanOptions& options) {
    UdpSettings settings;
    settings.local_port = sacn::kPort;
    settings.share_local_port = true;
    settings.multicast_interface = options.interface;
    channel_ = make_udp(std::move(settings));
  }

  Result<void> step(Time) override {
    if (auto opened = channel_->open(); !opened) return opened;
    if (auto joined = channel_->join(sacn::multicast_group(sacn::kDiscoveryUniverse)); !joined) return joined;
    for (int i = 0; i < kPacketsPerStep; ++i) {
      const auto datagram = channel_->receive();
      if (!datagram) break;
      const auto packet = sacn::decode_discovery(datagram->bytes);
      if (!packet || (sources_.size() >= kMaxSources && !sources_.contains(packet->cid))) continue;
      Source& source = sources_[packet->cid];
      source.address = text_of(datagram->from.ipv4);
      source.name = packet->source_name;
      source.universes.insert(packet->universes.begin(), packet->universes.end());
    }
    return {};
  }

  std::vector<FoundDevice> found() const override {
    std::map<std::pair<std::string, sacn::Cid>, FoundDevice> in_order;
    for (const auto& [cid, source] : sources_) {
      in_order.insert({{source.address, cid}, {"sacn", source.address, source.name, ranges_of(source.universes)}});
    }
    std::vector<FoundDevice> devices;
    for (auto& [key, device] : in_order) devices.push_back(std::move(device));
    return devices;
  }

 private:
  struct Source {
    std::string address, name;
    std::set<std::uint16_t> universes;
  };

  /// "sends universes 1 to 4, 7"
  static std::string ranges_of(const std::set<std::uint16_t>& universes) {
    if (universes.empty()) return "sends nothing";
    std::string text = "sends universe";
    if (universes.size() > 1) text += "s";
    for (auto first = universes.begin(); first != universes.end();) {
      auto last = first;
      while (std::next(last) != universes.end() && *std::next(last) == *last + 1) ++last;
      text += first == universes.begin() ? " " : ", ";
      text += first == last ? fmt::format("{}", *first) : fmt::format("{} to {}", *first, *last);
      first = std::next(last);
    }
    return text;
  }

  std::unique_ptr<DatagramChannel> channel_;
  std::map<sacn::Cid, Source> sources_;
};

}  // namespace

std::unique_ptr<Scan> make_sacn_scan(const ScanOptions& options) { return std::make_unique<SacnScan>(options); }

}  // namespace luxrig
