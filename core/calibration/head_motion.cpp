#include "core/calibration/head_motion.h"

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

constexpr std::size_t kFewestDark = 2, kFewestStill = 3;
/// Light stands still within this share, or so many of its own deviations.
constexpr double kStillShare = 0.04, kStillDeviations = 4;
constexpr double kClearLight = 5;  ///< over the dark and its noise
constexpr double kSharpestTime_s = 0.02;
constexpr double kLeastSure = 1.0 / 3;
/// Ways shorter than this share of the longest say little beside it.
constexpr double kWaysApart = 0.7;

struct LevelOf {
  double lux = 0, deviation = 0;
};

LevelOf level_of(std::span<const TimedLux> samples) {
  LevelOf level;
  for (const TimedLux& sample : samples) level.lux += sample.lux / static_cast<double>(samples.size());
  for (const TimedLux& sample : samples)
    level.deviation += std::pow(sample.lux - level.lux, 2) / static_cast<double>(samples.size());
  level.deviation = std::sqrt(level.deviation);
  return level;
}

/// Somewhere between two samples.
Known time_between(double before_s, double after_s, double share, double ordered_s) {
  constexpr double kOfEven = 0.2887;  // standard deviation of an even spread over 1
  return {before_s + share * (after_s - before_s) - ordered_s,
          std::max(kSharpestTime_s, kOfEven * (after_s - before_s))};
}

/// time = a + way / speed, by least squares. values: way, time.
struct Line {
  Known start_s, per_rad;
  bool known = false;
};

Line line_through(std::span<const std::pair<double, Known>> values) {
  Line line;
  double sum = 0, way = 0, time = 0, way2 = 0, way_time = 0, longest = 0, shortest = HUGE_VAL;
  for (const auto& [w, t] : values) {
    const double weight = 1 / (t.standard_error * t.standard_error);
    sum += weight;
    way += weight * w;
    time += weight * t.value;
    way2 += weight * w * w;
    way_time += weight * w * t.value;
    longest = std::max(longest, w);
    shortest = std::min(shortest, w);
  }
  const double determinant = sum * way2 - way * way;
  if (values.size() < 3 || !(shortest < kWaysApart * longest) || !(determinant > 0)) return line;
  line.per_rad.value = (sum * way_time - way * time) / determinant;
  line.start_s.value = (time - line.per_rad.value * way) / sum;
  double squares = 0;
  for (const auto& [w, t] : values)
    squares += std::pow((t.value - line.start_s.value - line.per_rad.value * w) / t.standard_error, 2);
  const double scatter = std::max(1.0, squares / static_cast<double>(values.size() - 2));
  line.per_rad.standard_error = std::sqrt(scatter * sum / determinant);
  line.start_s.standard_error = std::sqrt(scatter * way2 / determinant);
  line.known = line.per_rad.value > line.per_rad.standard_error / kLeastSure;
  return line;
}

Known mean_of(std::span<const Known> values) {
  double sum = 0, mean = 0, squares = 0;
  for (const Known& value : values) {
    sum += 1 / (value.standard_error * value.standard_error);
    mean += value.value / (value.standard_error * value.standard_error);
  }
  mean /= sum;
  for (const Known& value : values) squares += std::pow((value.value - mean) / value.standard_error, 2);
  const double scatter = values.size() > 1 ? std::max(1.0, squares / static_cast<double>(values.size() - 1)) : 1;
  return {mean, std::sqrt(scatter / sum)};
}

/// What moves took beside their ways, until half of the light was there and until it stood still.
struct BesideWay {
  std::vector<Known> half_s, still_s;
};

