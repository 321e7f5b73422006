#pragma once
/// Internal to core/transport: a luminous shape as seen from a receiver, cut into patches over each of which light is a
/// smooth function on the unit square. All in frame lamp.

#include <vector>

#include "core/photometry/luminous_shape.h"

namespace luxrig {

/// A direction from the receiver to a place of the shape, and the solid angle per area of the unit square there.
struct PatchPlace {
  Vec3 direction;
  double sr;  ///< ≥ 0
};

/// PatchLimits of what is seen along one coordinate of a patch: low + t·(high - low), t in 0…1.
struct PatchLimits {
  double low = 0, high = 0;
  [[nodiscard]] double at(double t) const { return low + t * (high - low); }
  [[nodiscard]] double width() const { return high - low; }
  [[nodiscard]] bool empty() const { return !(high > low); }
};

/// Receiver and what it may see.
struct Viewer {
  Vec3 position_m;
  Vec3 normal;
  /// Half angle of the cone about -Z into which the luminaire shines; π when it shines everywhere.
  double half_cone_rad;
};

class ShapePatch {
 public:
  enum class Kind { strip, disk, ball, wall };
  [[nodiscard]] PatchPlace at(double t, double w) const;

  Kind kind;
  bool far = false;  ///< small as seen: lengths serve as coordinates, and no hyperbolic function is needed

  // strip and disk, in a plane of constant z: coordinates along x_axis and y_axis from the point below the receiver
  Vec3 x_axis = Vec3::UnitX(), y_axis = Vec3::UnitY();
  double height_m = 0;              ///< > 0
  double towards = 1;               ///< ±1: along +z or -z from the receiver
  PatchLimits along;                ///< strip: x [m]; disk, ball, wall: angle t [rad], see the .cpp
  PatchLimits low_edge, high_edge;  ///< strip: y [m] of its two edges, at either end of `along`
  double radius_m = 0;
  double middle_x_m = 0, middle_y_m = 0;  ///< disk
  double reach_m = HUGE_VAL;              ///< disk: |y| of what a beam reaches the receiver from

  // ball: x_axis to its middle, y_axis across in which the horizon is a limit; third axis along both planes
  Vec3 z_axis = Vec3::UnitZ();
  double sin_half = 0;

  // wall: x_axis to the cylinder's axis, y_axis sideways, both level
  double rho_m = 0, tangent_squared_m2 = 0;
  PatchLimits climb_m;
  Vec3 normal = Vec3::UnitZ();
};

/// Empties and fills `patches`; none when nothing of the shape is seen above the receiver's horizon. Not for points.
void cut_into_patches(const LuminousShape& shape, const Viewer& viewer, std::vector<ShapePatch>& patches);

}  // namespace luxrig
