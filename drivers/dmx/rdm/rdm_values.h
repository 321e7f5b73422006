#pragma once
/// RDM parameter data ↔ values. A decoder returns empty for data of the wrong length or form. Pure. Source: ANSI
/// E1.20-2010, chapter 10 and appendix A; E1.37-1 for the fail mode.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/dmx/rdm/rdm_packet.h"

namespace luxrig::rdm {

inline constexpr std::size_t kMaxLabel = 32;  ///< bytes

struct DeviceInfo {
  std::uint16_t protocol_version = 0x0100;
  std::uint16_t model = 0;
  std::uint16_t category = 0;
  std::uint32_t software_version = 0;
  int footprint_slots = 0;
  int personality = 0, personalities = 0;  ///< counted from 1
  std::optional<int> start_address;        ///< 1…512; empty = it has no slots
  int sub_devices = 0;
  int sensors = 0;
};
[[nodiscard]] std::optional<DeviceInfo> decode_device_info(std::span<const std::uint8_t> data);

[[nodiscard]] std::optional<std::vector<Pid>> decode_supported_parameters(std::span<const std::uint8_t> data);

/// A label up to the first NUL; a byte outside printable ASCII becomes '?'. Empty above 32 bytes.
[[nodiscard]] std::optional<std::string> decode_label(std::span<const std::uint8_t> data);

/// 1…512; an inner empty value = the device has no slots.
[[nodiscard]] std::optional<std::optional<int>> decode_start_address(std::span<const std::uint8_t> data);
/// requires 1…512.
[[nodiscard]] std::vector<std::uint8_t> encode_start_address(int address);

struct Personality {
  int current = 0, count = 0;  ///< from 1
};
[[nodiscard]] std::optional<Personality> decode_personality(std::span<const std::uint8_t> data);
struct PersonalityDescription {
  int number = 0;
  int footprint_slots = 0;
  std::string text;
};
[[nodiscard]] std::optional<PersonalityDescription> decode_personality_description(std::span<const std::uint8_t> data);

/// IDENTIFY_DEVICE, PAN_INVERT and other values of 0 or 1.
[[nodiscard]] std::optional<bool> decode_flag(std::span<const std::uint8_t> data);

/// DEVICE_HOURS, LAMP_HOURS.
[[nodiscard]] std::optional<std::uint32_t> decode_hours(std::span<const std::uint8_t> data);

enum class LampState : std::uint8_t { off, on, strike, standby, not_present, error = 0x7F };
/// An unknown state keeps its number.
[[nodiscard]] std::optional<LampState> decode_lamp_state(std::span<const std::uint8_t> data);
[[nodiscard]] std::string text_of(LampState state);

/// A sensor's quantity and unit, scaled by a power of ten.
struct SensorDefinition {
  int number = 0;
  std::uint8_t type = 0;                                             ///< 0x00 temperature, 0x01 voltage …
  std::uint8_t unit = 0;                                             ///< 0x01 °C …
  std::uint8_t prefix = 0;                                           ///< 0x00 none, 0x03 milli, 0x13 kilo …
  int range_min = 0, range_max = 0, normal_min = 0, normal_max = 0;  ///< before the prefix
  bool records_value = false, records_extremes = false;
  std::string description;
};
[[nodiscard]] std::optional<SensorDefinition> decode_sensor_definition(std::span<const std::uint8_t> data);
struct SensorValue {
  int number = 0;
  int present = 0, lowest = 0, highest = 0, recorded = 0;  ///< before the prefix
};
[[nodiscard]] std::optional<SensorValue> decode_sensor_value(std::span<const std::uint8_t> data);
/// "41.5 °C": a value of this sensor in its unit, prefix applied.
[[nodiscard]] std::string text_of(const SensorDefinition& sensor, int value);
[[nodiscard]] std::string_view name_of_unit(std::uint8_t unit);         ///< "°C"; empty = none, or unknown
[[nodiscard]] std::string_view name_of_sensor_type(std::uint8_t type);  ///< "temperature"
/// 10ⁿ of a prefix; 0 for one outside the standard.
[[nodiscard]] int exponent_of_prefix(std::uint8_t prefix);

/// Purpose of one slot of the footprint.
struct SlotInfo {
  int offset = 0;           ///< from 0
  std::uint8_t type = 0;    ///< 0 primary, 1 fine, 2 timing, 3 speed …
  std::uint16_t label = 0;  ///< primary: 0x0001 intensity, 0x0101 pan …; else the offset of the slot it belongs to
};
[[nodiscard]] std::optional<std::vector<SlotInfo>> decode_slot_info(std::span<const std::uint8_t> data);
inline constexpr std::uint16_t kIntensitySlot = 0x0001, kPanSlot = 0x0101, kTiltSlot = 0x0102, kZoomSlot = 0x0405;

struct FailMode {
  int scene = 0;            ///< 0 = hold the last look
  double loss_delay_s = 0;  ///< infinity = never
  double hold_s = 0;        ///< infinity = for ever
  int level_dmx = 0;
};
/// DMX_FAIL_MODE and DMX_STARTUP_MODE.
[[nodiscard]] std::optional<FailMode> decode_fail_mode(std::span<const std::uint8_t> data);

/// "moving head", "dimmer" …, by the coarse and fine category.
[[nodiscard]] std::string_view name_of_category(std::uint16_t category);

/// Data of a GET answer for a person: in words if the form is known here and fits, else the bytes.
[[nodiscard]] std::string describe(Pid pid, std::span<const std::uint8_t> data);

}  // namespace luxrig::rdm