Known speed_of(std::span<const LightReturn> returns, BesideWay& beside) {
  std::vector<std::pair<double, Known>> half, still;
  for (const LightReturn& back : returns)
    if (const auto arrival = light_arrival(back)) {
      half.emplace_back(back.way_rad - back.half_lit_rad, arrival->half_s);
      still.emplace_back(back.way_rad, arrival->still_s);
    }
  const Line line = line_through(half);
  if (!line.known) return {};
  const auto add = [&](const std::vector<std::pair<double, Known>>& times, std::vector<Known>& to) {
    for (const auto& [way_rad, time] : times)
      to.push_back({time.value - way_rad * line.per_rad.value,
                    std::hypot(time.standard_error, way_rad * line.per_rad.standard_error)});
  };
  add(half, beside.half_s);
  add(still, beside.still_s);
  const double speed_rad_s = 1 / line.per_rad.value;
  return {deg_from_rad(speed_rad_s), deg_from_rad(line.per_rad.standard_error * speed_rad_s * speed_rad_s)};
}

/// Of moves over that of lamps.
Known longer_s(std::span<const Known> moves_s, std::span<const Known> lamps_s) {
  const Known moved = mean_of(moves_s), lamp = mean_of(lamps_s);
  return {std::max(0.0, moved.value - lamp.value), std::hypot(moved.standard_error, lamp.standard_error)};
}

}  // namespace

std::optional<LightArrival> light_arrival(const LightReturn& back) {
  const auto& all = back.samples;
  const auto first = std::find_if(all.begin(), all.end(), [&](const TimedLux& s) { return s.at_s > back.ordered_s; });
  const auto before = static_cast<std::size_t>(first - all.begin());
  if (before < kFewestDark || all.size() < before + 2 * kFewestStill) return std::nullopt;
  const LevelOf dark = level_of(std::span(all).first(before));
  const LevelOf lit = level_of(std::span(all).last(kFewestStill + (all.size() - before) / 4));
  const double more = lit.lux - dark.lux;
  if (!(more > kClearLight * (dark.deviation + lit.deviation))) return std::nullopt;
  const double half = dark.lux + more / 2;
  const double within = std::max(kStillShare * more, kStillDeviations * lit.deviation);
  std::size_t last_low = before - 1, last_off = before - 1;
  for (std::size_t k = before; k < all.size(); ++k) {
    if (all[k].lux < half) last_low = k;
    if (std::abs(all[k].lux - lit.lux) > within) last_off = k;
  }
  if (last_off + kFewestStill >= all.size()) return std::nullopt;
  const TimedLux &low = all[last_low], &high = all[last_low + 1];
  LightArrival arrival;
  arrival.half_s =
      time_between(low.at_s, high.at_s, std::clamp((half - low.lux) / (high.lux - low.lux), 0.0, 1.0), back.ordered_s);
  arrival.still_s = time_between(all[last_off].at_s, all[last_off + 1].at_s, 0.5, back.ordered_s);
  return arrival;
}

HeadMotion head_motion(std::span<const LightReturn> pan, std::span<const LightReturn> tilt,
                       std::span<const LightReturn> switched) {
  HeadMotion motion;
  BesideWay moves, lamps;
  motion.pan_speed_deg_s = speed_of(pan, moves);
  motion.tilt_speed_deg_s = speed_of(tilt, moves);
  for (const LightReturn& back : switched)
    if (const auto arrival = light_arrival(back)) {
      lamps.half_s.push_back(arrival->half_s);
      lamps.still_s.push_back(arrival->still_s);
    }
  if (moves.half_s.empty() || lamps.half_s.empty()) return motion;
  const Known half = longer_s(moves.half_s, lamps.half_s), still = longer_s(moves.still_s, lamps.still_s);
  motion.settling_s = half.value > still.value ? half : still;
  return motion;
}

void put_motion(const HeadMotion& motion, CalibratedHead& head) {
  for (const auto& [found, known] : {std::pair{&motion.pan_speed_deg_s, &head.pan_speed_deg_s},
                                     {&motion.tilt_speed_deg_s, &head.tilt_speed_deg_s},
                                     {&motion.settling_s, &head.settling_s}})
    if (found->standard_error > 0) *known = *found;
}

}  // namespace luxrig
