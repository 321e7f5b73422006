#pragma once
/// Light at fixed points from one luminaire that may hang at many places: the model that placement searches use.

#include <Eigen/Core>

#include "core/solve/placement/light_pose.h"

namespace luxrig {

class MovableLight {
 public:
  virtual ~MovableLight() = default;
  [[nodiscard]] virtual Eigen::Index points() const = 0;
  /// Degrees of freedom of a pose, as moved() takes them: 3 if the aim does not matter, otherwise 5.
  [[nodiscard]] virtual Eigen::Index freedoms() const { return 3; }

  /// lux      per unit emittance at every point, with the light in that pose
  /// slopes   points × freedoms(): change of lux with the pose, with lit and shadowed points unchanged; nullptr = not
  ///          wanted
  /// False if no light may hang there or the light cannot be computed; both are then unchanged. Callable from any
  /// thread; always the same result for the same pose.
  virtual bool column(const LightPose& pose, Eigen::VectorXd& lux, Eigen::MatrixXd* slopes) const = 0;
};

}  // namespace luxrig
