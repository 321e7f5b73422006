#pragma once
/// From a painted goal to points at which solvers ask for lux.

#include <cstdint>
#include <string>

#include "core/goals/painting.h"

namespace luxrig {

/// What is asked of the points of a painting.
struct SurfaceGoal {
  std::string name;
  std::optional<double> max_lx;  ///< hard limit wherever it is painted
  double weight = 1;             ///< > 0, beside other goals
};

/// As `Point` of a rig file.
struct GoalPoint {
  std::string name;  ///< the goal's, with a number: "drawing 1"
  SurfacePlace place;
  double goal_lx = 0;
  std::optional<double> max_lx;
  double weight = 1;   ///< the goal's, times the point's share of its area over that of the average point
  double area_m2 = 0;  ///< painted, for which it stands
};

struct GoalSampling {
  double min_spacing_m = 0.2;  ///< > 0; where the goal has most detail. That of patches is the least there can be
  double max_spacing_m = 1;    ///< ≥ min_spacing_m; where it has none
  double step = 0.2;           ///< > 0; by which share the lux may change from one point to the next
  std::uint64_t seed = 1;
};

/// The spacing of points that the detail of a goal asks for, per patch [m]. It grows by at most half the distance from
/// one patch to another. Infinite where nothing is painted.
[[nodiscard]] std::vector<double> spacing_of(const SurfacePatches& surface, std::span<const float> lux,
                                             const GoalSampling& sampling);

/// Points on painted patches, in a Poisson-disk pattern (Cook 1986) of varying density. Of two points of a group that
/// links within the spacing join, neither is nearer than the spacing there. Every painted patch has a point at a distance
/// of about twice its spacing or less. lux as of Painting::lux(). The seed decides among patches; nothing else is random.
[[nodiscard]] std::vector<GoalPoint> goal_points(const SurfacePatches& surface, std::span<const float> lux,
                                                 const SurfaceGoal& goal, const GoalSampling& sampling);

}  // namespace luxrig
