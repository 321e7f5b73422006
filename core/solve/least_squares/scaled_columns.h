#pragma once
/// A least-squares problem in variables z, scaled so that every column and the goal have norm 1, without a copy of the
/// matrix. Internal to the NNLS family.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/solve/least_squares/nnls.h"

namespace luxrig {

class ScaledColumns {
 public:
  using Index = Eigen::Index;
  using VectorXd = Eigen::VectorXd;

  /// The problem must have no complaint().
  explicit ScaledColumns(const NnlsProblem& problem);
  void set_goal(const VectorXd& goal);

  [[nodiscard]] Index rows() const { return view_.rows(); }
  [[nodiscard]] Index columns() const { return view_.columns(); }
  [[nodiscard]] const ColumnsView& view() const { return view_; }
  [[nodiscard]] const VectorXd& squared_weight() const { return squared_weight_; }
  [[nodiscard]] bool unweighted() const { return unweighted_; }
  [[nodiscard]] const VectorXd& goal() const { return goal_; }
  [[nodiscard]] double inverse_norm(Index j) const { return inverse_norm_[j]; }
  /// Bounds of z; 0 for unusable columns: zero columns, and columns too short for their x to be a double.
  [[nodiscard]] double upper(Index j) const { return upper_[j]; }
  /// The goal is zero, or there are no rows.
  [[nodiscard]] bool nothing_wanted() const { return scale_ == 0; }

  /// goal − A z; only columns of `support` have z ≠ 0. exact_residual sums in long double, for refinement.
  [[nodiscard]] VectorXd residual(const VectorXd& z, const std::vector<Index>& support) const;
  [[nodiscard]] VectorXd exact_residual(const VectorXd& z, const std::vector<Index>& support) const;
  /// Aᵀ W² residual: rate at which half the squared error falls with each z.
  void gradient(const VectorXd& residual, VectorXd& result) const;
  [[nodiscard]] double gradient_of(Index j, const VectorXd& weighted_residual) const {
    return inverse_norm_[j] * view_.dot(j, weighted_residual.data());
  }
  [[nodiscard]] VectorXd weighted(const VectorXd& residual) const {
    return unweighted_ ? residual : VectorXd(squared_weight_.cwiseProduct(residual));
  }
  /// ‖W residual‖
  [[nodiscard]] double norm(const VectorXd& residual) const;

  /// Columns that are not allowed have no condition to meet.
  [[nodiscard]] KktResiduals kkt(const VectorXd& z, const VectorXd& residual, const std::vector<char>& allowed) const;
  [[nodiscard]] double x_of(Index j, double z) const;
  [[nodiscard]] double z_of(Index j, double x) const;
  /// A scaled norm in the units of the problem.
  [[nodiscard]] double in_units(double norm) const { return scale_ > 0 ? norm * scale_ : norm; }

 private:
  ColumnsView view_;
  VectorXd squared_weight_, goal_, inverse_norm_, norm_, upper_, upper_x_;
  double scale_ = 0;
  bool unweighted_ = true;
};

}  // namespace luxrig
