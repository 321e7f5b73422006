#include "drivers/dmx/artnet/artnet_codec.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/check.h"

namespace luxrig::artnet {
namespace {

// Offsets; the table of the specification that defines each field. Op codes travel low byte first, most else high.
constexpr std::size_t kOpCode = 8;
constexpr std::size_t kProtocol = 10;
constexpr std::array<std::uint8_t, 8> kId = {'A', 'r', 't', '-', 'N', 'e', 't', 0};
constexpr std::uint16_t kProtocolVersion = 14;
constexpr std::uint16_t kOpPoll = 0x2000, kOpPollReply = 0x2100, kOpDmx = 0x5000;

// ArtDmx
constexpr std::size_t kSequence = 12;
constexpr std::size_t kPhysical = 13;
constexpr std::size_t kSubUni = 14;
constexpr std::size_t kNet = 15;
constexpr std::size_t kLength = 16;
constexpr std::size_t kData = 18;
constexpr std::size_t kMostSlots = 512;

// ArtPoll
constexpr std::size_t kPollFlags = 12;
constexpr std::size_t kPollSize = 14;
constexpr std::uint8_t kReplyOnChange = 0x02;

// ArtPollReply
constexpr std::size_t kReplySize = 239, kShortestReply = 207;
constexpr std::size_t kNetSwitch = 18;
constexpr std::size_t kSubSwitch = 19;
constexpr std::size_t kShortName = 26, kShortNameSize = 18;
constexpr std::size_t kLongName = 44, kLongNameSize = 64;
constexpr std::size_t kNodeReport = 108, kNodeReportSize = 64;
constexpr std::size_t kNumPorts = 172;
constexpr std::size_t kPortTypes = 174;
constexpr std::size_t kSwOut = 190;
constexpr std::size_t kBindIndex = 211;
constexpr std::size_t kMostPorts = 4;
constexpr std::uint8_t kPortPutsOut = 0x80;

std::vector<std::uint8_t> header(std::size_t size, std::uint16_t op_code) {
  std::vector<std::uint8_t> out(size, 0);
  std::copy(kId.begin(), kId.end(), out.begin());
  out[kOpCode] = static_cast<std::uint8_t>(op_code & 0xFF);
  out[kOpCode + 1] = static_cast<std::uint8_t>(op_code >> 8);
  out[kProtocol + 1] = kProtocolVersion;
  return out;
}

bool has_header(std::span<const std::uint8_t> bytes, std::uint16_t op_code) {
  return bytes.size() >= kProtocol && std::equal(kId.begin(), kId.end(), bytes.begin()) &&
         (bytes[kOpCode] | bytes[kOpCode + 1] << 8) == op_code;
}

std::string text_in(std::span<const std::uint8_t> field) {
  std::string text(field.begin(), std::find(field.begin(), field.end(), 0));
  for (char& letter : text) {  // these go into health reports: no control characters
    if (static_cast<unsigned char>(letter) < 0x20 || static_cast<unsigned char>(letter) >= 0x7F) letter = '?';
  }
  return text;
}

}  // namespace

std::string text_of_port_address(int port_address) {
  return fmt::format("{}:{}:{}", port_address >> 8, (port_address >> 4) & 0xF, port_address & 0xF);
}

std::vector<std::uint8_t> encode(const Dmx& packet) {
  LUXRIG_CHECK(packet.slots.size() >= 2 && packet.slots.size() <= kMostSlots && packet.slots.size() % 2 == 0,
               "{} slots", packet.slots.size());
  LUXRIG_CHECK(packet.port_address >= 0 && packet.port_address <= kHighestPortAddress, "port address {}",
               packet.port_address);
  std::vector<std::uint8_t> out = header(kData + packet.slots.size(), kOpDmx);
  out[kSequence] = packet.sequence;
  out[kPhysical] = packet.physical;
  out[kSubUni] = static_cast<std::uint8_t>(packet.port_address & 0xFF);
  out[kNet] = static_cast<std::uint8_t>(packet.port_address >> 8);
  out[kLength] = static_cast<std::uint8_t>(packet.slots.size() >> 8);
  out[kLength + 1] = static_cast<std::uint8_t>(packet.slots.size() & 0xFF);
  std::copy(packet.slots.begin(), packet.slots.end(), out.begin() + kData);
  return out;
}

std::optional<Dmx> decode_dmx(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kData || !has_header(bytes, kOpDmx)) return std::nullopt;
  const std::size_t length = static_cast<std::size_t>(bytes[kLength]) << 8 | bytes[kLength + 1];
  if (bytes[kProtocol] != 0 || bytes[kProtocol + 1] < kProtocolVersion || (bytes[kNet] & 0x80) != 0)
    return std::nullopt;
  if (length < 2 || length > kMostSlots || length % 2 != 0 || bytes.size() != kData + length) return std::nullopt;
  Dmx packet;
  packet.sequence = bytes[kSequence];
  packet.physical = bytes[kPhysical];
  packet.port_address = bytes[kNet] << 8 | bytes[kSubUni];
  packet.slots.assign(bytes.begin() + kData, bytes.end());
  return packet;
}

std::vector<std::uint8_t> encode_poll() {
  std::vector<std::uint8_t> out = header(kPollSize, kOpPoll);
  out[kPollFlags] = kReplyOnChange;
  return out;
}

std::optional<PollReply> decode_poll_reply(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kShortestReply || !has_header(bytes, kOpPollReply)) return std::nullopt;
  std::array<std::uint8_t, kReplySize> in{};
  std::copy_n(bytes.begin(), std::min(bytes.size(), in.size()), in.begin());
  const std::span<const std::uint8_t> fields(in);

  PollReply reply;
  reply.short_name = text_in(fields.subspan(kShortName, kShortNameSize));
  reply.long_name = text_in(fields.subspan(kLongName, kLongNameSize));
  reply.report = text_in(fields.subspan(kNodeReport, kNodeReportSize));
  reply.bind_index = in[kBindIndex];
  const std::size_t ports = static_cast<std::size_t>(in[kNumPorts]) << 8 | in[kNumPorts + 1];
  if (ports > kMostPorts) return std::nullopt;
  for (std::size_t port = 0; port < ports; ++port) {
    if ((in[kPortTypes + port] & kPortPutsOut) == 0) continue;
    reply.output_port_addresses.push_back((in[kNetSwitch] & 0x7F) << 8 | (in[kSubSwitch] & 0x0F) << 4 |
                                          (in[kSwOut + port] & 0x0F));
  }
  return reply;
}

}  // namespace luxrig::artnet
