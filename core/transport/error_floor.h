#pragma once
/// The illuminance below which a receiver's error is judged as if it had as much. A relative error of next to nothing
/// costs without end and is of no use to anybody.

#include <algorithm>

#include "core/transport/evaluator.h"

namespace luxrig {

/// lux   of all receivers, as known so far
[[nodiscard]] inline double error_floor_lx(const EvaluateOptions& options, std::span<const double> lux) {
  double brightest = 0, sum = 0;
  for (const double one : lux) {
    brightest = std::max(brightest, one);
    sum += one;
  }
  const double mean = lux.empty() ? 0 : sum / static_cast<double>(lux.size());
  return std::max({0.001 * brightest, options.floor_lx, options.floor_of_mean * mean});
}

}  // namespace luxrig
