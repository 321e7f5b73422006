#include <algorithm>
#include <array>
#include <cmath>

#include "core/radiometry/curve_fit.h"

namespace luxrig {
namespace {

constexpr int kLevels = 20, kLineRounds = 3;
constexpr double kLowest = 0.05, kHighest = 0.95;  ///< of the range from dark to saturation. Source: EMVA 1288
constexpr double kRelativeFloor = 0.003;           ///< samples are never taken as known better than this

struct LinePoint {
  double exposure_s, value, variance, sample;
};

/// Equations of one group for the common dark level d, with its own slope eliminated: a + b d is off only by noise.
struct LineGroup {
  std::vector<LinePoint> points;
  std::vector<double> weight;
};

}  // namespace

Result<LinearityFit> fit_line(const SampleGroups& groups, const SampleCurve* curve) {
  std::vector<LineGroup> used;
  std::vector<std::size_t> step_of;
  for (const std::vector<GroupSample>& group : groups.groups) {
    LineGroup line;
    for (std::size_t s = 0; s < group.size(); ++s) {
      if (!group[s].usable) continue;
      const double slope = curve ? curve->slope(group[s].mean) : 1;
      // Noise is bent by the curve: the mean of light is not the light of the mean sample.
      double value = group[s].mean;
      if (curve) {
        const double spread = std::sqrt(group[s].variance);
        value = spread > 0 ? (curve->light(group[s].mean - spread) + curve->light(group[s].mean + spread)) / 2
                           : curve->light(group[s].mean);
      }
      line.points.push_back({groups.exposures_s[s], value, slope * slope * group[s].mean_variance, group[s].mean});
    }
    if (line.points.size() >= 2) used.push_back(std::move(line));
  }
  if (used.empty())
    return refusal("no light that two exposures see without clipping: shorter or longer ones are needed");
  LinearityFit out;
  const auto slope_of = [](const LineGroup& g, double dark) {
    double up = 0, down = 0;
    for (std::size_t i = 0; i < g.points.size(); ++i) {
      up += g.weight[i] * g.points[i].exposure_s * (g.points[i].value - dark);
      down += g.weight[i] * g.points[i].exposure_s * g.points[i].exposure_s;
    }
    return up / down;
  };
  for (int round = 0; round < kLineRounds; ++round) {
    double top = 0, bottom = 0;
    for (LineGroup& g : used) {
      g.weight.clear();
      for (const LinePoint& p : g.points) {
        const double floor = kRelativeFloor * (p.value - out.dark_share);
        g.weight.push_back(1 / (p.variance + floor * floor + 1e-14));
      }
      // Values and ones, each without its component along the exposures.
      const double value_slope = slope_of(g, 0), one_slope = value_slope - slope_of(g, 1);
      for (std::size_t i = 0; i < g.points.size(); ++i) {
        const double value = g.points[i].value - value_slope * g.points[i].exposure_s;
        const double one = 1 - one_slope * g.points[i].exposure_s;
        top += g.weight[i] * value * one;
        bottom += g.weight[i] * one * one;
      }
    }
    if (!(bottom > 0)) return refusal("exposures that do not differ");
    out.dark_share = top / bottom;
    out.dark_standard_error = std::sqrt(1 / bottom);
  }
  const double dark = out.dark_share;
  const double full = curve ? curve->light(groups.saturation) : groups.saturation;
  struct Mean {
    double sum = 0, weight = 0;
  };
  std::array<Mean, kLevels> levels{};
  std::vector<Mean> steps(groups.exposures_s.size());
  out.used_from = 1;
  for (const LineGroup& g : used) {
    const double slope = slope_of(g, dark);
    if (!(slope > 0)) continue;
    for (const LinePoint& p : g.points) {
      const double share = (p.value - dark) / (full - dark);
      if (share < kLowest || share > kHighest) continue;
      out.used_from = std::min(out.used_from, p.sample);
      out.used_to = std::max(out.used_to, p.sample);
      const double expected = slope * p.exposure_s, off = (p.value - dark - expected) / expected;
      const double weight = expected * expected / (p.variance + kRelativeFloor * kRelativeFloor * expected * expected);
      Mean& level = levels[static_cast<std::size_t>(share * kLevels)];
      level.sum += weight * off;
      level.weight += weight;
      const auto at = std::lower_bound(groups.exposures_s.begin(), groups.exposures_s.end(), p.exposure_s);
      Mean& step = steps[static_cast<std::size_t>(at - groups.exposures_s.begin())];
      step.sum += weight * off;
      step.weight += weight;
    }
  }
  int count = 0;
  for (const Mean& level : levels) {
    if (!(level.weight > 0)) continue;
    const double off = level.sum / level.weight;
    out.rms_residual += off * off;
    out.worst_residual = std::max(out.worst_residual, std::abs(off));
    ++count;
  }
  if (count < 3) return refusal("too little of the camera's range is used: a scene with bright and dark is needed");
  out.rms_residual = std::sqrt(out.rms_residual / count);
  for (const Mean& step : steps)
    if (step.weight > 0) out.step_residual = std::max(out.step_residual, std::abs(step.sum / step.weight));
  return out;
}

}  // namespace luxrig
