#include "drivers/dmx/sacn/sacn_codec.h"

#include <algorithm>

#include "core/check.h"

namespace luxrig::sacn {
namespace {

// Offsets from the start of the datagram, with the clause of each field.
constexpr std::size_t kPreambleSize = 0;    // 5.1
constexpr std::size_t kPostambleSize = 2;   // 5.2
constexpr std::size_t kAcnId = 4;           // 5.3
constexpr std::size_t kRootLength = 16;     // 5.4
constexpr std::size_t kRootVector = 18;     // 5.5
constexpr std::size_t kCid = 22;            // 5.6
constexpr std::size_t kFramingLength = 38;  // 6.1
constexpr std::size_t kFramingVector = 40;  // 6.2.1
constexpr std::size_t kSourceName = 44;     // 6.2.2
constexpr std::size_t kPriority = 108;      // 6.2.3
constexpr std::size_t kSyncUniverse = 109;  // 6.2.4
constexpr std::size_t kSequence = 111;      // 6.2.5
constexpr std::size_t kOptions = 112;       // 6.2.6
constexpr std::size_t kUniverse = 113;      // 6.2.7
constexpr std::size_t kDmpLength = 115;     // 7.1
constexpr std::size_t kDmpVector = 117;     // 7.2
constexpr std::size_t kAddressType = 118;   // 7.3
constexpr std::size_t kFirstAddress = 119;  // 7.4
constexpr std::size_t kIncrement = 121;     // 7.5
constexpr std::size_t kValueCount = 123;    // 7.6
constexpr std::size_t kStartCode = 125;     // 7.7
constexpr std::size_t kSlots = 126;

// Synchronisation, clause 6.3.
constexpr std::size_t kSyncSequence = 44;  // 6.3.2
constexpr std::size_t kSyncAddress = 45;   // 6.3.3
constexpr std::size_t kSyncSize = 49;      // two reserved bytes at the end, 6.3.4

// Universe discovery, clauses 6.4 and 8.
constexpr std::size_t kListLength = 112;  // 8.1
constexpr std::size_t kListVector = 114;  // 8.2
constexpr std::size_t kPage = 118;        // 8.3
constexpr std::size_t kLastPage = 119;    // 8.4
constexpr std::size_t kList = 120;        // 8.5

constexpr std::array<std::uint8_t, 12> kAcnIdBytes = {'A', 'S', 'C', '-', 'E', '1', '.', '1', '7', 0, 0, 0};
constexpr std::uint16_t kPreambleSizeValue = 0x0010;
constexpr std::uint32_t kVectorRootData = 4;      // VECTOR_ROOT_E131_DATA
constexpr std::uint32_t kVectorFramingData = 2;   // VECTOR_E131_DATA_PACKET
constexpr std::uint32_t kVectorRootExtended = 8;  // VECTOR_ROOT_E131_EXTENDED
constexpr std::uint32_t kVectorSync = 1;          // VECTOR_E131_EXTENDED_SYNCHRONIZATION
constexpr std::uint32_t kVectorDiscovery = 2;     // VECTOR_E131_EXTENDED_DISCOVERY
constexpr std::uint32_t kVectorUniverseList = 1;  // VECTOR_UNIVERSE_DISCOVERY_UNIVERSE_LIST
constexpr std::uint8_t kVectorSetProperty = 2;    // VECTOR_DMP_SET_PROPERTY
constexpr std::uint8_t kAddressTypeValue = 0xA1;
constexpr std::uint16_t kPduFlags = 0x7000;
constexpr std::uint8_t kPreview = 0x80, kTerminated = 0x40, kForceSync = 0x20;
constexpr std::size_t kMaxSlots = 512;

void put16(std::vector<std::uint8_t>& out, std::size_t at, std::size_t value) {
  out[at] = static_cast<std::uint8_t>(value >> 8);
  out[at + 1] = static_cast<std::uint8_t>(value);
}
void put32(std::vector<std::uint8_t>& out, std::size_t at, std::uint32_t value) {
  put16(out, at, value >> 16);
  put16(out, at + 2, value & 0xFFFF);
}
std::uint16_t get16(std::span<const std::uint8_t> in, std::size_t at) {
  return static_cast<std::uint16_t>(in[at] << 8 | in[at + 1]);
}
std::uint32_t get32(std::span<const std::uint8_t> in, std::size_t at) {
  return static_cast<std::uint32_t>(get16(in, at)) << 16 | get16(in, at + 2);
}

/// As many whole UTF-8 characters as fit, with the NUL.
std::size_t fitting_bytes(const std::string& name) {
  if (name.size() < kSourceNameBytes) return name.size();
  std::size_t end = kSourceNameBytes - 1;
  while (end > 0 && (static_cast<std::uint8_t>(name[end]) & 0xC0) == 0x80) --end;
  return end;
}

void put_length(std::vector<std::uint8_t>& out, std::size_t at) { put16(out, at, kPduFlags | (out.size() - at)); }
bool length_is_right(std::span<const std::uint8_t> in, std::size_t at) {
  return get16(in, at) == (kPduFlags | (in.size() - at));
}

/// A packet with its root layer, and the vector of the framing layer.
std::vector<std::uint8_t> packet_of(std::size_t size, std::uint32_t root, const Cid& cid, std::uint32_t framing) {
  std::vector<std::uint8_t> out(size, 0);
  put16(out, kPreambleSize, kPreambleSizeValue);
  put16(out, kPostambleSize, 0);
  std::copy(kAcnIdBytes.begin(), kAcnIdBytes.end(), out.begin() + kAcnId);
  put_length(out, kRootLength);
  put32(out, kRootVector, root);
  std::copy(cid.begin(), cid.end(), out.begin() + kCid);
  put_length(out, kFramingLength);
  put32(out, kFramingVector, framing);
  return out;
}

/// requires in.size() >= kFramingVector + 4.
bool has_layers(std::span<const std::uint8_t> in, std::uint32_t root, std::uint32_t framing) {
  return get16(in, kPreambleSize) == kPreambleSizeValue && get16(in, kPostambleSize) == 0 &&
         std::equal(kAcnIdBytes.begin(), kAcnIdBytes.end(), in.begin() + kAcnId) && length_is_right(in, kRootLength) &&
         get32(in, kRootVector) == root && length_is_right(in, kFramingLength) && get32(in, kFramingVector) == framing;
}

Cid cid_in(std::span<const std::uint8_t> in) {
  Cid cid{};
  std::copy_n(in.begin() + kCid, cid.size(), cid.begin());
  return cid;
}

/// The whole field if a sender left out its NUL.
std::string name_in(std::span<const std::uint8_t> in) {
  const auto field = in.subspan(kSourceName, kSourceNameBytes);
  return {field.begin(), std::find(field.begin(), field.end(), 0)};
}

}  // namespace

std::vector<std::uint8_t> encode(const DataPacket& packet) {
  LUXRIG_CHECK(packet.slots.size() <= kMaxSlots, "{} slots", packet.slots.size());
  std::vector<std::uint8_t> out =
      packet_of(kSlots + packet.slots.size(), kVectorRootData, packet.cid, kVectorFramingData);
  std::copy_n(packet.source_name.begin(), fitting_bytes(packet.source_name), out.begin() + kSourceName);
  out[kPriority] = packet.priority;
  put16(out, kSyncUniverse, packet.sync_universe);
  out[kSequence] = packet.sequence;
  out[kOptions] = static_cast<std::uint8_t>((packet.preview ? kPreview : 0) | (packet.terminated ? kTerminated : 0) |
                                            (packet.force_sync ? kForceSync : 0));
  put16(out, kUniverse, packet.universe);

  put_length(out, kDmpLength);
  out[kDmpVector] = kVectorSetProperty;
  out[kAddressType] = kAddressTypeValue;
  put16(out, kFirstAddress, 0);
  put16(out, kIncrement, 1);
  put16(out, kValueCount, 1 + packet.slots.size());
  out[kStartCode] = packet.start_code;
  std::copy(packet.slots.begin(), packet.slots.end(), out.begin() + kSlots);
  return out;
}

std::optional<DataPacket> decode(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kSlots || bytes.size() > kSlots + kMaxSlots) return std::nullopt;
  const bool well_formed = has_layers(bytes, kVectorRootData, kVectorFramingData) &&
                           length_is_right(bytes, kDmpLength) && bytes[kDmpVector] == kVectorSetProperty &&
                           bytes[kAddressType] == kAddressTypeValue && get16(bytes, kFirstAddress) == 0 &&
                           get16(bytes, kIncrement) == 1 && get16(bytes, kValueCount) == 1 + (bytes.size() - kSlots);
  if (!well_formed) return std::nullopt;

