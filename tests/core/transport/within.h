#pragma once
#include "core/transport/evaluator.h"

namespace luxrig {

/// Options of an evaluator: the wanted error, and a seed.
inline EvaluateOptions within(double relative_error, std::uint64_t seed = 1) {
  EvaluateOptions options;
  options.wanted_relative_error = relative_error;
  options.seed = seed;
  return options;
}

}  // namespace luxrig
