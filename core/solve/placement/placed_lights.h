#pragma once
/// Lights in poses, with the levels nearest to a goal.

#include <Eigen/Core>
#include <vector>

#include "core/solve/placement/lighting_goal.h"
#include "core/solve/placement/movable_light.h"

namespace luxrig {

class PlacedLights {
 public:
  /// Both must outlive it.
  PlacedLights(const MovableLight& light, const LightingGoal& goal);

  [[nodiscard]] std::size_t size() const { return poses_.size(); }
  [[nodiscard]] const std::vector<LightPose>& poses() const { return poses_; }
  [[nodiscard]] Eigen::Index emitters() const { return goal_->emitters.cols(); }
  /// Emitters of the first light, then of the second …
  [[nodiscard]] const Eigen::VectorXd& levels() const { return levels_; }
  [[nodiscard]] bool lit(std::size_t light) const {
    return levels_.segment(static_cast<Eigen::Index>(light) * emitters(), emitters()).maxCoeff() > 0;
  }
  [[nodiscard]] const Eigen::VectorXd& residual() const { return residual_; }  ///< W (b − f − A x)
  /// ‖W (A x + f − b)‖ / ‖W b‖; 0 for a goal of zero that no light disturbs.
  [[nodiscard]] double error() const { return error_; }
  [[nodiscard]] const Eigen::MatrixXd& columns() const { return columns_; }  ///< W A, ordered as levels()
  /// Of all lights together, without the fixed light.
  [[nodiscard]] double watts() const;
  [[nodiscard]] Eigen::VectorXd lux() const;  ///< A x, points × channels, without the fixed light

  /// False, and nothing changed, if no light may hang there. Levels are optimal after each call.
  bool add(const LightPose& pose);
  bool replace(std::size_t light, const LightPose& pose);
  void drop(std::size_t light);
  /// One pose per light; a light keeps its pose if it may not hang at the new one. Levels follow.
  void move(const std::vector<LightPose>& poses);

  [[nodiscard]] Eigen::Index freedoms() const { return light_->freedoms(); }
  /// Change of W A x with the pose of a light at its levels: rows × freedoms().
  [[nodiscard]] Eigen::MatrixXd slopes(std::size_t light) const;

 private:
  void solve();
  void solve_limited();
  [[nodiscard]] bool keeps_limits() const;
  [[nodiscard]] Eigen::VectorXd watts_per_level() const;
  void set_column(std::size_t light, const Eigen::VectorXd& lux);
  [[nodiscard]] auto block(std::size_t light) {
    return columns_.middleCols(static_cast<Eigen::Index>(light) * emitters(), emitters());
  }

  const MovableLight* light_;
  const LightingGoal* goal_;
  Eigen::VectorXd weighted_goal_;
  double goal_norm_;
  std::vector<LightPose> poses_;
  Eigen::MatrixXd columns_, lux_;  ///< lux_: unweighted, one column per light
  Eigen::VectorXd levels_, residual_;
  double error_ = 1;
};

}  // namespace luxrig
