#include "core/solve/placement/placed_lights.h"

#include "core/check.h"
#include "core/solve/nnls.h"

namespace luxrig {

PlacedLights::PlacedLights(const MovableLight& light, const LightingGoal& goal)
    : light_(&light), goal_(&goal), weighted_goal_(goal.weighted()), goal_norm_(weighted_goal_.norm()) {
  LUXRIG_CHECK(goal.lux.size() == light.points(), "{} goals for {} points", goal.lux.size(), light.points());
  columns_.resize(light.points(), 0);
  solve();
}

bool PlacedLights::add(const Vec3& place_world_m) {
  Eigen::VectorXd lux;
  if (!light_->column(place_world_m, lux, nullptr)) return false;
  places_m_.push_back(place_world_m);
  columns_.conservativeResize(Eigen::NoChange, columns_.cols() + 1);
  columns_.rightCols(1) = goal_->weighted(lux);
  solve();
  return true;
}

void PlacedLights::drop(std::size_t light) {
  LUXRIG_CHECK(light < size(), "light {} of {}", light, size());
  const auto at = static_cast<Eigen::Index>(light);
  places_m_.erase(places_m_.begin() + at);
  const Eigen::Index behind = columns_.cols() - at - 1;
  columns_.middleCols(at, behind) = columns_.rightCols(behind).eval();
  columns_.conservativeResize(Eigen::NoChange, columns_.cols() - 1);
  solve();
}

void PlacedLights::move(const std::vector<Vec3>& places_world_m) {
  LUXRIG_CHECK(places_world_m.size() == size(), "{} places for {} lights", places_world_m.size(), size());
  Eigen::VectorXd lux;
  for (std::size_t k = 0; k < size(); ++k) {
    if (places_world_m[k] == places_m_[k] || !light_->column(places_world_m[k], lux, nullptr)) continue;
    places_m_[k] = places_world_m[k];
    columns_.col(static_cast<Eigen::Index>(k)) = goal_->weighted(lux);
  }
  solve();
}

Eigen::MatrixX3d PlacedLights::derivatives(std::size_t light) const {
  Eigen::VectorXd lux;
  Eigen::MatrixX3d lux_per_m;
  if (!light_->column(places_m_[light], lux, &lux_per_m)) return Eigen::MatrixX3d::Zero(light_->points(), 3);
  if (goal_->row_weight.size() > 0) lux_per_m = goal_->row_weight.asDiagonal() * lux_per_m;
  return lux_per_m;
}

void PlacedLights::solve() {
  if (columns_.cols() == 0) {
    levels_.resize(0);
    residual_ = weighted_goal_;
  } else {
    levels_ = solve_nnls(columns_, weighted_goal_).x;
    residual_ = weighted_goal_ - columns_ * levels_;
  }
  const double norm = residual_.norm();
  error_ = goal_norm_ > 0 ? norm / goal_norm_ : norm;
}

}  // namespace luxrig
