#pragma once
/// The most light that a head can give at a point, wherever it is aimed. For heads that are turned before it is known
/// how they hang.
///
/// The head may hang kHangsOff_m off its stated place, turned in any way. Its light at a point is, at most,
///   I/d² cos        its peak, straight or by a mirror (whose way is no shorter)
/// + ρ I/(d − r)²    surfaces within r of the point, all of them under that peak and all around the point
/// + ρ Φ/(1 − ρ̄)πr²  all surfaces beyond r
/// with the peak intensity I at its narrowest zoom, the flux Φ, the distance d, the largest reflectance ρ of the scene
/// and its mean ρ̄ by area. r is chosen for the least sum.

#include <Eigen/Core>

#include "core/rig/rig.h"
#include "core/scene/scene.h"

namespace luxrig {

/// How far from its place in the rig file a head may hang.
inline constexpr double kHangsOff_m = 0.15;

/// Points × fixtures, lux at full level and rated flux; 0 for lamps that do not turn.
[[nodiscard]] Eigen::MatrixXd any_aim_lux_per_level(const Rig& rig, const Scene& scene);

}  // namespace luxrig
