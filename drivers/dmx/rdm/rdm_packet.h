#pragma once
/// RDM packets as transmitted on a DMX pair, and names for their numbers. Pure.
/// Source: ANSI E1.20-2010; DMX_FAIL_MODE and its kin: ANSI E1.37-1.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace luxrig::rdm {

inline constexpr std::uint8_t kStartCode = 0xCC;
inline constexpr std::size_t kMaxData = 231;   ///< bytes of parameter data in one packet
inline constexpr std::size_t kMaxBytes = 257;  ///< of a packet, from start code to checksum

/// Permanent identity of a device: ESTA's number of the manufacturer, and the manufacturer's own number.
struct Uid {
  std::uint16_t manufacturer = 0;
  std::uint32_t device = 0;
  friend auto operator<=>(const Uid&, const Uid&) = default;
};
inline constexpr Uid kEverybody{0xFFFF, 0xFFFFFFFF};
/// All devices, or all of one manufacturer: such a request is not answered.
[[nodiscard]] constexpr bool is_broadcast(const Uid& uid) { return uid.device == 0xFFFFFFFF; }
/// As a 48-bit number, and back. requires number < 2⁴⁸.
[[nodiscard]] constexpr std::uint64_t number_of(const Uid& uid) {
  return std::uint64_t{uid.manufacturer} << 32 | uid.device;
}
[[nodiscard]] constexpr Uid uid_of(std::uint64_t number) {
  return {static_cast<std::uint16_t>(number >> 32 & 0xFFFF), static_cast<std::uint32_t>(number & 0xFFFFFFFF)};
}
[[nodiscard]] std::string text_of(const Uid& uid);  ///< "7a70:ffffff02"
/// "7a70:ffffff02" or "7a70ffffff02"; else empty.
[[nodiscard]] std::optional<Uid> parse_uid(std::string_view text);
/// requires six bytes.
[[nodiscard]] Uid uid_from(std::span<const std::uint8_t> six_bytes);
void append(std::vector<std::uint8_t>& bytes, const Uid& uid);

enum class CommandClass : std::uint8_t {
  discovery = 0x10,
  discovery_response = 0x11,
  get = 0x20,
  get_response = 0x21,
  set = 0x30,
  set_response = 0x31
};
/// requires the class of a request.
[[nodiscard]] constexpr CommandClass response_to(CommandClass request) {
  return static_cast<CommandClass>(static_cast<std::uint8_t>(request) + 1);
}

enum class ResponseType : std::uint8_t { ack = 0, ack_timer = 1, nack = 2, ack_overflow = 3 };

enum class NackReason : std::uint16_t {
  unknown_pid,
  format_error,
  hardware_fault,
  proxy_reject,
  write_protect,
  unsupported_command_class,
  data_out_of_range,
  buffer_full,
  packet_size_unsupported,
  sub_device_out_of_range,
  proxy_buffer_full
};
/// "write protect (4): remedy"; an unknown reason as its number.
[[nodiscard]] std::string text_of_nack(std::uint16_t reason);

enum class Pid : std::uint16_t {
  disc_unique_branch = 0x0001,
  disc_mute = 0x0002,
  disc_un_mute = 0x0003,
  queued_message = 0x0020,
  status_messages = 0x0030,
  supported_parameters = 0x0050,
  device_info = 0x0060,
  device_model_description = 0x0080,
  manufacturer_label = 0x0081,
  device_label = 0x0082,
  software_version_label = 0x00C0,
  dmx_personality = 0x00E0,
  dmx_personality_description = 0x00E1,
  dmx_start_address = 0x00F0,
  slot_info = 0x0120,
  default_slot_value = 0x0122,
  dmx_fail_mode = 0x0141,
  dmx_startup_mode = 0x0142,
  sensor_definition = 0x0200,
  sensor_value = 0x0201,
  device_hours = 0x0400,
  lamp_hours = 0x0401,
  lamp_state = 0x0403,
  pan_invert = 0x0600,
  tilt_invert = 0x0601,
  pan_tilt_swap = 0x0602,
  identify_device = 0x1000,
  reset_device = 0x1001
};
/// "dmx_start_address"; "0x8001" for an unknown one.
[[nodiscard]] std::string text_of(Pid pid);
/// "dmx_start_address", "DMX-START-ADDRESS" or "0x00f0".
[[nodiscard]] std::optional<Pid> parse_pid(std::string_view text);

struct Packet {
  Uid to, from;
  std::uint8_t transaction = 0;
  std::uint8_t port_or_type = 1;   ///< of a request: port, 1…255; of a response: ResponseType
  std::uint8_t message_count = 0;  ///< of a response: messages waiting in the responder's queue
  std::uint16_t sub_device = 0;    ///< 0 = the device itself; 0xFFFF = all its sub-devices
  CommandClass command_class = CommandClass::get;
  Pid pid = Pid::device_info;
  std::vector<std::uint8_t> data;  ///< at most kMaxData
};
/// From start code to checksum. requires data.size() <= kMaxData.
[[nodiscard]] std::vector<std::uint8_t> encode(const Packet& packet);
/// From the start code on; bytes after the checksum are ignored. Empty unless the lengths agree, the checksum is right
/// and the command class is one of the six.
[[nodiscard]] std::optional<Packet> decode(std::span<const std::uint8_t> bytes);

/// Sum of all bytes, modulo 2¹⁶.
[[nodiscard]] std::uint16_t checksum_of(std::span<const std::uint8_t> bytes);

}  // namespace luxrig::rdm
