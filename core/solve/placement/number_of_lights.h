#pragma once
/// Which number of lights is worth hanging, from a curve of error over it.

#include <cstddef>
#include <functional>

namespace luxrig {

struct NumberRule {
  double wanted_error = 1e-4;  ///< the fewest lights with this error or less will do
  /// Else the fewest of which the next two do not lower the error by this share each: the thesis's ε_improv.
  double least_improvement = 0.1;
  /// Above this (the thesis's ε_opt) far less of an improvement is asked for: the first lights of many rooms each do
  /// little.
  double coarse_error = 0.3;
};

/// Index into errors that fall from fewer lights to more (0 for none at all).
[[nodiscard]] std::size_t fewest_worth_it(std::size_t count, const std::function<double(std::size_t)>& error,
                                          const NumberRule& rule);

}  // namespace luxrig
