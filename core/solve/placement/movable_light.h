#pragma once
/// Light at fixed points from one luminaire that may hang at many places: what places are searched with.

#include <Eigen/Core>

#include "core/solve/placement/light_pose.h"

namespace luxrig {

class MovableLight {
 public:
  virtual ~MovableLight() = default;
  [[nodiscard]] virtual Eigen::Index points() const = 0;
  /// What a pose may change in, as moved() takes it: 3 where the aim does not matter, else 5.
  [[nodiscard]] virtual Eigen::Index freedoms() const { return 3; }

  /// lux        per unit emittance at every point, with the light in that pose
  /// slopes     points × freedoms(); nullptr: not asked for. How lux changes while what is lit and what is in shadow
  ///            stays
  /// False where no light may hang or can be worked out; then both are as they were. From any thread, and always the
  /// same for the same pose.
  virtual bool column(const LightPose& pose, Eigen::VectorXd& lux, Eigen::MatrixXd* slopes) const = 0;
};

}  // namespace luxrig
