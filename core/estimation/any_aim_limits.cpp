/// GainEstimator: limits while heads are turned by hand.

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/estimation/gain_estimator.h"
#include "core/output/dimming.h"

namespace luxrig {
namespace {

/// Of a dimmer that was not measured, the light may be this power of its drive, whatever curve its label names.
constexpr double kBrightestPower = 0.8;

/// The highest level at which no more than this share of full light goes out, whatever the dimmer.
double level_sure_of(double share, DimmerCurve label, bool measured) {
  if (measured || share >= 1) return share;
  return std::min(share, level_from_drive(label, std::pow(share, 1 / kBrightestPower)));
}

}  // namespace

WorstCase GainEstimator::worst_of_any(Time now, std::span<const std::uint8_t> turned) const {
  WorstCase worst = worst_of_any(now);
  const auto count = std::count(turned.begin(), turned.end(), std::uint8_t{1});
  if (count == 0) return worst;
  LUXRIG_CHECK(turned.size() == static_cast<std::size_t>(fixtures()), "{} of {} fixtures", turned.size(), fixtures());
  const double parts = static_cast<double>(count) + 1;
  for (Eigen::Index k = 0; k < worst.max_lx.size(); ++k) {
    const auto p = static_cast<Eigen::Index>(worst.points[static_cast<std::size_t>(k)]);
    for (Eigen::Index j = 0; j < fixtures(); ++j) {
      const auto f = static_cast<std::size_t>(j);
      double& lux_per_level = worst.worst_lux_per_level(k, j);
      if (turned[f] == 0) {
        lux_per_level *= parts;
        continue;
      }
      const double most_lx = tells_of_any_aim() ? any_aim_(p, j) * gain_max_ * local_ : HUGE_VAL;
      if (!(most_lx > 0)) {
        lux_per_level = 0;
        continue;
      }
      const double sure = level_sure_of(worst.max_lx[k] / parts / most_lx, dimmers_[f].first, dimmers_[f].second);
      lux_per_level = sure > 0 ? worst.max_lx[k] / sure : HUGE_VAL;
    }
  }
  return worst;
}

}  // namespace luxrig
