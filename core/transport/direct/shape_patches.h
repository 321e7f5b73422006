#pragma once
/// Internal to core/transport: a luminous shape as seen from a receiver, cut into patches. Over each patch light is a
/// smooth function on the unit square. All in frame lamp.

#include <vector>

#include "core/photometry/shapes/luminous_shape.h"

namespace luxrig {

/// Direction from the receiver to a place of the shape, and its solid angle per unit area of the unit square.
struct PatchPlace {
  Vec3 direction;
  double sr;  ///< ≥ 0
};

/// Limits of the visible part along one coordinate of a patch: low + t·(high - low), t in 0…1.
struct PatchLimits {
  double low = 0, high = 0;
  [[nodiscard]] double at(double t) const { return low + t * (high - low); }
  [[nodiscard]] double width() const { return high - low; }
  [[nodiscard]] bool empty() const { return !(high > low); }
};

/// The receiver, and the limits of what it can see.
struct Viewer {
  Vec3 position_m;
  Vec3 normal;
  /// Half angle of the luminaire's emission cone about -Z; π if it emits in all directions.
  double half_cone_rad;
};

class ShapePatch {
 public:
  enum class Kind { strip, disk, ball, wall };
  [[nodiscard]] PatchPlace at(double t, double w) const;

  Kind kind;
  bool far = false;  ///< seen small: lengths serve as coordinates, and no hyperbolic functions are needed

  // strip and disk, in a plane of constant z: coordinates along x_axis and y_axis from the point below the receiver
  Vec3 x_axis = Vec3::UnitX(), y_axis = Vec3::UnitY();
  double height_m = 0;              ///< > 0
  double towards = 1;               ///< ±1: towards +z or -z from the receiver
  PatchLimits along;                ///< strip: x [m]; disk, ball, wall: angle t [rad], see the .cpp
  PatchLimits low_edge, high_edge;  ///< strip: y [m] of its two edges, at either end of `along`
  double radius_m = 0;
  double middle_x_m = 0, middle_y_m = 0;  ///< disk
  double reach_m = HUGE_VAL;              ///< disk: largest |y| from which a beam reaches the receiver

  // ball: x_axis to its centre, y_axis across it so that the horizon is a limit; third axis along both planes
  Vec3 z_axis = Vec3::UnitZ();
  double sin_half = 0;

  // wall: x_axis to the cylinder's axis, y_axis sideways, both level
  double rho_m = 0, tangent_squared_m2 = 0;
  PatchLimits climb_m;
  Vec3 normal = Vec3::UnitZ();
};

/// Clears and fills `patches`; empty if no part of the shape is above the receiver's horizon. Not for points.
void cut_into_patches(const LuminousShape& shape, const Viewer& viewer, std::vector<ShapePatch>& patches);

}  // namespace luxrig
