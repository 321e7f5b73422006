#pragma once
/// Pan and tilt in step: both axes start and arrive together, and at every instant have done the same share of their
/// ways. So the joints run along a straight line, and the beam's path is known in advance.
///
/// For ways d₁, d₂ and limits of speed v₁, v₂ and of acceleration a₁, a₂, the share s(t) of the way obeys
///   ṡ ≤ V = min(v₁/d₁, v₂/d₂),   s̈ ≤ A = min(a₁/d₁, a₂/d₂)
/// The quickest such move is the trapezoid (trapezoid.h) over a way of 1:
///   T = 1/V + V/A if A ≥ V², else 2/√A, whose peak is min(V, √A).
/// Axis i then runs with speed dᵢ·V and acceleration dᵢ·A. From rest to rest. An axis that does not move sets no limit.
/// If one axis has the lower speed and the other the lower acceleration, either alone would be quicker than both.

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/output/trapezoid.h"

namespace luxrig {

/// For one axis; all > 0, in any unit of angle.
struct AxisLimits {
  double speed = 0, acceleration = 0;
};

struct HeadMove {
  double seconds = 0;
  AxisLimits pan, tilt;  ///< to move with; 0 for an axis that stays
};

[[nodiscard]] inline HeadMove head_move(double pan_way, double tilt_way, const AxisLimits& pan,
                                        const AxisLimits& tilt) {
  pan_way = std::abs(pan_way);
  tilt_way = std::abs(tilt_way);
  if (pan_way == 0 && tilt_way == 0) return {};
  const auto share = [](double limit, double way) {
    return way > 0 ? limit / way : std::numeric_limits<double>::infinity();
  };
  const double speed = std::min(share(pan.speed, pan_way), share(tilt.speed, tilt_way));
  const double acceleration = std::min(share(pan.acceleration, pan_way), share(tilt.acceleration, tilt_way));
  HeadMove move;
  move.seconds = trapezoid_s(1, speed, acceleration);
  move.pan = {pan_way * speed, pan_way * acceleration};
  move.tilt = {tilt_way * speed, tilt_way * acceleration};
  return move;
}

}  // namespace luxrig
