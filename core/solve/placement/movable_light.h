#pragma once
/// Light at fixed points from one luminaire that may hang at many places: what places are searched with.

#include <Eigen/Core>

#include "core/geometry.h"

namespace luxrig {

class MovableLight {
 public:
  virtual ~MovableLight() = default;
  [[nodiscard]] virtual Eigen::Index points() const = 0;

  /// lux           per unit emittance at every point, with the light at that place
  /// lux_per_m     points × 3; nullptr: not asked for. How lux changes while what is lit and what is in shadow stays
  /// False where no light may hang or can be worked out; then both are as they were. From any thread, and always the
  /// same for the same place.
  virtual bool column(const Vec3& place_world_m, Eigen::VectorXd& lux, Eigen::MatrixX3d* lux_per_m) const = 0;
};

}  // namespace luxrig
