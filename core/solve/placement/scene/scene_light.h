#pragma once
/// A luminaire in a scene that may hang anywhere in its air.

#include <functional>
#include <memory>
#include <vector>

#include "core/solve/placement/movable_light.h"
#include "core/transport/candidates/incremental_transport.h"
#include "core/transport/candidates/reflected/reflected_field.h"

namespace luxrig {

struct SceneLightOptions {
  bool aimed = false;     ///< its aim matters: it turns by the shortest rotation from its own to that of a pose
  bool indirect = false;  ///< includes reflected light
  /// Source of reflected light, made for the same luminaire and receivers. Without it, for an aimed light and away from
  /// its nodes, rays are traced: milliseconds a column, and no slopes of reflected light.
  const ReflectedField* reflected = nullptr;
  /// For a luminaire with size: its direct light is then that of its surface, without reflected light. Slopes are those
  /// of a point.
  const RayScene* rays = nullptr;
  std::function<bool(const Vec3&)> may_hang{};  ///< empty = wherever light reaches a receiver
};

class SceneLight final : public MovableLight {
 public:
  /// transport     made for these receivers; must outlive it
  /// luminaire     hung with its own rotation; its translation is not used. No sky. A luminaire with size needs
  ///               options.rays (asserted).
  SceneLight(const IncrementalTransport& transport, std::vector<Receiver> receivers, Emitter luminaire,
             SceneLightOptions options = {});

  [[nodiscard]] Eigen::Index points() const override { return static_cast<Eigen::Index>(receivers_.size()); }
  [[nodiscard]] Eigen::Index freedoms() const override { return options_.aimed ? 5 : 3; }
  bool column(const LightPose& pose, Eigen::VectorXd& lux, Eigen::MatrixXd* slopes) const override;
  /// The luminaire in a pose.
  [[nodiscard]] Emitter hung(const LightPose& pose) const;

 private:
  [[nodiscard]] Result<LuminaireColumn> direct_of(const Emitter& emitter) const;
  [[nodiscard]] Eigen::MatrixXd slopes_at(const LightPose& pose, const Eigen::VectorXd& direct_lux) const;

  const IncrementalTransport* transport_;
  std::vector<Receiver> receivers_;
  Emitter luminaire_;
  SceneLightOptions options_;
};

}  // namespace luxrig
