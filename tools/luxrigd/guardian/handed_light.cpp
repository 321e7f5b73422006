#include "tools/luxrigd/guardian/handed_light.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace luxrig {
namespace {

using nlohmann::json;

constexpr double kLongestHold_s = 1e6;

/// The value if it is a number within bounds, else NaN.
double number_within(const json& value, double least, double most) {
  const double number = value.is_number() ? value.get<double>() : std::nan("");
  return number >= least && number <= most ? number : std::nan("");
}

bool read_levels(const json& from, std::size_t fixtures, std::vector<double>& into) {
  if (!from.is_array() || from.size() != fixtures) return false;
  for (const json& one : from) {
    into.push_back(number_within(one, 0, 1));
    if (std::isnan(into.back())) return false;
  }
  return true;
}

/// A missing or empty list means that all fixtures are sent.
bool read_silent(const json& from, std::size_t fixtures, std::vector<std::uint8_t>& into) {
  if (from.is_null() || (from.is_array() && from.empty())) return true;
  if (!from.is_array() || from.size() != fixtures) return false;
  for (const json& one : from) {
    const double number = number_within(one, 0, 1);
    if (std::isnan(number)) return false;
    into.push_back(number > 0 ? 1 : 0);
  }
  return true;
}

}  // namespace

std::string handed_light_text(const LightInForce& light) {
  json joints = json::array();
  for (const Joints& one : light.look.joints) joints.push_back({one.pan_rad, one.tilt_rad, one.beam_rad});
  return json({{"levels", light.look.levels},
               {"safe", light.safe_levels},
               {"joints_rad", joints},
               {"silent", light.silent},
               {"hold_s", light.hold_s},
               {"fade_s", light.fade_s}})
      .dump();
}

std::optional<LightInForce> handed_light_of(const std::string& text, std::size_t fixtures) {
  const json all = json::parse(text, nullptr, false);
  if (!all.is_object()) return std::nullopt;
  const auto part = [&all](const char* key) { return all.contains(key) ? all[key] : json(); };
  LightInForce light;
  if (!read_levels(part("levels"), fixtures, light.look.levels) ||
      !read_levels(part("safe"), fixtures, light.safe_levels) || !read_silent(part("silent"), fixtures, light.silent))
    return std::nullopt;
  light.hold_s = number_within(part("hold_s"), 0, kLongestHold_s);
  light.fade_s = number_within(part("fade_s"), 0, kLongestHold_s);
  const json joints = part("joints_rad");
  if (std::isnan(light.hold_s) || std::isnan(light.fade_s) || !joints.is_array() || joints.size() != fixtures)
    return std::nullopt;
  for (const json& one : joints) {
    if (!one.is_array() || one.size() != 3) return std::nullopt;
    constexpr double kMax_rad = 1e3;
    const Joints read{number_within(one[0], -kMax_rad, kMax_rad), number_within(one[1], -kMax_rad, kMax_rad),
                      number_within(one[2], -kMax_rad, kMax_rad)};
    if (std::isnan(read.pan_rad + read.tilt_rad + read.beam_rad)) return std::nullopt;
    light.look.joints.push_back(read);
  }
  return light;
}

}  // namespace luxrig
