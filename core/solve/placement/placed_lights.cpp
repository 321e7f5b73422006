#include "core/solve/placement/placed_lights.h"

#include "core/check.h"
#include "core/solve/nnls.h"

namespace luxrig {

PlacedLights::PlacedLights(const MovableLight& light, const LightingGoal& goal)
    : light_(&light), goal_(&goal), weighted_goal_(goal.weighted()), goal_norm_(goal.weighted(goal.lux).norm()) {
  LUXRIG_CHECK(goal.lux.size() == light.points() * goal.channels(), "{} goals for {} points", goal.lux.size(),
               light.points());
  columns_.resize(goal.lux.size(), 0);
  solve();
}

bool PlacedLights::add(const LightPose& pose) {
  Eigen::VectorXd lux;
  if (!light_->column(pose, lux, nullptr)) return false;
  poses_.push_back(pose);
  columns_.conservativeResize(Eigen::NoChange, columns_.cols() + emitters());
  block(size() - 1) = goal_->weighted_columns(lux);
  solve();
  return true;
}

bool PlacedLights::replace(std::size_t light, const LightPose& pose) {
  LUXRIG_CHECK(light < size(), "light {} of {}", light, size());
  Eigen::VectorXd lux;
  if (!light_->column(pose, lux, nullptr)) return false;
  poses_[light] = pose;
  block(light) = goal_->weighted_columns(lux);
  solve();
  return true;
}

void PlacedLights::drop(std::size_t light) {
  LUXRIG_CHECK(light < size(), "light {} of {}", light, size());
  for (std::size_t k = light; k + 1 < size(); ++k) block(k) = block(k + 1).eval();
  poses_.erase(poses_.begin() + static_cast<std::ptrdiff_t>(light));
  columns_.conservativeResize(Eigen::NoChange, columns_.cols() - emitters());
  solve();
}

void PlacedLights::move(const std::vector<LightPose>& poses) {
  LUXRIG_CHECK(poses.size() == size(), "{} poses for {} lights", poses.size(), size());
  Eigen::VectorXd lux;
  for (std::size_t k = 0; k < size(); ++k) {
    if (poses[k] == poses_[k] || !light_->column(poses[k], lux, nullptr)) continue;
    poses_[k] = poses[k];
    block(k) = goal_->weighted_columns(lux);
  }
  solve();
}

Eigen::MatrixXd PlacedLights::slopes(std::size_t light) const {
  Eigen::MatrixXd of_rows = Eigen::MatrixXd::Zero(goal_->lux.size(), freedoms());
  Eigen::VectorXd lux;
  Eigen::MatrixXd of_points;
  if (!light_->column(poses_[light], lux, &of_points)) return of_rows;
  const Eigen::VectorXd colour =
      goal_->emitters * levels_.segment(static_cast<Eigen::Index>(light) * emitters(), emitters());
  for (Eigen::Index c = 0; c < goal_->channels(); ++c)
    of_rows.middleRows(c * of_points.rows(), of_points.rows()) = colour[c] * of_points;
  if (goal_->row_weight.size() > 0) of_rows = goal_->row_weight.asDiagonal() * of_rows;
  return of_rows;
}

void PlacedLights::solve() {
  if (columns_.cols() == 0) {
    levels_.resize(0);
    residual_ = weighted_goal_;
  } else if (goal_->max_level == std::numeric_limits<double>::infinity()) {
    levels_ = solve_nnls(columns_, weighted_goal_).x;
  } else {
    NnlsProblem problem{
        ColumnsView(columns_), weighted_goal_, {}, Eigen::VectorXd::Constant(columns_.cols(), goal_->max_level)};
    levels_ = solve_nnls(problem)->x;
  }
  if (columns_.cols() > 0) residual_ = weighted_goal_ - columns_ * levels_;
  const double norm = residual_.norm();
  error_ = goal_norm_ > 0 ? norm / goal_norm_ : norm;
}

}  // namespace luxrig
