// A pcap or pcapng file -> Recording.
#include <fmt/format.h>
#include <pcap/pcap.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "core/text/plain_text.h"
#include "drivers/can/canopen/cob_id.h"
#include "drivers/can/cia402/report_check.h"
#include "drivers/dmx/artnet/artnet_codec.h"
#include "tools/recording/link_layer.h"
#include "tools/recording/modbus_streams.h"

namespace luxrig::recording {
namespace {

constexpr std::size_t kMaxSources = 1000;
constexpr int kDriveNodes = 127;

struct CloseCapture {
  void operator()(pcap_t* capture) const { pcap_close(capture); }
};

class PcapReader {
 public:
  PcapReader(std::string file, const std::set<std::uint16_t>& modbus_ports)
      : file_(std::move(file)), modbus_(modbus_ports) {}

  Checked<Recording> read(std::FILE* stream) {
    char error[PCAP_ERRBUF_SIZE] = "";
    const std::unique_ptr<pcap_t, CloseCapture> capture(
        pcap_fopen_offline_with_tstamp_precision(stream, PCAP_TSTAMP_PRECISION_NANO, error));
    if (!capture) {
      std::fclose(stream);
      return whole_file(made_plain(error), "record it again, or give a pcap or pcapng file, or a show by ola_recorder");
    }
    const auto link = link_type_of(pcap_datalink(capture.get()));
    if (!link) {
      const char* name = pcap_datalink_val_to_name(pcap_datalink(capture.get()));
      return whole_file(fmt::format("packets of the link type {} cannot be read",
                                    name != nullptr ? name : std::to_string(pcap_datalink(capture.get()))),
                        "capture on Ethernet, on CAN or on the interface `any` of Linux");
    }
    pcap_pkthdr* header = nullptr;
    const u_char* bytes = nullptr;
    for (;;) {
      const int got = pcap_next_ex(capture.get(), &header, &bytes);
      if (got == PCAP_ERROR_BREAK) break;
      ++number_;
      if (got != 1) {
        return packet_problem(made_plain(pcap_geterr(capture.get())),
                              fmt::format("keep the packets before it: tshark -r {} -w whole.pcap", file_));
      }
      if (auto problem = take(*link, *header, {bytes, header->caplen})) return tl::unexpected(std::move(*problem));
    }
    return end();
  }

 private:
  using Problems = std::vector<Problem>;

  [[nodiscard]] tl::unexpected<Problems> whole_file(std::string what, std::string mend) const {
    return tl::unexpected(Problems{{file_, 0, 0, std::move(what), std::move(mend)}});
  }
  [[nodiscard]] tl::unexpected<Problems> packet_problem(const std::string& what, std::string mend) const {
    return whole_file(fmt::format("packet {}: {}", number_, what), std::move(mend));
  }

