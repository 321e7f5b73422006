#include "tools/recording/capture.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pcap/pcap.h>

#include <set>

#include "core/text/plain_text.h"
#include "drivers/dmx/artnet/artnet_codec.h"
#include "drivers/dmx/sacn/sacn_codec.h"
#include "drivers/options.h"
#include "drivers/registry.h"
#include "tools/recording/link_layer.h"
#include "tools/recording/recording.h"

namespace luxrig::recording {
namespace {

constexpr int kLongestPacket = 65535, kWait_ms = 100, kBuffer = 8 << 20;
/// Where the pseudo-device `any` says what a packet is, and CAN's number there.
constexpr std::string_view kCanOnAny = "ether[14:2] = 12";

}  // namespace

CaptureFilter filter_for(const Rig& rig, bool all_interfaces) {
  CaptureFilter filter;
  std::set<std::int64_t> ports;
  std::set<std::string> parts;
  bool can = false;
  for (const Bus& bus : rig.buses) {
    const DriverEntry* driver = find_driver(bus.driver);
    if (driver == nullptr) continue;
    if (bus.driver == "sacn" || bus.driver == "artnet") {
      ports.insert(bus.driver == "sacn" ? integer_option(bus, driver->options, "port") : artnet::kPort);
      ports.insert(integer_option(bus, driver->options, "input_port"));
    } else if (bus.driver == "modbus_tcp") {
      parts.insert(fmt::format("(host {} and tcp port {})", string_option(bus, driver->options, "host"),
                               integer_option(bus, driver->options, "port")));
    } else if (bus.driver == "canopen") {
      can = true;
      if (!all_interfaces) filter.unseen.push_back(bus.name + ": CAN is seen with --interface any only");
    } else {
      filter.unseen.push_back(
          fmt::format("{}: {} is no network, so its traffic cannot be captured here", bus.name, bus.driver));
    }
  }
  std::vector<std::string> all;
  for (const std::int64_t port : ports) all.push_back(fmt::format("udp port {}", port));
  all.insert(all.end(), parts.begin(), parts.end());
  if (can && all_interfaces) all.emplace_back(kCanOnAny);
  filter.text = fmt::format("{}", fmt::join(all, " or "));
  return filter;
}

struct Capture::State {
  pcap_t* capture = nullptr;
  pcap_dumper_t* file = nullptr;
  LinkType link = LinkType::ethernet;
  Counts counts;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (file != nullptr) pcap_dump_close(file);
    if (capture != nullptr) pcap_close(capture);
  }
  [[nodiscard]] tl::unexpected<Fault> failed(const std::string& doing, Cause cause = Cause::system) const {
    return tl::unexpected(Fault{cause, "", fmt::format("{}: {}", doing, made_plain(pcap_geterr(capture))), {}});
  }
  void count(std::span<const std::uint8_t> packet) {
    const Seen seen = look_into(link, packet);
    if (const auto* datagram = std::get_if<UdpDatagram>(&seen.what)) {
      if (sacn::decode(datagram->payload) || sacn::decode_sync(datagram->payload))
        ++counts.sacn;
      else if (artnet::decode_dmx(datagram->payload))
        ++counts.artnet;
      else
        ++counts.other;
    } else if (std::holds_alternative<TcpSegment>(seen.what)) {
      ++counts.modbus;
    } else if (std::holds_alternative<can::CanFrame>(seen.what)) {
      ++counts.can;
    } else {
      ++counts.other;
    }
  }
};

Capture::Capture(std::unique_ptr<State> state) : state_(std::move(state)) {}
Capture::Capture(Capture&&) noexcept = default;
Capture& Capture::operator=(Capture&&) noexcept = default;
Capture::~Capture() = default;

Result<Capture> Capture::begin(const std::string& interface, const std::string& filter,
                               const std::filesystem::path& file) {
  auto state = std::make_unique<State>();
  char error[PCAP_ERRBUF_SIZE] = "";
  state->capture = pcap_create(interface.c_str(), error);
  if (state->capture == nullptr)
    return tl::unexpected(Fault{Cause::system, "", fmt::format("{}: {}", interface, made_plain(error)), {}});
  pcap_set_snaplen(state->capture, kLongestPacket);
  pcap_set_timeout(state->capture, kWait_ms);
  pcap_set_immediate_mode(state->capture, 1);
  pcap_set_buffer_size(state->capture, kBuffer);
  const int activated = pcap_activate(state->capture);
  if (activated == PCAP_ERROR_PERM_DENIED)
    return tl::unexpected(Fault{Cause::refused, "", "this user may not capture packets", {}});
  if (activated < 0) return state->failed(fmt::format("interface {}: {}", interface, pcap_statustostr(activated)));
  const auto link = link_type_of(pcap_datalink(state->capture));
  if (!link)
    return tl::unexpected(
        Fault{Cause::system, "", fmt::format("interface {}: its packets cannot be read", interface), {}});
  state->link = *link;
  bpf_program program{};
  if (pcap_compile(state->capture, &program, filter.c_str(), 1, PCAP_NETMASK_UNKNOWN) != 0)
    return state->failed(fmt::format("filter {}", filter));
  const int set = pcap_setfilter(state->capture, &program);
  pcap_freecode(&program);
  if (set != 0) return state->failed("filter");
  if (pcap_setnonblock(state->capture, 1, error) != 0) return state->failed("capture");
  state->file = pcap_dump_open(state->capture, file.c_str());
  if (state->file == nullptr) return state->failed("file");
  return Capture(std::move(state));
}

Result<void> Capture::step() {
  const auto taken = [](u_char* user, const pcap_pkthdr* header, const u_char* bytes) {
    auto& state = *reinterpret_cast<State*>(user);
    pcap_dump(reinterpret_cast<u_char*>(state.file), header, bytes);
    state.count({bytes, header->caplen});
  };
  if (pcap_dispatch(state_->capture, -1, taken, reinterpret_cast<u_char*>(state_.get())) == PCAP_ERROR)
    return state_->failed("capture");
  pcap_stat statistics{};
  if (pcap_stats(state_->capture, &statistics) == 0) state_->counts.dropped = statistics.ps_drop;
  return {};
}

const Capture::Counts& Capture::counts() const { return state_->counts; }

Result<void> Capture::flush() {
  if (pcap_dump_flush(state_->file) != 0)
    return tl::unexpected(Fault{Cause::system, "", "the file cannot be written: is the disk full?", {}});
  return {};
}

}  // namespace luxrig::recording