  DataPacket packet;
  packet.cid = cid_in(bytes);
  packet.source_name = name_in(bytes);
  packet.priority = bytes[kPriority];
  packet.sync_universe = get16(bytes, kSyncUniverse);
  packet.sequence = bytes[kSequence];
  packet.preview = (bytes[kOptions] & kPreview) != 0;
  packet.terminated = (bytes[kOptions] & kTerminated) != 0;
  packet.force_sync = (bytes[kOptions] & kForceSync) != 0;
  packet.universe = get16(bytes, kUniverse);
  packet.start_code = bytes[kStartCode];
  packet.slots.assign(bytes.begin() + kSlots, bytes.end());
  if (packet.priority > kHighestPriority || packet.universe < kLowestUniverse || packet.universe > kHighestUniverse) {
    return std::nullopt;
  }
  return packet;
}

std::vector<std::uint8_t> encode(const SyncPacket& packet) {
  std::vector<std::uint8_t> out = packet_of(kSyncSize, kVectorRootExtended, packet.cid, kVectorSync);
  out[kSyncSequence] = packet.sequence;
  put16(out, kSyncAddress, packet.sync_universe);
  return out;
}

std::optional<SyncPacket> decode_sync(std::span<const std::uint8_t> bytes) {
  if (bytes.size() != kSyncSize || !has_layers(bytes, kVectorRootExtended, kVectorSync)) return std::nullopt;
  const SyncPacket packet{cid_in(bytes), bytes[kSyncSequence], get16(bytes, kSyncAddress)};
  if (packet.sync_universe < kLowestUniverse || packet.sync_universe > kHighestUniverse) return std::nullopt;
  return packet;
}

