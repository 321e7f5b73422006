#pragma once
/// Places improved where the light falls off smoothly: Levenberg–Marquardt on all places at once, with the levels
/// projected out.
///
/// Levels are linear, so at every step they are those of least error for the places, and only places are unknowns: the
/// step is taken in what the columns cannot do by changing levels (Kaufman 1975, after Golub & Pereyra 1973). The model
/// knows nothing of shadow edges; every step is judged by light that was worked out anew, shadows included.

#include <stop_token>

#include "core/solve/placement/placed_lights.h"

namespace luxrig {

struct RefineOptions {
  int most_steps = 30;
  double longest_step_m = 0.5;      ///< of one light in one step
  double longest_turn_rad = 0.3;    ///< of its aim
  double least_error = 1e-7;        ///< PlacedLights::error() at which it ends
  double least_improvement = 1e-3;  ///< share of the error; two steps in turn below it end it, too
  std::stop_token stop;
};

/// Never makes the error larger. Returns how many columns were worked out.
std::size_t refine_lights(PlacedLights& lights, const RefineOptions& options = {});

}  // namespace luxrig
