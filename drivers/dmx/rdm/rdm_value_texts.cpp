// Names of RDM parameter values.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "drivers/dmx/rdm/rdm_values.h"

namespace luxrig::rdm {
namespace {

// Table A-13 of the standard, from 0x00 on.
constexpr std::string_view kUnits[] = {"",   "°C", "V", "V",  "V",  "A",     "A",   "A",    "Hz", "Ω",
                                       "W",  "kg", "m", "m²", "m³", "kg/m³", "m/s", "m/s²", "N",  "J",
                                       "Pa", "s",  "°", "sr", "cd", "lm",    "lx",  "ir",   "B"};

// Table A-12, from 0x00 on.
constexpr std::string_view kSensorTypes[] = {"temperature",
                                             "voltage",
                                             "current",
                                             "frequency",
                                             "resistance",
                                             "power",
                                             "mass",
                                             "length",
                                             "area",
                                             "volume",
                                             "density",
                                             "velocity",
                                             "acceleration",
                                             "force",
                                             "energy",
                                             "pressure",
                                             "time",
                                             "angle",
                                             "position x",
                                             "position y",
                                             "position z",
                                             "angular velocity",
                                             "luminous intensity",
                                             "luminous flux",
                                             "illuminance",
                                             "chrominance red",
                                             "chrominance green",
                                             "chrominance blue",
                                             "contacts",
                                             "memory",
                                             "items",
                                             "humidity",
                                             "counter"};

struct NamedCategory {
  std::uint16_t category;
  std::string_view name;
};
// Table A-5. The high byte is the coarse category; of the fine ones, those that matter here.
constexpr NamedCategory kCategories[] = {
    {0x0101, "fixed fixture"},
    {0x0102, "moving head"},
    {0x0103, "moving mirror"},
    {0x0100, "fixture"},
    {0x0200, "fixture accessory"},
    {0x0300, "projector"},
    {0x0400, "atmospheric"},
    {0x0500, "dimmer"},
    {0x0600, "power"},
    {0x0700, "scenic"},
    {0x0800, "data"},
    {0x0900, "audio-visual"},
    {0x0A00, "monitor"},
    {0x7000, "control"},
    {0x7100, "test equipment"},
};

std::string hex_of(std::span<const std::uint8_t> data) {
  std::string text;
  for (const std::uint8_t byte : data) text += fmt::format("{}{:02x}", text.empty() ? "" : " ", byte);
  return text.empty() ? "no data" : text;
}

std::string text_of_address(const std::optional<int>& address) {
  return address ? fmt::format("address {}", *address) : "no address";
}

std::string text_of_info(const DeviceInfo& info) {
  return fmt::format("model {}, {}, software {}, footprint {}, personality {} of {}, {}, {} sub-devices, {} sensors",
                     info.model, name_of_category(info.category), info.software_version, info.footprint_slots,
                     info.personality, info.personalities, text_of_address(info.start_address), info.sub_devices,
                     info.sensors);
}

std::string text_of_seconds(double seconds) {
  return std::isfinite(seconds) ? fmt::format("{:.1f} s", seconds) : std::string("for ever");
}

/// The data in words, or empty if they do not fit the form.
std::optional<std::string> in_words(Pid pid, std::span<const std::uint8_t> data) {
  switch (pid) {
    case Pid::device_info:
      if (const auto info = decode_device_info(data)) return text_of_info(*info);
      break;
    case Pid::supported_parameters:
      if (const auto pids = decode_supported_parameters(data)) {
        std::string text;
        for (const Pid one : *pids) text += (text.empty() ? "" : ", ") + text_of(one);
        return text;
      }
      break;
    case Pid::device_model_description:
    case Pid::manufacturer_label:
    case Pid::device_label:
    case Pid::software_version_label:
      return decode_label(data);
    case Pid::dmx_start_address:
      if (const auto address = decode_start_address(data)) return text_of_address(*address);
      break;
    case Pid::dmx_personality:
      if (const auto personality = decode_personality(data)) {
        return fmt::format("{} of {}", personality->current, personality->count);
      }
      break;
    case Pid::dmx_personality_description:
      if (const auto one = decode_personality_description(data)) {
        return fmt::format("{}: {} slots, {}", one->number, one->footprint_slots, one->text);
      }
      break;
    case Pid::identify_device:
    case Pid::pan_invert:
    case Pid::tilt_invert:
    case Pid::pan_tilt_swap:
      if (const auto flag = decode_flag(data)) return *flag ? "on" : "off";
      break;
    case Pid::device_hours:
    case Pid::lamp_hours:
      if (const auto hours = decode_hours(data)) return fmt::format("{} h", *hours);
      break;
    case Pid::lamp_state:
      if (const auto state = decode_lamp_state(data)) return text_of(*state);
      break;
    case Pid::sensor_definition:
      if (const auto sensor = decode_sensor_definition(data)) {
        return fmt::format("{}: {}, {}, normally {} to {}", sensor->number, sensor->description,
                           name_of_sensor_type(sensor->type), text_of(*sensor, sensor->normal_min),
                           text_of(*sensor, sensor->normal_max));
      }
      break;
    case Pid::sensor_value:
      if (const auto value = decode_sensor_value(data)) {
        return fmt::format("{}: {}, lowest {}, highest {}", value->number, value->present, value->lowest,
                           value->highest);
      }
      break;
    case Pid::dmx_fail_mode:
    case Pid::dmx_startup_mode:
      if (const auto mode = decode_fail_mode(data)) {
        return fmt::format("scene {}, after {}, level {}, held {}", mode->scene, text_of_seconds(mode->loss_delay_s),
                           mode->level_dmx, text_of_seconds(mode->hold_s));
      }
      break;
    default:
      break;
  }
  return std::nullopt;
}

}  // namespace

std::string text_of(LampState state) {
  static constexpr std::string_view kNames[] = {"off", "on", "strike", "standby", "not present"};
  const auto number = static_cast<std::uint8_t>(state);
  if (number < std::size(kNames)) return std::string(kNames[number]);
  return state == LampState::error ? std::string("error") : fmt::format("state {}", number);
}

std::string_view name_of_unit(std::uint8_t unit) {
  return unit < std::size(kUnits) ? kUnits[unit] : std::string_view{};
}

std::string_view name_of_sensor_type(std::uint8_t type) {
  return type < std::size(kSensorTypes) ? kSensorTypes[type] : std::string_view("other");
}

int exponent_of_prefix(std::uint8_t prefix) {
  // Down: deci, centi, milli, then by thousands to yocto. Up: deca, hecto, kilo, then by thousands to yotta.
  static constexpr int kSteps[] = {0, 1, 2, 3, 6, 9, 12, 15, 18, 21, 24};
  const std::size_t step = prefix & 0x0F;
  if (prefix > 0x1A || step >= std::size(kSteps)) return 0;
  return prefix >= 0x10 ? kSteps[step] : -kSteps[step];
}

std::string text_of(const SensorDefinition& sensor, int value) {
  const int exponent = exponent_of_prefix(sensor.prefix);
  const std::string_view unit = name_of_unit(sensor.unit);
  const double scaled = value * std::pow(10.0, exponent);
  const std::string number =
      exponent < 0 && exponent >= -6 ? fmt::format("{:.{}f}", scaled, -exponent) : fmt::format("{:g}", scaled);
  return unit.empty() ? number : fmt::format("{} {}", number, unit);
}

std::string_view name_of_category(std::uint16_t category) {
  const auto find = [](std::uint16_t wanted) {
    return std::find_if(std::begin(kCategories), std::end(kCategories),
                        [wanted](const NamedCategory& named) { return named.category == wanted; });
  };
  auto found = find(category);
  if (found == std::end(kCategories)) found = find(static_cast<std::uint16_t>(category & 0xFF00));
  return found == std::end(kCategories) ? std::string_view("other") : found->name;
}

std::string describe(Pid pid, std::span<const std::uint8_t> data) {
  if (auto text = in_words(pid, data)) return std::move(*text);
  return hex_of(data);
}

}  // namespace luxrig::rdm
