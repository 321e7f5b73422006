#pragma once
/// Illuminance floor for relative errors: errors of dimmer receivers are relative to the floor. A small relative error
/// of almost no light costs without end and is useless.

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
