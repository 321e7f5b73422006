#pragma once
/// Chooses the number of lights worth hanging from a curve of error over number.

#include <cstddef>
#include <functional>

namespace luxrig {

struct NumberRule {
  double wanted_error = 1e-4;  ///< the fewest lights with at most this error are chosen
  /// Otherwise the fewest where one more light lowers the error by less than this share, and two more by less than this
  /// share each: the thesis's ε_improv.
  double min_improvement = 0.1;
  /// Above this (the thesis's ε_opt) a much smaller improvement is enough: in many rooms, the first lights each do
  /// little.
  double coarse_error = 0.3;
};

/// Index into errors that fall with the number of lights (index 0 = no lights).
[[nodiscard]] std::size_t fewest_worth_it(std::size_t count, const std::function<double(std::size_t)>& error,
                                          const NumberRule& rule);

}  // namespace luxrig
