#include "sim/world/deviations_text.h"

#include <fmt/format.h>

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
    {"position_error_m", &Deviations::position_error_m, 1},
    {"angle_error_rad", &Deviations::angle_error_rad, 1},
    {"meter_gain_share", &Deviations::meter_gain_share, 1},
    {"meter_noise", &Deviations::meter_noise, 1},
    {"meter_lag_s", &Deviations::meter_lag_s, 60},
    {"lamp_lag_s", &Deviations::lamp_lag_s, 60},
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
    if (part == "usual" || part == "none") {
      deviations = part == "none" ? Deviations::none() : Deviations{};
      continue;
    }
    const auto equals = part.find('=');
    const std::string key = part.substr(0, equals);
    const Field* field = nullptr;
    std::string known = "usual, none";
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
  if (problems.empty() && deviations.output_min > deviations.output_max) {
    problem("output_min is above output_max", "swap them");
  }
  if (!problems.empty()) return tl::unexpected(std::move(problems));
  return deviations;
}

}  // namespace luxrig::sim
