#include "core/solve/least_squares/scaled_columns.h"

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

/// For a column this much shorter than the goal, x would leave the range of double.
constexpr double kShortestColumn = 1e-290;

}  // namespace

ScaledColumns::ScaledColumns(const NnlsProblem& problem) : view_(problem.columns) {
  const Index n = view_.columns();
  unweighted_ = problem.row_weight.size() == 0;
  squared_weight_ = unweighted_ ? VectorXd::Ones(rows()) : VectorXd(problem.row_weight.cwiseAbs2());
  norm_.resize(n);
  for (Index j = 0; j < n; ++j) norm_[j] = std::sqrt(view_.squared_norm(j, squared_weight_.data()));
  upper_x_ = problem.upper.size() == 0 ? VectorXd::Constant(n, std::numeric_limits<double>::infinity()) : problem.upper;
  set_goal(problem.goal);
}

void ScaledColumns::set_goal(const VectorXd& goal) {
  scale_ = std::sqrt(goal.cwiseAbs2().dot(squared_weight_));
  goal_ = goal / (scale_ > 0 ? scale_ : 1);
  inverse_norm_.resize(columns());
  upper_.resize(columns());
  for (Index j = 0; j < columns(); ++j) {
    const bool counts = norm_[j] > 0 && (scale_ == 0 || norm_[j] / scale_ > kShortestColumn);
    inverse_norm_[j] = counts ? 1 / norm_[j] : 0;
    upper_[j] = counts && scale_ > 0 ? upper_x_[j] * (norm_[j] / scale_) : 0;
  }
}

Eigen::VectorXd ScaledColumns::residual(const VectorXd& z, const std::vector<Index>& support) const {
  VectorXd rest = goal_;
  for (const Index j : support)
    if (z[j] != 0) view_.add(j, -z[j] * inverse_norm_[j], rest.data());
  return rest;
}

Eigen::VectorXd ScaledColumns::exact_residual(const VectorXd& z, const std::vector<Index>& support) const {
  Eigen::Matrix<long double, Eigen::Dynamic, 1> sum = goal_.cast<long double>();
  for (const Index j : support)
    if (z[j] != 0)
      view_.add(j, -static_cast<long double>(z[j]) * static_cast<long double>(inverse_norm_[j]), sum.data());
  return sum.cast<double>();
}

void ScaledColumns::gradient(const VectorXd& residual, VectorXd& result) const {
  result.resize(columns());
  if (unweighted_)
    view_.dot_all(residual.data(), inverse_norm_.data(), result.data());
  else
    view_.dot_all(weighted(residual).data(), inverse_norm_.data(), result.data());
}

double ScaledColumns::norm(const VectorXd& residual) const {
  return std::sqrt(residual.cwiseAbs2().dot(squared_weight_));
}

KktResiduals ScaledColumns::kkt(const VectorXd& z, const VectorXd& residual, const std::vector<char>& allowed) const {
  KktResiduals kkt;
  if (nothing_wanted()) return kkt;
  VectorXd g;
  gradient(residual, g);
  for (Index j = 0; j < columns(); ++j)
    if (allowed[static_cast<std::size_t>(j)]) kkt.add(z[j], upper_[j], g[j]);
  return kkt;
}

double ScaledColumns::x_of(Index j, double z) const {
  if (z <= 0 || inverse_norm_[j] == 0) return 0;
  if (z >= upper_[j]) return upper_x_[j];
  return std::min(upper_x_[j], z * (scale_ * inverse_norm_[j]));
}

double ScaledColumns::z_of(Index j, double x) const {
  if (!(x > 0) || !(upper_[j] > 0)) return 0;
  return x >= upper_x_[j] ? upper_[j] : x * (norm_[j] / scale_);
}

}  // namespace luxrig
