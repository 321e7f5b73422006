#pragma once
/// A luminaire in a scene that may hang anywhere in its air.

#include <functional>
#include <memory>
#include <vector>

#include "core/solve/placement/movable_light.h"
#include "core/transport/candidates/incremental_transport.h"

namespace luxrig {

class SceneLight final : public MovableLight {
 public:
  /// transport     must outlive it, made for these receivers
  /// luminaire     hung with its own rotation, and turned from there the shortest way to a pose's aim if it is aimed;
  ///               its translation is not used. No shape, no sky.
  /// indirect      reflected light, too: by rays, milliseconds a column; its derivatives are left out
  /// aimed         its aim matters
  /// may_hang      where; empty: wherever light gets to a receiver
  SceneLight(const IncrementalTransport& transport, std::vector<Receiver> receivers, Emitter luminaire, bool indirect,
             bool aimed = false, std::function<bool(const Vec3&)> may_hang = {});

  [[nodiscard]] Eigen::Index points() const override { return static_cast<Eigen::Index>(receivers_.size()); }
  [[nodiscard]] Eigen::Index freedoms() const override { return aimed_ ? 5 : 3; }
  bool column(const LightPose& pose, Eigen::VectorXd& lux, Eigen::MatrixXd* slopes) const override;
  /// The luminaire in a pose.
  [[nodiscard]] Emitter hung(const LightPose& pose) const;

 private:
  [[nodiscard]] Eigen::MatrixXd slopes_at(const LightPose& pose, const Eigen::VectorXd& direct_lux) const;

  const IncrementalTransport* transport_;
  std::vector<Receiver> receivers_;
  Emitter luminaire_;
  bool indirect_, aimed_;
  std::function<bool(const Vec3&)> may_hang_;
};

}  // namespace luxrig
