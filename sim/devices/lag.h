#pragma once
/// First-order lag, dy/dt = (x − y) / τ, solved exactly over a step in which x is constant:
///   y ← x + (y − x) · exp(−dt/τ)
/// so the size of the steps does not matter. τ = 0 follows at once.

#include <cmath>

namespace luxrig::sim {

/// What is left of y − x after a step.
[[nodiscard]] inline double share_left(double dt_s, double tau_s) { return tau_s > 0 ? std::exp(-dt_s / tau_s) : 0; }

[[nodiscard]] inline double lagged(double y, double x, double dt_s, double tau_s) {
  return tau_s > 0 ? x + (y - x) * share_left(dt_s, tau_s) : x;
}

}  // namespace luxrig::sim
