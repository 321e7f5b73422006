#include "tools/recording/link_layer.h"

#include <pcap/dlt.h>

#include <algorithm>

namespace luxrig::recording {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint16_t kEtherIpv4 = 0x0800, kEtherVlan = 0x8100, kEtherProviderVlan = 0x88A8, kEtherCan = 0x000C;
constexpr std::size_t kEthernetHeader = 14, kVlanTag = 4, kSllHeader = 16, kSll2Header = 20;
constexpr std::uint8_t kSllOutgoing = 4;
constexpr std::size_t kIpHeader = 20, kUdpHeader = 8, kTcpHeader = 20;
constexpr std::uint8_t kTcp = 6, kUdp = 17;

std::uint16_t be16(Bytes in, std::size_t at) { return static_cast<std::uint16_t>(in[at] << 8 | in[at + 1]); }
std::uint32_t be32(Bytes in, std::size_t at) { return std::uint32_t{be16(in, at)} << 16 | be16(in, at + 2); }

void look_into_udp(Bytes in, std::size_t announced, SocketAddress from, SocketAddress to, Seen& seen) {
  if (in.size() < kUdpHeader) return;
  from.port = be16(in, 0);
  to.port = be16(in, 2);
  const std::size_t length = be16(in, 4);
  if (length < kUdpHeader || length > announced) return;
  seen.cut = length > in.size();
  seen.what = UdpDatagram{from, to, in.subspan(kUdpHeader, std::min(length, in.size()) - kUdpHeader)};
}

void look_into_tcp(Bytes in, std::size_t announced, SocketAddress from, SocketAddress to, Seen& seen) {
  if (in.size() < kTcpHeader) return;
  from.port = be16(in, 0);
  to.port = be16(in, 2);
  const std::size_t header = std::size_t{4} * (in[12] >> 4);
  if (header < kTcpHeader || header > in.size()) return;
  const bool syn = (in[13] & 0x02) != 0;
  seen.cut = announced > in.size();
  // SYN takes one number of its own.
  seen.what = TcpSegment{from, to, be32(in, 4) + (syn ? 1 : 0), syn, in.subspan(header)};
}

void look_into_ipv4(Bytes in, Seen& seen) {
  if (in.size() < kIpHeader || in[0] >> 4 != 4) return;
  const std::size_t header = std::size_t{4} * (in[0] & 0x0F);
  if (header < kIpHeader || header > in.size()) return;
  // Where the network card cuts long segments, the length may still be 0 here.
  const std::size_t length = be16(in, 2) == 0 ? in.size() : std::size_t{be16(in, 2)};
  if (length < header) return;
  if ((be16(in, 6) & 0x3FFF) != 0) return;  // a fragment; DMX and Modbus never need one
  const SocketAddress from{be32(in, 12), 0}, to{be32(in, 16), 0};
  const Bytes inside = in.subspan(header, std::min(length, in.size()) - header);  // Ethernet pads short packets
  if (in[9] == kUdp) look_into_udp(inside, length - header, from, to, seen);
  if (in[9] == kTcp) look_into_tcp(inside, length - header, from, to, seen);
}

/// SocketCAN's header: identifier and flags, length, flags of CAN FD, two unused. Of classic frames only.
void look_into_can(Bytes in, bool little_endian, Seen& seen) {
  if (in.size() < 8 || in[4] > 8 || in.size() < std::size_t{8} + in[4] || (in[5] & 0x04) != 0) return;
  std::array<std::uint8_t, can::kFrameBytes> frame{};
  std::copy_n(in.begin(), std::size_t{8} + in[4], frame.begin());
  if (!little_endian) std::reverse(frame.begin(), frame.begin() + 4);
  if (const auto decoded = can::from_bytes(frame)) seen.what = *decoded;
}

void look_into_ethertype(std::uint16_t type, Bytes in, Seen& seen) {
  for (int tags = 0; tags < 2 && (type == kEtherVlan || type == kEtherProviderVlan); ++tags) {
    if (in.size() < kVlanTag) return;
    type = be16(in, 2);
    in = in.subspan(kVlanTag);
  }
  if (type == kEtherIpv4) look_into_ipv4(in, seen);
}

}  // namespace

std::optional<LinkType> link_type_of(int dlt) {
  switch (dlt) {
    case DLT_EN10MB:
      return LinkType::ethernet;
    case DLT_RAW:
    case DLT_IPV4:
      return LinkType::raw_ip;
    case DLT_NULL:
      return LinkType::null_host_order;
    case DLT_LOOP:
      return LinkType::loop;
    case DLT_LINUX_SLL:
      return LinkType::linux_sll;
    case DLT_LINUX_SLL2:
      return LinkType::linux_sll2;
    case DLT_CAN_SOCKETCAN:
      return LinkType::can;
    default:
      return std::nullopt;
  }
}

Seen look_into(LinkType link, std::span<const std::uint8_t> packet) {
  Seen seen;
  switch (link) {
    case LinkType::ethernet:
      if (packet.size() >= kEthernetHeader)
        look_into_ethertype(be16(packet, 12), packet.subspan(kEthernetHeader), seen);
      break;
    case LinkType::raw_ip:
      look_into_ipv4(packet, seen);
      break;
    case LinkType::null_host_order:
    case LinkType::loop:  // four bytes of address family; the IP header says its version itself
      if (packet.size() >= 4) look_into_ipv4(packet.subspan(4), seen);
      break;
    case LinkType::linux_sll:
    case LinkType::linux_sll2: {
      const bool second = link == LinkType::linux_sll2;
      const std::size_t header = second ? kSll2Header : kSllHeader;
      if (packet.size() < header) break;
      seen.sent_here = (second ? packet[10] : be16(packet, 0)) == kSllOutgoing;
      const std::uint16_t type = be16(packet, second ? 0 : 14);
      // libpcap turns this identifier into the byte order of the computer that reads: here always little-endian.
      if (type == kEtherCan)
        look_into_can(packet.subspan(header), true, seen);
      else
        look_into_ethertype(type, packet.subspan(header), seen);
      break;
    }
    case LinkType::can:
      look_into_can(packet, false, seen);
      break;
  }
  return seen;
}

}  // namespace luxrig::recording
