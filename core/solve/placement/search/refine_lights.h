#pragma once
/// Refines places while light changes smoothly: Levenberg–Marquardt on all places at once, with the levels projected
/// out.
///
/// Levels are linear, so each step uses the optimal levels for its places, and only places are unknowns. A step fits
/// the part that a change of levels cannot reach (Kaufman 1975, after Golub & Pereyra 1973). The model ignores shadow
/// edges; every step is judged by recomputed light, shadows included.

#include <stop_token>

#include "core/solve/placement/placed_lights.h"

namespace luxrig {

struct RefineOptions {
  int max_steps = 30;
  double longest_step_m = 0.5;    ///< of one light in one step
  double longest_turn_rad = 0.3;  ///< of its aim
  double min_error = 1e-7;        ///< PlacedLights::error(); ends the search
  double min_improvement = 1e-3;  ///< share of the error; two successive steps below it also end it
  std::stop_token stop;
};

/// Never increases the error. Returns the number of computed columns.
std::size_t refine_lights(PlacedLights& lights, const RefineOptions& options = {});

}  // namespace luxrig
