#pragma once
/// What a light is for, as a photographer says: which of the seen places it shall light, which it shall leave, and how
/// bright beside the light that is there. Its own light is all light less the light that stays.

#include <span>
#include <vector>

namespace luxrig {

struct SeenRole {
  /// Of each sample of a SeenContrast; both sum to 1, or are empty.
  std::vector<float> wanted, spared;
  double wanted_lx = 0;  ///< mean over `wanted` by its own light; 0 = as bright as limits allow
  double max_spill = 0;  ///< mean over `spared` over that over `wanted`
  bool evenly = false;   ///< lights `wanted` evenly: that is what counts, not SeenScore::objective

  [[nodiscard]] bool asks() const { return !wanted.empty(); }
};

/// Weighted mean; 0 without weights.
[[nodiscard]] double mean_lx_of(std::span<const float> weights, std::span<const float> lux);

/// How a light does its part.
struct RoleScore {
  double wanted_lx = 0, spared_lx = 0;  ///< means by its own light
  /// 2 e / (e + mean), mean over `wanted`: 1 = even, 0 = dark. Below darkest_lx it counts as darker.
  double even = 0;
  double objective = 0;  ///< to be made large; takes the place of SeenScore::objective
};

/// lux, fixed_lux     at each sample: of all light, and of the light that stays (empty = darkness)
/// seen_objective     of all light
/// A mean below wanted_lx costs kShortOfRatio for each halving; spill beyond max_spill costs kSpilt times the excess.
inline constexpr double kShortOfRatio = 1, kSpilt = 2, kEvenWeight = 3;
[[nodiscard]] RoleScore score_role(const SeenRole& role, std::span<const float> lux, std::span<const float> fixed_lux,
                                   double darkest_lx, double seen_objective);

}  // namespace luxrig
