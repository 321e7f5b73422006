#include "drivers/dmx/artnet/artnet_rdm_codec.h"

#include <algorithm>
#include <array>

#include "core/check.h"

namespace luxrig::artnet {
namespace {

constexpr std::array<std::uint8_t, 8> kRdmId = {'A', 'r', 't', '-', 'N', 'e', 't', 0};
constexpr std::uint16_t kOpTodRequest = 0x8000, kOpTodData = 0x8100, kOpTodControl = 0x8200, kOpRdm = 0x8300;
constexpr std::uint8_t kRdmProtocolVersion = 14, kRdmVersion = 1;  // RDM 1.0, as in E1.20-2006 and later

// Offsets common to all four.
constexpr std::size_t kRdmVer = 12, kRdmPort = 13, kRdmBindIndex = 20, kRdmNet = 21, kRdmCommand = 22;
constexpr std::size_t kAdCount = 23, kAddresses = 24, kMaxAddresses = 32;   // ArtTodRequest
constexpr std::size_t kRdmAddress = 23, kControlSize = 24;                  // the others
constexpr std::size_t kUidTotal = 24, kBlockCount = 26, kUidCount = 27, kTod = 28, kUidSize = 6;
constexpr std::uint8_t kTodFull = 0x00, kTodNak = 0xFF;
constexpr std::size_t kRdmPacket = 24;

std::vector<std::uint8_t> rdm_header(std::size_t size, std::uint16_t op_code, int port_address) {
  LUXRIG_CHECK(port_address >= 0 && port_address <= 0x7FFF, "port address {}", port_address);
  std::vector<std::uint8_t> out(size, 0);
  std::copy(kRdmId.begin(), kRdmId.end(), out.begin());
  out[9] = static_cast<std::uint8_t>(op_code >> 8);  // the low byte of all four is 0
  out[11] = kRdmProtocolVersion;
  out[kRdmNet] = static_cast<std::uint8_t>(port_address >> 8);
  out[kRdmAddress] = static_cast<std::uint8_t>(port_address & 0xFF);
  return out;
}

/// Whether it is such a packet of at least that size, with a valid net.
bool is_rdm_packet(std::span<const std::uint8_t> bytes, std::uint16_t op_code, std::size_t least) {
  return bytes.size() >= least && std::equal(kRdmId.begin(), kRdmId.end(), bytes.begin()) && bytes[8] == 0 &&
         bytes[9] == op_code >> 8 && bytes[kRdmNet] <= 0x7F;
}

int rdm_port_address(std::span<const std::uint8_t> bytes) { return bytes[kRdmNet] << 8 | bytes[kRdmAddress]; }

}  // namespace

std::vector<std::uint8_t> encode_tod_request(std::span<const int> port_addresses) {
  LUXRIG_CHECK(!port_addresses.empty() && port_addresses.size() <= kMaxAddresses, "{} port addresses",
               port_addresses.size());
  // Older nodes need room for all 32.
  auto out = rdm_header(kAddresses + kMaxAddresses, kOpTodRequest, port_addresses.front());
  out[kAdCount] = static_cast<std::uint8_t>(port_addresses.size());
  for (std::size_t i = 0; i < port_addresses.size(); ++i) {
    LUXRIG_CHECK(port_addresses[i] >> 8 == out[kRdmNet], "port address {} is of another net", port_addresses[i]);
    out[kAddresses + i] = static_cast<std::uint8_t>(port_addresses[i] & 0xFF);
  }
  return out;
}

std::optional<std::vector<int>> decode_tod_request(std::span<const std::uint8_t> bytes) {
  if (!is_rdm_packet(bytes, kOpTodRequest, kAddresses)) return std::nullopt;
  const std::size_t count = bytes[kAdCount];
  if (bytes[kRdmCommand] != kTodFull || count > kMaxAddresses || bytes.size() < kAddresses + count) {
    return std::nullopt;
  }
  std::vector<int> port_addresses;
  for (std::size_t i = 0; i < count; ++i) port_addresses.push_back(bytes[kRdmNet] << 8 | bytes[kAddresses + i]);
  return port_addresses;
}

std::vector<std::uint8_t> encode(const TodControl& packet) {
  auto out = rdm_header(kControlSize, kOpTodControl, packet.port_address);
  out[kRdmCommand] = static_cast<std::uint8_t>(packet.command);
  return out;
}

std::optional<TodControl> decode_tod_control(std::span<const std::uint8_t> bytes) {
  if (!is_rdm_packet(bytes, kOpTodControl, kControlSize)) return std::nullopt;
  if (bytes[kRdmCommand] > static_cast<std::uint8_t>(TodCommand::incremental_off)) return std::nullopt;
  return TodControl{rdm_port_address(bytes), static_cast<TodCommand>(bytes[kRdmCommand])};
}

std::vector<std::uint8_t> encode(const TodData& packet) {
  LUXRIG_CHECK(packet.uids.size() <= kMaxTodUids, "{} UIDs", packet.uids.size());
  auto out = rdm_header(kTod, kOpTodData, packet.port_address);
  out[kRdmVer] = kRdmVersion;
  out[kRdmPort] = static_cast<std::uint8_t>(packet.port);
  out[kRdmBindIndex] = static_cast<std::uint8_t>(packet.bind_index);
  out[kRdmCommand] = packet.full ? kTodFull : kTodNak;
  out[kUidTotal] = static_cast<std::uint8_t>(packet.total >> 8);
  out[kUidTotal + 1] = static_cast<std::uint8_t>(packet.total & 0xFF);
  out[kBlockCount] = static_cast<std::uint8_t>(packet.block);
  out[kUidCount] = static_cast<std::uint8_t>(packet.uids.size());
  for (const rdm::Uid& uid : packet.uids) append(out, uid);
  return out;
}

std::optional<TodData> decode_tod_data(std::span<const std::uint8_t> bytes) {
  if (!is_rdm_packet(bytes, kOpTodData, kTod)) return std::nullopt;
  const std::size_t count = bytes[kUidCount];
  if (count > kMaxTodUids || bytes.size() < kTod + count * kUidSize) return std::nullopt;
  if (bytes[kRdmCommand] != kTodFull && bytes[kRdmCommand] != kTodNak) return std::nullopt;
  TodData packet;
  packet.port_address = rdm_port_address(bytes);
  packet.port = bytes[kRdmPort];
  packet.bind_index = bytes[kRdmBindIndex];
  packet.full = bytes[kRdmCommand] == kTodFull;
  packet.total = bytes[kUidTotal] << 8 | bytes[kUidTotal + 1];
  packet.block = bytes[kBlockCount];
  for (std::size_t i = 0; i < count; ++i) {
    packet.uids.push_back(rdm::uid_from(bytes.subspan(kTod + i * kUidSize, kUidSize)));
  }
  return packet;
}

std::vector<std::uint8_t> encode(const ArtRdm& packet) {
  LUXRIG_CHECK(!packet.rdm.empty() && packet.rdm.size() <= rdm::kMaxBytes && packet.rdm[0] == rdm::kStartCode,
               "{} bytes", packet.rdm.size());
  auto out = rdm_header(kRdmPacket, kOpRdm, packet.port_address);
  out[kRdmVer] = kRdmVersion;
  out.insert(out.end(), packet.rdm.begin() + 1, packet.rdm.end());
  return out;
}

std::optional<ArtRdm> decode_art_rdm(std::span<const std::uint8_t> bytes) {
  if (!is_rdm_packet(bytes, kOpRdm, kRdmPacket + 1) || bytes[kRdmCommand] != 0) return std::nullopt;
  const auto travelled = bytes.subspan(kRdmPacket, std::min(bytes.size() - kRdmPacket, rdm::kMaxBytes - 1));
  ArtRdm packet;
  packet.port_address = rdm_port_address(bytes);
  packet.rdm.push_back(rdm::kStartCode);
  packet.rdm.insert(packet.rdm.end(), travelled.begin(), travelled.end());
  return packet;
}

}  // namespace luxrig::artnet
