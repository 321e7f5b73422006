#include "core/radiometry/level_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace luxrig {
namespace {

constexpr int kShareLevels = 20, kMaxRounds = 200;
constexpr double kLowestShare = 0.05, kHighestShare = 0.95;  ///< of full samples. Source: EMVA 1288, as in line_fit.cpp
constexpr double kLevelKnownTo = 0.003;                      ///< no sample is taken as known better, relative
constexpr double kPlacesDiffer = 3;                          ///< least ratio of brightest to darkest place at a level
constexpr double kProportionRms = 0.01, kProportionWorst = 0.03;
constexpr double kStraightRms = 0.02, kExponentOff = 0.02;
constexpr double kFlickersMuch = 0.005, kMuchOtherLight = 0.5;

/// The steps without the light at level 0: light of the dimmer alone.
Result<ExposureSeries> without_dark(const LevelSeries& series) {
  if (series.dark.frames.empty()) return refusal("a series of levels needs pictures at level 0");
  std::vector<double> dark(series.dark.frames.front().size(), 0.0);
  for (const std::vector<float>& frame : series.dark.frames) {
    if (frame.size() != dark.size()) return refusal("a series with pictures of different sizes");
    for (std::size_t p = 0; p < dark.size(); ++p) dark[p] += static_cast<double>(frame[p]);
  }
  const auto frames = static_cast<double>(series.dark.frames.size());
  ExposureSeries out;
  out.full_scale_counts = series.full_scale_counts;
  for (const LevelStep& step : series.steps) {
    if (!(step.level > 0 && step.level <= 1)) return refusal(fmt::format("a level of {} in a series", step.level));
    ExposureStep lit{step.level, step.frames};
    for (std::vector<float>& frame : lit.frames) {
      if (frame.size() != dark.size()) return refusal("a series with pictures of different sizes");
      for (std::size_t p = 0; p < dark.size(); ++p) frame[p] -= static_cast<float>(dark[p] / frames);
    }
    out.steps.push_back(std::move(lit));
  }
  return out;
}

struct PlacePoint {
  std::size_t step;
  double value, weight;
};

/// Fits value = place × light of the step, alternately, until both converge.
struct ProductFit {
  std::vector<std::vector<PlacePoint>> places;
  std::vector<double> place, light, light_weight;  ///< weight 0 = nothing was seen at that step

  /// dark_known_to: error of the dark light subtracted. Noise cut off at 0 makes that light slightly too bright.
  ProductFit(const SampleGroups& groups, double dark_known_to) : light(groups.exposures_s) {
    for (const std::vector<GroupSample>& group : groups.groups) {
      std::vector<PlacePoint> points;
      for (std::size_t s = 0; s < group.size(); ++s) {
        if (!group[s].usable || !(group[s].mean > 0)) continue;
        const double floor = kLevelKnownTo * group[s].mean;
        points.push_back(
            {s, group[s].mean, 1 / (group[s].mean_variance + floor * floor + dark_known_to * dark_known_to)});
      }
      if (points.size() >= 2) places.push_back(std::move(points));
    }
    place.assign(places.size(), 0.0);
  }

  /// Steps that share no place with the others have no relation to them.
  [[nodiscard]] bool joined() const {
    std::vector<bool> reached(light.size(), false), there(light.size(), false);
    for (const auto& points : places)
      for (const PlacePoint& p : points) there[p.step] = true;
    if (places.empty()) return false;
    reached[places.front().front().step] = true;
    for (bool grew = true; grew;) {
      grew = false;
      for (const auto& points : places) {
        const bool any = std::any_of(points.begin(), points.end(), [&](const auto& p) { return reached[p.step]; });
        for (const PlacePoint& p : points) {
          grew = grew || (any && !reached[p.step]);
          if (any) reached[p.step] = true;
        }
      }
    }
    return reached == there && std::count(there.begin(), there.end(), true) >= 3;
  }

