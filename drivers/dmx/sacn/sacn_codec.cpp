#include "drivers/dmx/sacn/sacn_codec.h"

#include <algorithm>

#include "core/check.h"

namespace luxrig::sacn {
namespace {

// Offsets from the start of the datagram; the clause that defines each field.
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

constexpr std::array<std::uint8_t, 12> kAcnIdBytes = {'A', 'S', 'C', '-', 'E', '1', '.', '1', '7', 0, 0, 0};
constexpr std::uint16_t kPreambleSizeValue = 0x0010;
constexpr std::uint32_t kVectorRootData = 4;     // VECTOR_ROOT_E131_DATA
constexpr std::uint32_t kVectorFramingData = 2;  // VECTOR_E131_DATA_PACKET
constexpr std::uint8_t kVectorSetProperty = 2;   // VECTOR_DMP_SET_PROPERTY
constexpr std::uint8_t kAddressTypeValue = 0xA1;
constexpr std::uint16_t kPduFlags = 0x7000;
constexpr std::uint8_t kPreview = 0x80, kTerminated = 0x40, kForceSync = 0x20;
constexpr std::size_t kMostSlots = 512;

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

/// As many whole UTF-8 characters as fit beside the NUL.
std::size_t fitting_bytes(const std::string& name) {
  if (name.size() < kSourceNameBytes) return name.size();
  std::size_t end = kSourceNameBytes - 1;
  while (end > 0 && (static_cast<std::uint8_t>(name[end]) & 0xC0) == 0x80) --end;
  return end;
}

}  // namespace

std::vector<std::uint8_t> encode(const DataPacket& packet) {
  LUXRIG_CHECK(packet.slots.size() <= kMostSlots, "{} slots", packet.slots.size());
  const std::size_t size = kSlots + packet.slots.size();
  std::vector<std::uint8_t> out(size, 0);
  const auto put_length = [&](std::size_t at) { put16(out, at, kPduFlags | (size - at)); };

  put16(out, kPreambleSize, kPreambleSizeValue);
  put16(out, kPostambleSize, 0);
  std::copy(kAcnIdBytes.begin(), kAcnIdBytes.end(), out.begin() + kAcnId);
  put_length(kRootLength);
  put32(out, kRootVector, kVectorRootData);
  std::copy(packet.cid.begin(), packet.cid.end(), out.begin() + kCid);

  put_length(kFramingLength);
  put32(out, kFramingVector, kVectorFramingData);
  std::copy_n(packet.source_name.begin(), fitting_bytes(packet.source_name), out.begin() + kSourceName);
  out[kPriority] = packet.priority;
  put16(out, kSyncUniverse, packet.sync_universe);
  out[kSequence] = packet.sequence;
  out[kOptions] = static_cast<std::uint8_t>((packet.preview ? kPreview : 0) | (packet.terminated ? kTerminated : 0) |
                                            (packet.force_sync ? kForceSync : 0));
  put16(out, kUniverse, packet.universe);

  put_length(kDmpLength);
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
  if (bytes.size() < kSlots || bytes.size() > kSlots + kMostSlots) return std::nullopt;
  const auto length_is_right = [&](std::size_t at) { return get16(bytes, at) == (kPduFlags | (bytes.size() - at)); };
  const bool well_formed = get16(bytes, kPreambleSize) == kPreambleSizeValue && get16(bytes, kPostambleSize) == 0 &&
                           std::equal(kAcnIdBytes.begin(), kAcnIdBytes.end(), bytes.begin() + kAcnId) &&
                           length_is_right(kRootLength) && get32(bytes, kRootVector) == kVectorRootData &&
                           length_is_right(kFramingLength) && get32(bytes, kFramingVector) == kVectorFramingData &&
                           length_is_right(kDmpLength) && bytes[kDmpVector] == kVectorSetProperty &&
                           bytes[kAddressType] == kAddressTypeValue && get16(bytes, kFirstAddress) == 0 &&
                           get16(bytes, kIncrement) == 1 && get16(bytes, kValueCount) == 1 + (bytes.size() - kSlots);
  if (!well_formed) return std::nullopt;

  DataPacket packet;
  std::copy_n(bytes.begin() + kCid, packet.cid.size(), packet.cid.begin());
  const auto name = bytes.subspan(kSourceName, kSourceNameBytes);
  packet.source_name.assign(name.begin(), std::find(name.begin(), name.end(), 0));
  if (packet.source_name.size() == kSourceNameBytes) return std::nullopt;  // no NUL
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

}  // namespace luxrig::sacn
