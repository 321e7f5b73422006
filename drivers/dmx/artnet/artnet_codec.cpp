#include "drivers/dmx/artnet/artnet_codec.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/check.h"

namespace luxrig::artnet {
namespace {

// Offsets, grouped by the specification's table. Op codes are low byte first, most other fields high byte first.
constexpr std::size_t kOpCode = 8;
constexpr std::size_t kProtocol = 10;
constexpr std::array<std::uint8_t, 8> kId = {'A', 'r', 't', '-', 'N', 'e', 't', 0};
constexpr std::uint16_t kProtocolVersion = 14;
constexpr std::uint16_t kOpPoll = 0x2000, kOpPollReply = 0x2100, kOpDmx = 0x5000, kOpSync = 0x5200, kOpAddress = 0x6000;

// ArtDmx
constexpr std::size_t kSequence = 12;
constexpr std::size_t kPhysical = 13;
constexpr std::size_t kSubUni = 14;
constexpr std::size_t kNet = 15;
constexpr std::size_t kLength = 16;
constexpr std::size_t kData = 18;
constexpr std::size_t kMaxSlots = 512;

// ArtPoll
constexpr std::size_t kPollFlags = 12;
constexpr std::size_t kPollSize = 14;
constexpr std::uint8_t kReplyOnChange = 0x02, kTargeted = 0x20;
constexpr std::size_t kTargetTop = 14, kTargetBottom = 16, kTargetedPollSize = 18;

// ArtSync
constexpr std::size_t kSyncPacketSize = 14;

// ArtAddress
constexpr std::size_t kAddressSize = 107;
constexpr std::size_t kAddressNet = 12, kAddressBind = 13, kAddressSwitches = 96, kAddressSwitchCount = 8;
constexpr std::size_t kAddressSub = 104, kAddressAcnPriority = 105, kAddressCommand = 106;
constexpr std::uint8_t kNoChange = 0x7F, kPriorityUnchanged = 255;

// ArtPollReply
constexpr std::size_t kReplySize = 239, kShortestReply = 207;
constexpr std::size_t kIp = 10, kReplyPort = 14, kFirmware = 16;
constexpr std::size_t kNetSwitch = 18;
constexpr std::size_t kSubSwitch = 19;
constexpr std::size_t kShortName = 26, kShortNameSize = 18;
constexpr std::size_t kLongName = 44, kLongNameSize = 64;
constexpr std::size_t kNodeReport = 108, kNodeReportSize = 64;
constexpr std::size_t kNumPorts = 172;
constexpr std::size_t kPortTypes = 174;
constexpr std::size_t kOem = 20, kStatus1 = 23;
constexpr std::size_t kGoodOutput = 182;
constexpr std::size_t kSwOut = 190;
constexpr std::size_t kMac = 201;
constexpr std::size_t kBindIp = 207;
constexpr std::size_t kBindIndex = 211;
constexpr std::size_t kMaxPorts = 4;
constexpr std::size_t kStatus2 = 212, kStatus3 = 217;
constexpr std::uint8_t kPortPutsOut = 0x80;
constexpr std::uint8_t kSending = 0x80, kMerging = 0x08, kMergesLtp = 0x02;
constexpr std::uint8_t kLongPortAddresses = 0x08;  // Status2: 15-bit port addresses, Art-Net 3 and later
constexpr std::uint8_t kIndicatorsNormal = 0xC0;   // Status1, bits 7 and 6
constexpr std::uint8_t kOemUnknown = 0xFF;

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

/// As has_header, and of a protocol that is spoken here. ArtPollReply has no version.
bool has_versioned_header(std::span<const std::uint8_t> bytes, std::uint16_t op_code) {
  return bytes.size() >= kProtocol + 2 && has_header(bytes, op_code) &&
         (bytes[kProtocol] << 8 | bytes[kProtocol + 1]) >= kProtocolVersion;
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
  LUXRIG_CHECK(packet.slots.size() >= 2 && packet.slots.size() <= kMaxSlots && packet.slots.size() % 2 == 0, "{} slots",
               packet.slots.size());
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
  if (bytes.size() < kData || !has_versioned_header(bytes, kOpDmx)) return std::nullopt;
  const std::size_t length = static_cast<std::size_t>(bytes[kLength]) << 8 | bytes[kLength + 1];
  if (bytes[kNet] > 0x7F || length < 2 || length > kMaxSlots || length % 2 != 0) return std::nullopt;
  if (bytes.size() < kData + length) return std::nullopt;
  Dmx packet;
  packet.sequence = bytes[kSequence];
  packet.physical = bytes[kPhysical];
  packet.port_address = bytes[kNet] << 8 | bytes[kSubUni];
  const auto slots = bytes.subspan(kData, length);
  packet.slots.assign(slots.begin(), slots.end());
  return packet;
}

std::vector<std::uint8_t> encode_poll() {
  std::vector<std::uint8_t> out = header(kPollSize, kOpPoll);
  out[kPollFlags] = kReplyOnChange;
  return out;
}

std::optional<Poll> decode_poll(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kPollSize || !has_versioned_header(bytes, kOpPoll)) return std::nullopt;
  Poll poll;
  poll.reply_on_change = (bytes[kPollFlags] & kReplyOnChange) != 0;
  if ((bytes[kPollFlags] & kTargeted) != 0 && bytes.size() >= kTargetedPollSize) {
    poll.highest_port_address = bytes[kTargetTop] << 8 | bytes[kTargetTop + 1];
    poll.lowest_port_address = bytes[kTargetBottom] << 8 | bytes[kTargetBottom + 1];
  }
  return poll;
}

std::vector<std::uint8_t> encode_sync() { return header(kSyncPacketSize, kOpSync); }

bool is_sync(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= kSyncPacketSize && has_versioned_header(bytes, kOpSync);
}

std::vector<std::uint8_t> encode(const Address& packet) {
  LUXRIG_CHECK(packet.port >= 0 && packet.port < static_cast<int>(kMaxPorts), "port {}", packet.port);
  std::vector<std::uint8_t> out = header(kAddressSize, kOpAddress);
  out[kAddressNet] = kNoChange;
  out[kAddressBind] = static_cast<std::uint8_t>(packet.bind_index);
  std::fill_n(out.begin() + kAddressSwitches, kAddressSwitchCount, kNoChange);
  out[kAddressSub] = kNoChange;
  out[kAddressAcnPriority] = kPriorityUnchanged;
  const bool of_a_port = packet.command == AddressCommand::merge_ltp || packet.command == AddressCommand::merge_htp;
  out[kAddressCommand] = static_cast<std::uint8_t>(static_cast<int>(packet.command) + (of_a_port ? packet.port : 0));
  return out;
}

std::optional<Address> decode_address(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kAddressSize || !has_versioned_header(bytes, kOpAddress)) return std::nullopt;
  Address packet;
  packet.bind_index = bytes[kAddressBind];
  const int command = bytes[kAddressCommand];
  if (command == static_cast<int>(AddressCommand::cancel_merge)) packet.command = AddressCommand::cancel_merge;
  for (const AddressCommand merge : {AddressCommand::merge_ltp, AddressCommand::merge_htp}) {
    const int port = command - static_cast<int>(merge);
    if (port < 0 || port >= static_cast<int>(kMaxPorts)) continue;
    packet.command = merge;
    packet.port = port;
  }
  return packet;
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
  std::copy_n(in.begin() + kMac, reply.mac.size(), reply.mac.begin());
  const std::size_t ports = static_cast<std::size_t>(in[kNumPorts]) << 8 | in[kNumPorts + 1];
  if (ports > kMaxPorts) return std::nullopt;
  for (std::size_t port = 0; port < ports; ++port) {
    if ((in[kPortTypes + port] & kPortPutsOut) == 0) continue;
    const std::uint8_t state = in[kGoodOutput + port];
    reply.outputs.push_back({(in[kNetSwitch] & 0x7F) << 8 | (in[kSubSwitch] & 0x0F) << 4 | (in[kSwOut + port] & 0x0F),
                             (state & kSending) != 0, (state & kMerging) != 0, (state & kMergesLtp) != 0});
  }
  return reply;
}