  void run() {
    for (int round = 0; round < kMaxRounds; ++round) {
      for (std::size_t g = 0; g < places.size(); ++g) {
        double up = 0, down = 0;
        for (const PlacePoint& p : places[g]) {
          up += p.weight * p.value * light[p.step];
          down += p.weight * light[p.step] * light[p.step];
        }
        place[g] = up / down;
      }
      std::vector<double> up(light.size(), 0.0), down(light.size(), 0.0);
      for (std::size_t g = 0; g < places.size(); ++g)
        for (const PlacePoint& p : places[g]) {
          up[p.step] += p.weight * p.value * place[g];
          down[p.step] += p.weight * place[g] * place[g];
        }
      double moved = 0;
      for (std::size_t s = 0; s < light.size(); ++s) {
        if (!(down[s] > 0)) continue;
        moved = std::max(moved, std::abs(up[s] / down[s] - light[s]) / light[s]);
        light[s] = up[s] / down[s];
      }
      light_weight = std::move(down);
      if (moved < 1e-9) break;
    }
  }
};

void judge_camera(const ProductFit& fit, double full, LevelCheck& out) {
  struct Mean {
    double sum = 0, weight = 0;
  };
  std::array<Mean, kShareLevels> shares{};
  std::vector<std::pair<double, double>> span(fit.light.size(), {1e300, 0.0});  // of places, at each step
  for (std::size_t g = 0; g < fit.places.size(); ++g)
    for (const PlacePoint& p : fit.places[g]) {
      const double expected = fit.place[g] * fit.light[p.step], share = p.value / full;
      if (share < kLowestShare || share > kHighestShare) continue;
      span[p.step] = {std::min(span[p.step].first, fit.place[g]), std::max(span[p.step].second, fit.place[g])};
      Mean& mean = shares[static_cast<std::size_t>(share * kShareLevels)];
      const double weight = p.weight * expected * expected;
      mean.sum += weight * (p.value - expected) / expected;
      mean.weight += weight;
    }
  int count = 0;
  for (const Mean& mean : shares) {
    if (!(mean.weight > 0)) continue;
    const double off = mean.sum / mean.weight;
    out.camera_rms += off * off;
    out.camera_worst = std::max(out.camera_worst, std::abs(off));
    ++count;
  }
  out.camera_rms = std::sqrt(out.camera_rms / std::max(1, count));
  const auto wide =
      std::count_if(span.begin(), span.end(), [](const auto& s) { return s.second >= kPlacesDiffer * s.first; });
  out.camera_told = wide >= 2 && count >= 3;
  out.camera_linear = out.camera_told && out.camera_rms <= kProportionRms && out.camera_worst <= kProportionWorst;
}

/// dark_known_to: as in ProductFit. It is the same for all places, so more places do not reduce it.
void judge_light(const ProductFit& fit, const SampleGroups& groups, double dark_known_to, LevelCheck& out) {
  std::vector<double> brightest(fit.light.size(), 0.0);
  for (const auto& points : fit.places)
    for (const PlacePoint& p : points) brightest[p.step] = std::max(brightest[p.step], p.value);
  for (std::size_t s = 0; s < fit.light.size(); ++s) {
    if (!(fit.light_weight[s] > 0)) continue;
    const double alike = fit.light[s] * dark_known_to / brightest[s];
    out.seen.push_back({groups.exposures_s[s], fit.light[s], std::sqrt(1 / fit.light_weight[s] + alike * alike)});
  }
  const double full = out.seen.back().light / out.seen.back().level;
  double weights = 0, slope = 0, x = 0, y = 0;
  std::vector<double> weight;
  for (SeenLevel& seen : out.seen) {
    seen.light /= full;
    seen.standard_error /= full;
    const double relative = seen.standard_error / seen.light;
    weight.push_back(1 / (relative * relative + kLevelKnownTo * kLevelKnownTo));
    weights += weight.back();
    slope += weight.back() * seen.light / seen.level;
    x += weight.back() * std::log(seen.level);
    y += weight.back() * std::log(seen.light);
  }
  slope /= weights;
  x /= weights;
  y /= weights;
  double xx = 0, xy = 0, left = 0;
  for (std::size_t s = 0; s < out.seen.size(); ++s) {
    const SeenLevel& seen = out.seen[s];
    const double off = seen.light / (slope * seen.level) - 1;
    out.line_rms += weight[s] * off * off / weights;
    out.line_worst = std::max(out.line_worst, std::abs(off));
    xx += weight[s] * (std::log(seen.level) - x) * (std::log(seen.level) - x);
    xy += weight[s] * (std::log(seen.level) - x) * (std::log(seen.light) - y);
  }
  out.line_rms = std::sqrt(out.line_rms);
  out.exponent = xy / xx;
  for (std::size_t s = 0; s < out.seen.size(); ++s) {
    const double off = std::log(out.seen[s].light) - y - out.exponent * (std::log(out.seen[s].level) - x);
    left += weight[s] * off * off;
  }
  out.power_rms = std::sqrt(left / weights);
  // The deviation, or the known error of the light if that is larger.
  const auto free = std::max(1.0, static_cast<double>(out.seen.size()) - 2);
  out.exponent_error = std::sqrt(std::max(1.0, left / free) / xx);
}

void add_findings(LevelCheck& out) {
  const auto note = [&](std::string what, std::string mend) {
    out.findings.push_back({std::move(what), std::move(mend)});
  };
  const bool straight = out.line_rms <= kStraightRms && std::abs(out.exponent - 1) <= kExponentOff;
  out.good = out.camera_linear && straight;
  if (!out.camera_told)
    note(
        "places of the picture differ too little in light: a curve of the camera cannot be told from one of the dimmer",
        "point it at a scene with bright and dark places, or check it by exposures");
  if (out.camera_told && !out.camera_linear)
    note(fmt::format("bright and dark places do not grow in proportion: {:.1f} % rms off, whatever the dimmer does",
                     100 * out.camera_rms),
         "switch gamma, contrast and tone curves off in the camera, or give [[camera]] the response that it has");
  if (!straight) {
    const bool power = out.power_rms <= kStraightRms;
    note(power ? fmt::format("light as it is seen grows as the level to the power {:.3f} ± {:.3f}: a curve of the "
                             "dimmer, of the camera, or both, which levels alone cannot tell apart",
                             out.exponent, out.exponent_error)
               : fmt::format("light as it is seen is {:.1f} % rms off the level, and {:.1f} % off any power of it{}",
                             100 * out.line_rms, 100 * out.power_rms,
                             out.camera_linear ? ": the dimmer's curve is not the one that is stated" : ""),
         power ? "check the camera by exposures; when it is linear, the dimmer's curve in the rig file is off by that "
                 "power"
               : "write the dimmer_curve that the fixture has, and hold the light, the scene and the camera still");
  }
  if (out.other_light > kMuchOtherLight)
    note(fmt::format("{:.0f} % of the light is there without the rig", 100 * out.other_light),
         "darken the room: what changes there meanwhile looks like a dimmer's curve");
  if (out.flicker > kFlickersMuch)
    note(fmt::format("the light flickers: pictures of one level differ by {:.1f} %", 100 * out.flicker),
         "expose for a multiple of the mains' half period (10 ms at 50 Hz, 8.33 ms at 60 Hz), or use steady light");
}

double mean_of(const LevelStep& step) {
  double sum = 0, count = 0;
  for (const std::vector<float>& frame : step.frames)
    for (const float sample : frame) sum += static_cast<double>(sample), ++count;
  return count > 0 ? sum / count : 0;
}

}  // namespace

Result<LevelCheck> check_by_levels(const LevelSeries& series) {
  const auto lit = without_dark(series);
  if (!lit) return tl::unexpected(lit.error());
  const auto groups = group_samples(*lit);
  if (!groups) return tl::unexpected(groups.error());
  const double dark_known_to = 1.0 / series.full_scale_counts;
  ProductFit fit(*groups, dark_known_to);
  if (!fit.joined())
    return refusal("no light that three levels see without clipping: another exposure, or other levels are needed");
  fit.run();
  LevelCheck out;
  out.flicker = groups->flicker;
  const double brightest = mean_of(series.steps.back());
  out.other_light = brightest > 0 ? std::clamp(mean_of(series.dark) / brightest, 0.0, 1.0) : 0;
  judge_camera(fit, groups->saturation, out);
  judge_light(fit, *groups, dark_known_to, out);
  add_findings(out);
  return out;
}

}  // namespace luxrig
