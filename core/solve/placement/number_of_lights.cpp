#include "core/solve/placement/number_of_lights.h"

namespace luxrig {
namespace {

/// Share of min_improvement used while the error is coarse.
constexpr double kCoarseShare = 0.05;

}  // namespace

std::size_t fewest_worth_it(std::size_t count, const std::function<double(std::size_t)>& error,
                            const NumberRule& rule) {
  for (std::size_t k = 0; k < count; ++k)
    if (error(k) <= rule.wanted_error) return k;
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const double least = (error(k) > rule.coarse_error ? kCoarseShare : 1) * rule.min_improvement, keep = 1 - least;
    if (error(k + 1) > keep * error(k) && (k + 2 >= count || error(k + 2) > keep * keep * error(k))) return k;
  }
  return count > 0 ? count - 1 : 0;
}

}  // namespace luxrig