std::vector<std::uint8_t> encode(const DiscoveryPacket& packet) {
  LUXRIG_CHECK(packet.universes.size() <= kUniversesPerPage, "{} universes", packet.universes.size());
  std::vector<std::uint8_t> out =
      packet_of(kList + 2 * packet.universes.size(), kVectorRootExtended, packet.cid, kVectorDiscovery);
  std::copy_n(packet.source_name.begin(), fitting_bytes(packet.source_name), out.begin() + kSourceName);
  put_length(out, kListLength);
  put32(out, kListVector, kVectorUniverseList);
  out[kPage] = packet.page;
  out[kLastPage] = packet.last_page;
  for (std::size_t i = 0; i < packet.universes.size(); ++i) put16(out, kList + 2 * i, packet.universes[i]);
  return out;
}

std::optional<DiscoveryPacket> decode_discovery(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kList || bytes.size() > kList + 2 * kUniversesPerPage || bytes.size() % 2 != 0) {
    return std::nullopt;
  }
  if (!has_layers(bytes, kVectorRootExtended, kVectorDiscovery) || !length_is_right(bytes, kListLength) ||
      get32(bytes, kListVector) != kVectorUniverseList || bytes[kPage] > bytes[kLastPage]) {
    return std::nullopt;
  }
  DiscoveryPacket packet{cid_in(bytes), name_in(bytes), bytes[kPage], bytes[kLastPage], {}};
  for (std::size_t at = kList; at < bytes.size(); at += 2) {
    const std::uint16_t universe = get16(bytes, at);
    if (!packet.universes.empty() && universe <= packet.universes.back()) return std::nullopt;  // 8.5: sorted
    packet.universes.push_back(universe);
  }
  return packet;
}

}  // namespace luxrig::sacn