  std::optional<Problems> take(LinkType link, const pcap_pkthdr& header, std::span<const std::uint8_t> bytes) {
    // With nanoseconds asked for, tv_usec holds them.
    if (!begin_s_) {
      begin_s_ = header.ts.tv_sec;
      begin_ns_ = header.ts.tv_usec;
    }
    constexpr std::int64_t kLongest_s =
        std::chrono::seconds(std::chrono::duration_cast<std::chrono::seconds>(kLongest)).count();
    const std::int64_t s = header.ts.tv_sec, since_s = s - *begin_s_;
    if (s < 0 || since_s > kLongest_s || since_s < -kLongest_s || header.ts.tv_usec < 0 ||
        header.ts.tv_usec >= 1'000'000'000)
      return packet_problem("its time is no more than a week from the first packet's in no direction",
                            "give it a right clock: editcap -t, or cut the file: editcap -A … -B …")
          .value();
    const Duration at = std::chrono::seconds(since_s) + Duration(header.ts.tv_usec - begin_ns_);
    first_ = std::min(first_, at);
    last_ = std::max(last_, at);
    const Seen seen = look_into(link, bytes);
    if (const auto* datagram = std::get_if<UdpDatagram>(&seen.what)) return take_datagram(at, *datagram, seen, header);
    if (const auto* segment = std::get_if<TcpSegment>(&seen.what); segment != nullptr && modbus_.concerns(*segment)) {
      if (seen.cut) return cut(header);
      modbus_.take(at, *segment, recording_);
    }
    if (const auto* frame = std::get_if<can::CanFrame>(&seen.what)) take_frame(*frame);
    return std::nullopt;
  }

  [[nodiscard]] std::optional<Problems> cut(const pcap_pkthdr& header) const {
    return packet_problem(fmt::format("it is cut to {} of its {} bytes", header.caplen, header.len),
                          "capture whole packets: tcpdump -s 0, tshark without -s")
        .value();
  }

  std::optional<Problems> take_datagram(Duration at, const UdpDatagram& datagram, const Seen& seen,
                                        const pcap_pkthdr& header) {
    const auto of_dmx = [](std::uint16_t port) { return port == sacn::kPort || port == artnet::kPort; };
    if (seen.cut) {
      if (of_dmx(datagram.from.port) || of_dmx(datagram.to.port)) return cut(header);
      return std::nullopt;
    }
    Source source;
    source.address = datagram.from;
    source.sent_here = seen.sent_here;
    std::optional<int> universe;
    if (const auto data = sacn::decode(datagram.payload)) {
      source.name = made_plain(data->source_name);
      source.cid = data->cid;
      universe = data->universe;
    } else if (const auto sync = sacn::decode_sync(datagram.payload)) {
      source.cid = sync->cid;
    } else if (const auto dmx = artnet::decode_dmx(datagram.payload)) {
      source.protocol = Protocol::artnet;
      universe = dmx->port_address;
    } else if (artnet::is_sync(datagram.payload)) {
      source.protocol = Protocol::artnet;
    } else {
      return std::nullopt;
    }
    const auto index = source_of(source);
    if (!index)
      return packet_problem(fmt::format("it is by source {} of DMX", kMaxSources + 1),
                            fmt::format("filter the file: at most {} sources are read", kMaxSources))
          .value();
    Source& known = recording_.sources[*index];
    if (!source.name.empty()) known.name = source.name;
    if (universe) known.universes.insert(*universe);
    ++known.packets;
    recording_.dmx.push_back({at, *index, universe, {datagram.payload.begin(), datagram.payload.end()}});
    return std::nullopt;
  }

  std::optional<std::size_t> source_of(const Source& source) {
    std::string key(1, static_cast<char>(source.protocol));
    if (source.protocol == Protocol::sacn)
      key.append(source.cid.begin(), source.cid.end());
    else
      key += text_of(source.address);
    const auto [found, added] = by_key_.emplace(key, recording_.sources.size());
    if (!added) return found->second;
    if (recording_.sources.size() >= kMaxSources) return std::nullopt;
    recording_.sources.push_back(source);
    if (source.protocol == Protocol::artnet) recording_.sources.back().name = text_of(source.address);
    return found->second;
  }

  void take_frame(const can::CanFrame& frame) {
    if (frame.error || frame.remote) return;
    ++recording_.can_frames[frame.id];
    const std::uint32_t node = frame.id - canopen::kTransmitPdo1;
    if (frame.extended || node < 1 || node > kDriveNodes || frame.size != cia402::ReportCheck::kBytes) return;
    std::uint32_t position = 0;  // little-endian, after the statusword
    for (std::size_t i = 0; i < 4; ++i) position |= std::uint32_t{frame.data[2 + i]} << (8 * i);
    const auto counts = static_cast<std::int32_t>(position);
    DrivePositions& drive = recording_.drives[static_cast<int>(node)];
    drive.least = drive.reports == 0 ? counts : std::min(drive.least, counts);
    drive.greatest = drive.reports == 0 ? counts : std::max(drive.greatest, counts);
    ++drive.reports;
  }

  Recording end() {
    recording_.packets = number_;
    recording_.length = last_ - first_;
    modbus_.end(recording_);
    // Interfaces of one file may be out of order, and the first packet need not be the earliest.
    const auto by_time = [](const auto& a, const auto& b) { return a.at < b.at; };
    for (DmxPacket& packet : recording_.dmx) packet.at -= first_;
    for (ModbusExchange& exchange : recording_.modbus) exchange.at -= first_;
    std::stable_sort(recording_.dmx.begin(), recording_.dmx.end(), by_time);
    std::stable_sort(recording_.modbus.begin(), recording_.modbus.end(), by_time);
    return std::move(recording_);
  }

  std::string file_;
  ModbusStreams modbus_;
  Recording recording_;
  std::map<std::string, std::size_t> by_key_;
  std::size_t number_ = 0;
  std::optional<std::int64_t> begin_s_;
  std::int64_t begin_ns_ = 0;
  Duration first_{}, last_{};
};

}  // namespace

Checked<Recording> read_pcap(std::FILE* stream, const std::string& file, const std::set<std::uint16_t>& modbus_ports) {
  return PcapReader(file, modbus_ports).read(stream);
}

}  // namespace luxrig::recording
