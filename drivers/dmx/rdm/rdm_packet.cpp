#include "drivers/dmx/rdm/rdm_packet.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <numeric>

#include "core/check.h"

namespace luxrig::rdm {
namespace {

constexpr std::uint8_t kSubStartCode = 0x01;
constexpr std::size_t kHeaderSize = 24;  // start code to parameter data length
constexpr std::size_t kChecksumSize = 2;

struct NamedPid {
  Pid pid;
  std::string_view name;
};
constexpr NamedPid kPids[] = {
    {Pid::disc_unique_branch, "disc_unique_branch"},
    {Pid::disc_mute, "disc_mute"},
    {Pid::disc_un_mute, "disc_un_mute"},
    {Pid::queued_message, "queued_message"},
    {Pid::status_messages, "status_messages"},
    {Pid::supported_parameters, "supported_parameters"},
    {Pid::device_info, "device_info"},
    {Pid::device_model_description, "device_model_description"},
    {Pid::manufacturer_label, "manufacturer_label"},
    {Pid::device_label, "device_label"},
    {Pid::software_version_label, "software_version_label"},
    {Pid::dmx_personality, "dmx_personality"},
    {Pid::dmx_personality_description, "dmx_personality_description"},
    {Pid::dmx_start_address, "dmx_start_address"},
    {Pid::slot_info, "slot_info"},
    {Pid::default_slot_value, "default_slot_value"},
    {Pid::dmx_fail_mode, "dmx_fail_mode"},
    {Pid::dmx_startup_mode, "dmx_startup_mode"},
    {Pid::sensor_definition, "sensor_definition"},
    {Pid::sensor_value, "sensor_value"},
    {Pid::device_hours, "device_hours"},
    {Pid::lamp_hours, "lamp_hours"},
    {Pid::lamp_state, "lamp_state"},
    {Pid::pan_invert, "pan_invert"},
    {Pid::tilt_invert, "tilt_invert"},
    {Pid::pan_tilt_swap, "pan_tilt_swap"},
    {Pid::identify_device, "identify_device"},
    {Pid::reset_device, "reset_device"},
};

struct NackText {
  std::string_view name, mend;
};
constexpr NackText kNacks[] = {
    {"unknown PID", "the device does not have this parameter; its list is supported_parameters"},
    {"format error", "the data have another form than the device expects; perhaps its firmware is older"},
    {"hardware fault", "look at the device"},
    {"proxy reject", "the device is behind a proxy that refuses it; ask again, or without the proxy"},
    {"write protect", "unlock the device, at its own panel as a rule"},
    {"unsupported command class", "this parameter can only be read, or only be set"},
    {"data out of range", "use a value that the device has"},
    {"buffer full", "ask again later"},
    {"packet size unsupported", "send less data at once"},
    {"sub-device out of range", "the device has fewer parts"},
    {"proxy buffer full", "ask again later"},
};

void append_16(std::vector<std::uint8_t>& bytes, std::uint16_t value) {
  bytes.push_back(static_cast<std::uint8_t>(value >> 8));
  bytes.push_back(static_cast<std::uint8_t>(value & 0xFF));
}

std::uint16_t be_16(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

bool is_command_class(std::uint8_t byte) {
  return (byte & 0xF0) >= 0x10 && (byte & 0xF0) <= 0x30 && (byte & 0x0F) <= 1;
}

/// The whole text as a hexadecimal number.
template <class Number>
std::optional<Number> parse_hex(std::string_view text) {
  Number value{};
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value, 16);
  if (text.empty() || parsed.ec != std::errc() || parsed.ptr != end) return std::nullopt;
  return value;
}

}  // namespace

std::string text_of(const Uid& uid) { return fmt::format("{:04x}:{:08x}", uid.manufacturer, uid.device); }

std::optional<Uid> parse_uid(std::string_view text) {
  const std::size_t colon = text.size() == 13 ? 1 : 0;
  if (text.size() != 12 + colon || (colon == 1 && text[4] != ':')) return std::nullopt;
  const auto manufacturer = parse_hex<std::uint16_t>(text.substr(0, 4));
  const auto device = parse_hex<std::uint32_t>(text.substr(4 + colon));
  if (!manufacturer || !device) return std::nullopt;
  return Uid{*manufacturer, *device};
}

Uid uid_from(std::span<const std::uint8_t> six_bytes) {
  LUXRIG_CHECK(six_bytes.size() >= 6, "{} bytes", six_bytes.size());
  return {be_16(six_bytes, 0), static_cast<std::uint32_t>(be_16(six_bytes, 2)) << 16 | be_16(six_bytes, 4)};
}

void append(std::vector<std::uint8_t>& bytes, const Uid& uid) {
  append_16(bytes, uid.manufacturer);
  append_16(bytes, static_cast<std::uint16_t>(uid.device >> 16));
  append_16(bytes, static_cast<std::uint16_t>(uid.device & 0xFFFF));
}

std::string text_of_nack(std::uint16_t reason) {
  if (reason >= std::size(kNacks)) return fmt::format("reason {}, which is not in the standard", reason);
  return fmt::format("{} ({}): {}", kNacks[reason].name, reason, kNacks[reason].mend);
}

std::string text_of(Pid pid) {
  for (const NamedPid& named : kPids) {
    if (named.pid == pid) return std::string(named.name);
  }
  return fmt::format("0x{:04x}", static_cast<std::uint16_t>(pid));
}

std::optional<Pid> parse_pid(std::string_view text) {
  if (text.size() > 2 && text.starts_with("0x")) {
    const auto number = parse_hex<std::uint16_t>(text.substr(2));
    return number ? std::optional(static_cast<Pid>(*number)) : std::nullopt;
  }
  std::string wanted(text);
  for (char& letter : wanted) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
    if (letter == '-') letter = '_';
  }
  for (const NamedPid& named : kPids) {
    if (named.name == wanted) return named.pid;
  }
  return std::nullopt;
}