std::vector<std::uint8_t> encode(const PollReply& reply, std::uint32_t ipv4) {
  LUXRIG_CHECK(!reply.outputs.empty() && reply.outputs.size() <= kMaxPorts, "{} ports", reply.outputs.size());
  std::vector<std::uint8_t> out(kReplySize, 0);  // ArtPollReply has no protocol version
  std::copy(kId.begin(), kId.end(), out.begin());
  out[kOpCode] = kOpPollReply & 0xFF;
  out[kOpCode + 1] = kOpPollReply >> 8;
  const auto put_text = [&](std::size_t at, std::size_t size, const std::string& text) {
    std::copy_n(text.begin(), std::min(text.size(), size - 1), out.begin() + static_cast<std::ptrdiff_t>(at));
  };
  for (const std::size_t at : {kIp, kBindIp}) {
    for (std::size_t i = 0; i < 4; ++i) out[at + i] = static_cast<std::uint8_t>(ipv4 >> (24 - 8 * i));
  }
  out[kReplyPort] = kPort & 0xFF;
  out[kReplyPort + 1] = kPort >> 8;
  out[kFirmware + 1] = 1;
  const int page = reply.outputs.front().port_address >> 4;
  out[kNetSwitch] = static_cast<std::uint8_t>(page >> 4);
  out[kSubSwitch] = static_cast<std::uint8_t>(page & 0x0F);
  out[kOem + 1] = kOemUnknown;
  out[kStatus1] = kIndicatorsNormal;
  put_text(kShortName, kShortNameSize, reply.short_name);
  put_text(kLongName, kLongNameSize, reply.long_name);
  put_text(kNodeReport, kNodeReportSize, reply.report);
  out[kNumPorts + 1] = static_cast<std::uint8_t>(reply.outputs.size());
  for (std::size_t i = 0; i < reply.outputs.size(); ++i) {
    const PortOutput& port = reply.outputs[i];
    LUXRIG_CHECK(port.port_address >> 4 == page, "port address {} on page {}", port.port_address, page);
    out[kPortTypes + i] = kPortPutsOut;
    out[kGoodOutput + i] = static_cast<std::uint8_t>((port.sending ? kSending : 0) | (port.merging ? kMerging : 0) |
                                                     (port.ltp ? kMergesLtp : 0));
    out[kSwOut + i] = static_cast<std::uint8_t>(port.port_address & 0x0F);
  }
  std::copy(reply.mac.begin(), reply.mac.end(), out.begin() + kMac);
  out[kBindIndex] = static_cast<std::uint8_t>(reply.bind_index);
  out[kStatus2] = kLongPortAddresses;
  out[kStatus3] = 0;  // failsafe: hold the last look
  return out;
}

}  // namespace luxrig::artnet
