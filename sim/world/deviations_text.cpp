#include "sim/world/deviations_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

namespace luxrig::sim {
namespace {

struct Field {
  std::string_view key;
  double Deviations::*value;
  double most;
};

constexpr Field kFields[] = {
    {"output_min", &Deviations::output_min, 2},
    {"output_max", &Deviations::output_max, 2},
    {"curve_exponent_spread", &Deviations::curve_exponent_spread, 0.9},
    {"drive_exponent_min", &Deviations::drive_exponent_min, 5},
    {"drive_exponent_max", &Deviations::drive_exponent_max, 5},
    {"dead_band", &Deviations::dead_band, 0.5},
    {"tail", &Deviations::tail, 0.5},
    {"lamp_lag_s", &Deviations::lamp_lag_s, 60},
    {"warm_up_share", &Deviations::warm_up_share, 1},
    {"ageing_per_hour", &Deviations::ageing_per_hour, 1},
    {"photometry_angle_rad", &Deviations::photometry_angle_rad, 1},
    {"position_error_m", &Deviations::position_error_m, 1},
    {"angle_error_rad", &Deviations::angle_error_rad, 1},
    {"backlash_rad", &Deviations::backlash_rad, 1},
    {"head_speed_share", &Deviations::head_speed_share, 0.9},
    {"head_lag_s", &Deviations::head_lag_s, 10},
    {"wrong_heads", &Deviations::wrong_heads, 1},
    {"wrong_lines", &Deviations::wrong_lines, 1},
    {"reflectance_spread", &Deviations::reflectance_spread, 0.9},
    {"object_error_m", &Deviations::object_error_m, 1},
    {"cloud_share", &Deviations::cloud_share, 1},
    {"visits_per_hour", &Deviations::visits_per_hour, 60},
    {"meter_gain_share", &Deviations::meter_gain_share, 1},
    {"meter_noise", &Deviations::meter_noise, 1},
    {"meter_lag_s", &Deviations::meter_lag_s, 60},
    {"meter_latency_min_s", &Deviations::meter_latency_min_s, 60},
    {"meter_latency_max_s", &Deviations::meter_latency_max_s, 60},
    {"meter_cosine_exponent", &Deviations::meter_cosine_exponent, 1},
    {"meter_drift_per_hour", &Deviations::meter_drift_per_hour, 1},
    {"camera_angle_rad", &Deviations::camera_angle_rad, 1},
    {"camera_position_m", &Deviations::camera_position_m, 1},
    {"camera_field_share", &Deviations::camera_field_share, 0.5},
    {"camera_distortion", &Deviations::camera_distortion, 0.3},
    {"camera_vignetting", &Deviations::camera_vignetting, 0.9},
    {"camera_flare", &Deviations::camera_flare, 0.5},
    {"camera_halo", &Deviations::camera_halo, 0.4},
    {"camera_log_response", &Deviations::camera_log_response, 2},
};

/// Kinds, by name.
struct Kind {
  std::string_view name;
  Deviations (*make)();
};
constexpr Kind kKinds[] = {{"mild", [] { return Deviations{}; }},
                           {"real", Deviations::real},
                           {"bad", Deviations::bad},
                           {"none", Deviations::none}};

/// Of each pair the first may not be above the second.
struct Range {
  std::string_view least, most;
  double Deviations::*from, Deviations::*to;
};
constexpr Range kRanges[] = {
    {"output_min", "output_max", &Deviations::output_min, &Deviations::output_max},
    {"drive_exponent_min", "drive_exponent_max", &Deviations::drive_exponent_min, &Deviations::drive_exponent_max},
    {"meter_latency_min_s", "meter_latency_max_s", &Deviations::meter_latency_min_s, &Deviations::meter_latency_max_s},
};

}  // namespace

Checked<Deviations> parse_deviations(const std::string& text, const std::string& file) {
  Deviations deviations;
  std::vector<Problem> problems;
  const auto problem = [&](std::string what, std::string mend) {
    problems.push_back({file, 0, 0, std::move(what), std::move(mend)});
  };
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');) {
    const auto* kind =
        std::find_if(std::begin(kKinds), std::end(kKinds), [&](const Kind& k) { return k.name == part; });
    if (kind != std::end(kKinds)) {
      deviations = kind->make();
      continue;
    }
    const auto equals = part.find('=');
    const std::string key = part.substr(0, equals);
    const Field* field = nullptr;
    std::string known = "mild, real, bad, none";
    for (const Field& each : kFields) {
      if (each.key == key) field = &each;
      known += fmt::format(", {}", each.key);
    }
    if (field == nullptr) {
      problem(fmt::format("unknown deviation '{}'", key), "use " + known);
      continue;
    }
    double value = NAN;
    const char* const end = part.data() + part.size();
    const char* const begin = equals == std::string::npos ? end : part.data() + equals + 1;
    const auto [stopped, error] = std::from_chars(begin, end, value);
    if (error != std::errc() || stopped != end || !(value >= 0 && value <= field->most)) {
      problem(fmt::format("'{}' has no good value", part), fmt::format("write {}=0 … {}", key, field->most));
      continue;
    }
    deviations.*field->value = value;
  }
  for (const Range& range : kRanges)
    if (problems.empty() && deviations.*range.from > deviations.*range.to)
      problem(fmt::format("{} is above {}", range.least, range.most), "swap them");
  if (!problems.empty()) return tl::unexpected(std::move(problems));
  return deviations;
}

}  // namespace luxrig::sim
