#include "core/solve/placement/placed_lights.h"

#include <limits>

#include "core/check.h"
#include "core/solve/least_squares/limited_nnls.h"
#include "core/solve/least_squares/nnls.h"

namespace luxrig {

PlacedLights::PlacedLights(const MovableLight& light, const LightingGoal& goal)
    : light_(&light), goal_(&goal), weighted_goal_(goal.weighted()), goal_norm_(goal.weighted(goal.lux).norm()) {
  LUXRIG_CHECK(goal.lux.size() == light.points() * goal.channels(), "{} goals for {} points", goal.lux.size(),
               light.points());
  columns_.resize(goal.lux.size(), 0);
  lux_.resize(light.points(), 0);
  solve();
}

bool PlacedLights::add(const LightPose& pose) {
  Eigen::VectorXd lux;
  if (!light_->column(pose, lux, nullptr)) return false;
  poses_.push_back(pose);
  columns_.conservativeResize(Eigen::NoChange, columns_.cols() + emitters());
  lux_.conservativeResize(Eigen::NoChange, lux_.cols() + 1);
  set_column(size() - 1, lux);
  solve();
  return true;
}

bool PlacedLights::replace(std::size_t light, const LightPose& pose) {
  LUXRIG_CHECK(light < size(), "light {} of {}", light, size());
  Eigen::VectorXd lux;
  if (!light_->column(pose, lux, nullptr)) return false;
  poses_[light] = pose;
  set_column(light, lux);
  solve();
  return true;
}

void PlacedLights::drop(std::size_t light) {
  LUXRIG_CHECK(light < size(), "light {} of {}", light, size());
  for (std::size_t k = light; k + 1 < size(); ++k) {
    block(k) = block(k + 1).eval();
    lux_.col(static_cast<Eigen::Index>(k)) = lux_.col(static_cast<Eigen::Index>(k + 1)).eval();
  }
  lux_.conservativeResize(Eigen::NoChange, lux_.cols() - 1);
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
    set_column(k, lux);
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

void PlacedLights::set_column(std::size_t light, const Eigen::VectorXd& lux) {
  lux_.col(static_cast<Eigen::Index>(light)) = lux;
  block(light) = goal_->weighted_columns(lux);
}

Eigen::VectorXd PlacedLights::watts_per_level() const {
  if (goal_->watts.size() == 0) return Eigen::VectorXd::Zero(levels_.size());
  return goal_->watts.replicate(static_cast<Eigen::Index>(size()), 1);
}

double PlacedLights::watts() const { return watts_per_level().dot(levels_); }

Eigen::VectorXd PlacedLights::lux() const {
  const Eigen::MatrixXd by_light = levels_.reshaped(emitters(), lux_.cols()).transpose();
  return Eigen::MatrixXd(lux_ * by_light * goal_->emitters.transpose()).reshaped();
}

bool PlacedLights::keeps_limits() const {
  if (watts() > goal_->max_watts) return false;
  if (goal_->max_lux.size() == 0) return true;
  Eigen::VectorXd all = lux();
  if (goal_->fixed_lux.size() > 0) all += goal_->fixed_lux;
  return (goal_->luminous(all).array() <= goal_->max_lux.array()).all();
}

void PlacedLights::solve_limited() {
  std::vector<Eigen::Index> limited;
  for (Eigen::Index p = 0; p < goal_->max_lux.size(); ++p)
    if (goal_->max_lux[p] < std::numeric_limits<double>::infinity()) limited.push_back(p);
  const bool of_power = goal_->max_watts < std::numeric_limits<double>::infinity();
  const auto points = static_cast<Eigen::Index>(limited.size());
  Eigen::MatrixXd rows(points + (of_power ? 1 : 0), columns_.cols());
  for (Eigen::Index k = 0; k < lux_.cols(); ++k)
    for (Eigen::Index e = 0; e < emitters(); ++e)
      rows.col(k * emitters() + e).head(points) = goal_->luminous_emitter(e) * lux_.col(k)(limited);
  LinearLimits limits;
  limits.most.resize(rows.rows());
  limits.most.head(points) = goal_->max_lux(limited);
  if (goal_->fixed_lux.size() > 0) limits.most.head(points) -= goal_->luminous(goal_->fixed_lux)(limited);
  if (of_power) {
    rows.row(points) = watts_per_level().transpose();
    limits.most[points] = goal_->max_watts;
  }
  // The fixed light may break a limit by itself: then nothing is added.
  levels_.setZero(columns_.cols());
  if (limits.most.size() > 0 && limits.most.minCoeff() < 0) return;
  limits.rows = rows.sparseView(1, 0);
  const NnlsProblem problem{
      ColumnsView(columns_), weighted_goal_, {}, Eigen::VectorXd::Constant(columns_.cols(), goal_->max_level)};
  const auto solved = solve_limited_nnls(problem, limits);
  if (!solved) return;
  levels_ = solved->least_squares.x;
  // Limits hold to the solver's rounding; slightly less light makes them hold exactly.
  for (double less = 1e-12; less < 1e-3 && !keeps_limits(); less *= 10) levels_ *= 1 - less;
  if (!keeps_limits()) levels_.setZero();
}

void PlacedLights::solve() {
  if (columns_.cols() == 0) {
    levels_.resize(0);
    residual_ = weighted_goal_;
  } else {
    if (goal_->max_level == std::numeric_limits<double>::infinity())
      levels_ = solve_nnls(columns_, weighted_goal_).x;
    else
      levels_ = solve_nnls(NnlsProblem{ColumnsView(columns_),
                                       weighted_goal_,
                                       {},
                                       Eigen::VectorXd::Constant(columns_.cols(), goal_->max_level)})
                    ->x;
    // The optimum without limits is also the optimum within them if it keeps them.
    if (goal_->limited() && !keeps_limits()) solve_limited();
    residual_ = weighted_goal_ - columns_ * levels_;
  }
  const double norm = residual_.norm();
  error_ = goal_norm_ > 0 ? norm / goal_norm_ : norm;
}

}  // namespace luxrig
