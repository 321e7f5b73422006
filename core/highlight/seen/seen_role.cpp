#include "core/highlight/seen/seen_role.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace luxrig {
namespace {

/// A light that is this many halvings below what is wanted is as bad as none.
constexpr double kMostHalvings = 8;
constexpr double kMostSpill = 4;

}  // namespace

double mean_lx_of(std::span<const float> weights, std::span<const float> lux) {
  double sum = 0;
  for (std::size_t i = 0; i < std::min(weights.size(), lux.size()); ++i) sum += weights[i] * lux[i];
  return sum;
}

RoleScore score_role(const SeenRole& role, std::span<const float> lux, std::span<const float> fixed_lux,
                     double darkest_lx, double seen_objective) {
  LUXRIG_CHECK(role.wanted.size() == lux.size(), "{} weights of {} samples", role.wanted.size(), lux.size());
  RoleScore score;
  score.wanted_lx = mean_lx_of(role.wanted, lux) - mean_lx_of(role.wanted, fixed_lux);
  score.spared_lx = mean_lx_of(role.spared, lux) - mean_lx_of(role.spared, fixed_lux);
  // Rounding of sums of floats.
  if (score.wanted_lx < 1e-6 * mean_lx_of(role.wanted, lux)) score.wanted_lx = 0;
  score.objective = seen_objective;
  if (role.evenly) {
    const double mean_lx = std::max(score.wanted_lx, darkest_lx);
    for (std::size_t i = 0; i < lux.size() && score.wanted_lx > 0; ++i) {
      if (!(role.wanted[i] > 0)) continue;
      const double own_lx = std::max(0.0, double(lux[i]) - (fixed_lux.empty() ? 0.0 : double(fixed_lux[i])));
      score.even += role.wanted[i] * 2 * own_lx / (own_lx + mean_lx);
    }
    score.objective = kEvenWeight * score.even;
  }
  if (role.wanted_lx > 0) {
    const double halvings =
        score.wanted_lx > 0 ? std::max(0.0, std::log2(role.wanted_lx / score.wanted_lx)) : kMostHalvings;
    score.objective -= kShortOfRatio * std::min(kMostHalvings, halvings);
  }
  if (!role.spared.empty()) {
    const double spill = score.wanted_lx > 0 ? score.spared_lx / score.wanted_lx : kMostSpill;
    score.objective -= kSpilt * std::clamp(spill - role.max_spill, 0.0, kMostSpill);
  }
  return score;
}

}  // namespace luxrig
