#include "drivers/dmx/rdm/rdm_values.h"

#include <limits>

#include "core/check.h"

namespace luxrig::rdm {
namespace {

using Data = std::span<const std::uint8_t>;

constexpr std::size_t kDeviceInfoSize = 19;
constexpr std::size_t kSlotInfoSize = 5;
constexpr int kLastAddress = 512;
constexpr std::uint16_t kNoAddress = 0xFFFF;
constexpr std::uint16_t kForEver = 0xFFFF;

int value_16(Data data, std::size_t at) { return data[at] << 8 | data[at + 1]; }
int signed_16(Data data, std::size_t at) { return static_cast<std::int16_t>(value_16(data, at)); }
std::uint32_t value_32(Data data, std::size_t at) {
  return static_cast<std::uint32_t>(value_16(data, at)) << 16 | static_cast<std::uint32_t>(value_16(data, at + 2));
}

double tenths(int value) { return value == kForEver ? std::numeric_limits<double>::infinity() : value * 0.1; }

}  // namespace

std::optional<DeviceInfo> decode_device_info(Data data) {
  if (data.size() != kDeviceInfoSize) return std::nullopt;
  DeviceInfo info;
  info.protocol_version = static_cast<std::uint16_t>(value_16(data, 0));
  info.model = static_cast<std::uint16_t>(value_16(data, 2));
  info.category = static_cast<std::uint16_t>(value_16(data, 4));
  info.software_version = value_32(data, 6);
  info.footprint_slots = value_16(data, 10);
  info.personality = data[12];
  info.personalities = data[13];
  const auto address = decode_start_address(data.subspan(14, 2));
  if (info.footprint_slots > kLastAddress || !address) return std::nullopt;
  info.start_address = *address;
  info.sub_devices = value_16(data, 16);
  info.sensors = data[18];
  return info;
}

std::optional<std::vector<Pid>> decode_supported_parameters(Data data) {
  if (data.size() % 2 != 0) return std::nullopt;
  std::vector<Pid> pids;
  for (std::size_t at = 0; at < data.size(); at += 2) pids.push_back(static_cast<Pid>(value_16(data, at)));
  return pids;
}

std::optional<std::string> decode_label(Data data) {
  if (data.size() > kMaxLabel) return std::nullopt;
  std::string text;
  for (const std::uint8_t byte : data) {
    if (byte == 0) break;
    text += byte < 0x20 || byte >= 0x7F ? '?' : static_cast<char>(byte);
  }
  return text;
}

std::optional<std::optional<int>> decode_start_address(Data data) {
  if (data.size() != 2) return std::nullopt;
  const int address = value_16(data, 0);
  if (address == kNoAddress) return std::optional<int>();
  if (address < 1 || address > kLastAddress) return std::nullopt;
  return std::optional<int>(address);
}

std::vector<std::uint8_t> encode_start_address(int address) {
  LUXRIG_CHECK(address >= 1 && address <= kLastAddress, "address {}", address);
  return {static_cast<std::uint8_t>(address >> 8), static_cast<std::uint8_t>(address & 0xFF)};
}

std::optional<Personality> decode_personality(Data data) {
  if (data.size() != 2) return std::nullopt;
  return Personality{data[0], data[1]};
}

std::optional<PersonalityDescription> decode_personality_description(Data data) {
  if (data.size() < 3) return std::nullopt;
  auto text = decode_label(data.subspan(3));
  if (!text) return std::nullopt;
  return PersonalityDescription{data[0], value_16(data, 1), std::move(*text)};
}

std::optional<bool> decode_flag(Data data) {
  if (data.size() != 1 || data[0] > 1) return std::nullopt;
  return data[0] == 1;
}

std::optional<std::uint32_t> decode_hours(Data data) {
  if (data.size() != 4) return std::nullopt;
  return value_32(data, 0);
}

std::optional<LampState> decode_lamp_state(Data data) {
  if (data.size() != 1) return std::nullopt;
  return static_cast<LampState>(data[0]);
}

std::optional<SensorDefinition> decode_sensor_definition(Data data) {
  if (data.size() < 13) return std::nullopt;
  auto description = decode_label(data.subspan(13));
  if (!description) return std::nullopt;
  SensorDefinition sensor;
  sensor.number = data[0];
  sensor.type = data[1];
  sensor.unit = data[2];
  sensor.prefix = data[3];
  sensor.range_min = signed_16(data, 4);
  sensor.range_max = signed_16(data, 6);
  sensor.normal_min = signed_16(data, 8);
  sensor.normal_max = signed_16(data, 10);
  sensor.records_value = (data[12] & 0x01) != 0;
  sensor.records_extremes = (data[12] & 0x02) != 0;
  sensor.description = std::move(*description);
  return sensor;
}

std::optional<SensorValue> decode_sensor_value(Data data) {
  if (data.size() != 9) return std::nullopt;
  return SensorValue{data[0], signed_16(data, 1), signed_16(data, 3), signed_16(data, 5), signed_16(data, 7)};
}

std::optional<std::vector<SlotInfo>> decode_slot_info(Data data) {
  if (data.size() % kSlotInfoSize != 0 || data.size() / kSlotInfoSize > kLastAddress) return std::nullopt;
  std::vector<SlotInfo> slots;
  for (std::size_t at = 0; at < data.size(); at += kSlotInfoSize) {
    slots.push_back({value_16(data, at), data[at + 2], static_cast<std::uint16_t>(value_16(data, at + 3))});
    if (slots.back().offset >= kLastAddress) return std::nullopt;
  }
  return slots;
}

std::optional<FailMode> decode_fail_mode(Data data) {
  if (data.size() != 7) return std::nullopt;
  return FailMode{value_16(data, 0), tenths(value_16(data, 2)), tenths(value_16(data, 4)), data[6]};
}

}  // namespace luxrig::rdm
