#pragma once
/// A light that hangs at the mounting's place nearest to the requested one, so that a search that leaves the mounting
/// slides along its edge.

#include "core/solve/placement/movable_light.h"
#include "core/solve/placement/scene/mounting.h"

namespace luxrig {

class MountedLight final : public MovableLight {
 public:
  /// Both must outlive it.
  MountedLight(const MovableLight& light, const Mounting& mounting) : light_(light), mounting_(mounting) {}

  [[nodiscard]] Eigen::Index points() const override { return light_.points(); }
  [[nodiscard]] Eigen::Index freedoms() const override { return light_.freedoms(); }
  bool column(const LightPose& pose, Eigen::VectorXd& lux, Eigen::MatrixXd* slopes) const override {
    const auto at = mounting_.snapped(pose.position_world_m);
    if (!at || !light_.column({at->place_world_m, pose.aim_world}, lux, slopes)) return false;
    if (slopes) slopes->leftCols<3>() = (slopes->leftCols<3>() * at->per_wanted).eval();
    return true;
  }

 private:
  const MovableLight& light_;
  const Mounting& mounting_;
};

}  // namespace luxrig
