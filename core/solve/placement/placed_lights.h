#pragma once
/// Lights at places, with the levels that come closest to a goal.

#include <Eigen/Core>
#include <vector>

#include "core/geometry.h"
#include "core/solve/placement/movable_light.h"

namespace luxrig {

/// min ‖W (A(places) x − b)‖₂ with x ≥ 0.
struct LightingGoal {
  Eigen::VectorXd lux;         ///< b, one per point
  Eigen::VectorXd row_weight;  ///< diagonal of W, ≥ 0; empty = 1

  /// W b
  [[nodiscard]] Eigen::VectorXd weighted() const { return weighted(lux); }
  /// W v
  [[nodiscard]] Eigen::VectorXd weighted(const Eigen::VectorXd& v) const {
    return row_weight.size() == 0 ? v : Eigen::VectorXd(row_weight.cwiseProduct(v));
  }
};

class PlacedLights {
 public:
  PlacedLights(const MovableLight& light, const LightingGoal& goal);

  [[nodiscard]] std::size_t size() const { return places_m_.size(); }
  [[nodiscard]] const std::vector<Vec3>& places_world_m() const { return places_m_; }
  [[nodiscard]] const Eigen::VectorXd& levels() const { return levels_; }
  [[nodiscard]] const Eigen::VectorXd& residual() const { return residual_; }  ///< W (b − A x)
  /// ‖W (A x − b)‖ / ‖W b‖; 0 for a goal of zero that no light disturbs.
  [[nodiscard]] double error() const { return error_; }
  [[nodiscard]] const Eigen::MatrixXd& columns() const { return columns_; }  ///< W A

  /// False, and nothing changed, where no light may hang. Levels are the best ones after each.
  bool add(const Vec3& place_world_m);
  void drop(std::size_t light);
  /// Places one for one, those where no light may hang kept as they are; levels follow.
  void move(const std::vector<Vec3>& places_world_m);

  /// Derivatives of column `light` of W A by its place: points × 3.
  [[nodiscard]] Eigen::MatrixX3d derivatives(std::size_t light) const;

 private:
  void solve();

  const MovableLight* light_;
  const LightingGoal* goal_;
  Eigen::VectorXd weighted_goal_;
  double goal_norm_;
  std::vector<Vec3> places_m_;
  Eigen::MatrixXd columns_;
  Eigen::VectorXd levels_, residual_;
  double error_ = 1;
};

}  // namespace luxrig