std::uint16_t checksum_of(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint16_t>(std::accumulate(bytes.begin(), bytes.end(), 0U) & 0xFFFF);
}

std::vector<std::uint8_t> encode(const Packet& packet) {
  LUXRIG_CHECK(packet.data.size() <= kMaxData, "{} bytes", packet.data.size());
  std::vector<std::uint8_t> bytes = {kStartCode, kSubStartCode,
                                     static_cast<std::uint8_t>(kHeaderSize + packet.data.size())};
  bytes.reserve(kHeaderSize + packet.data.size() + kChecksumSize);
  append(bytes, packet.to);
  append(bytes, packet.from);
  bytes.push_back(packet.transaction);
  bytes.push_back(packet.port_or_type);
  bytes.push_back(packet.message_count);
  append_16(bytes, packet.sub_device);
  bytes.push_back(static_cast<std::uint8_t>(packet.command_class));
  append_16(bytes, static_cast<std::uint16_t>(packet.pid));
  bytes.push_back(static_cast<std::uint8_t>(packet.data.size()));
  bytes.insert(bytes.end(), packet.data.begin(), packet.data.end());
  append_16(bytes, checksum_of(bytes));
  return bytes;
}

std::optional<Packet> decode(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kHeaderSize + kChecksumSize || bytes[0] != kStartCode || bytes[1] != kSubStartCode) {
    return std::nullopt;
  }
  const std::size_t length = bytes[2], data_size = bytes[23];
  if (length != kHeaderSize + data_size || bytes.size() < length + kChecksumSize) return std::nullopt;
  if (checksum_of(bytes.first(length)) != be_16(bytes, length) || !is_command_class(bytes[20])) return std::nullopt;
  Packet packet;
  packet.to = uid_from(bytes.subspan(3, 6));
  packet.from = uid_from(bytes.subspan(9, 6));
  packet.transaction = bytes[15];
  packet.port_or_type = bytes[16];
  packet.message_count = bytes[17];
  packet.sub_device = be_16(bytes, 18);
  packet.command_class = static_cast<CommandClass>(bytes[20]);
  packet.pid = static_cast<Pid>(be_16(bytes, 21));
  const auto data = bytes.subspan(kHeaderSize, data_size);
  packet.data.assign(data.begin(), data.end());
  return packet;
}

}  // namespace luxrig::rdm
