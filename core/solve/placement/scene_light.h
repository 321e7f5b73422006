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
  /// luminaire     hung with its own rotation; its translation is not used. No shape, no sky.
  /// indirect      reflected light, too: by rays, milliseconds a column; its derivatives are left out
  /// may_hang      where; empty: wherever light gets to a receiver
  SceneLight(const IncrementalTransport& transport, std::vector<Receiver> receivers, Emitter luminaire, bool indirect,
             std::function<bool(const Vec3&)> may_hang = {});

  [[nodiscard]] Eigen::Index points() const override { return static_cast<Eigen::Index>(receivers_.size()); }
  bool column(const Vec3& place_world_m, Eigen::VectorXd& lux, Eigen::MatrixX3d* lux_per_m) const override;

 private:
  [[nodiscard]] Eigen::RowVector3d derivative(const Receiver& receiver, const Emitter& hung, double lux) const;

  const IncrementalTransport* transport_;
  std::vector<Receiver> receivers_;
  Emitter luminaire_;
  bool indirect_;
  std::function<bool(const Vec3&)> may_hang_;
};

}  // namespace luxrig
