#include "core/solve/bounds/goal_bounds.h"

#include <algorithm>

#include "core/check.h"
#include "core/solve/least_squares/nnls.h"

namespace luxrig {
namespace {

/// Columns of all emitters, rows channel after channel; the residual goal without the fixed light; and its share of the
/// goal.
class GoalBoundProblem {
 public:
  GoalBoundProblem(const ColumnsView& columns, const LightingGoal& goal) {
    LUXRIG_CHECK(goal.points() == columns.rows(), "{} points for {} rows", goal.points(), columns.rows());
    problem_.goal = goal.fixed_lux.size() == 0 ? goal.lux : Eigen::VectorXd(goal.lux - goal.fixed_lux);
    problem_.row_weight = goal.row_weight;
    const double whole = goal.weighted(goal.lux).norm();
    share_ = whole > 0 ? goal.weighted().norm() / whole : 0;
    if (goal.channels() == 1 && goal.emitters.cols() == 1 && goal.emitters(0, 0) == 1) {
      problem_.columns = columns;
      return;
    }
    std::vector<std::uint32_t> rows;
    std::vector<double> values;
    for (Eigen::Index j = 0; j < columns.columns(); ++j) {
      columns.entries(j, rows, values);
      for (Eigen::Index e = 0; e < goal.emitters.cols(); ++e) {
        for (Eigen::Index c = 0; c < goal.channels(); ++c)
          for (std::size_t k = 0; k < rows.size(); ++k)
            if (const double of = goal.emitters(c, e) * values[k]; of > 0) {
              row_.push_back(static_cast<std::uint32_t>(c * columns.rows()) + rows[k]);
              value_.push_back(of);
            }
        begin_.push_back(row_.size());
        problem_.light_of_column.push_back(static_cast<std::uint32_t>(j));
      }
    }
    problem_.columns = ColumnsView(goal.lux.size(), begin_, row_, value_);
  }
  GoalBoundProblem(const GoalBoundProblem&) = delete;
  GoalBoundProblem& operator=(const GoalBoundProblem&) = delete;

  [[nodiscard]] const BoundProblem& problem() const { return problem_; }
  /// Converts an error relative to the residual goal to one relative to the goal.
  [[nodiscard]] double of_goal(double error) const { return share_ * error; }

 private:
  std::vector<std::uint64_t> begin_ = {0};
  std::vector<std::uint32_t> row_;
  std::vector<double> value_;
  BoundProblem problem_;
  double share_ = 1;
};

}  // namespace

double goal_error_bound(const ColumnsView& columns, const LightingGoal& goal, const std::stop_token& stop) {
  const GoalBoundProblem of(columns, goal);
  NnlsOptions options;
  options.stop = stop;
  const auto solved = solve_nnls({of.problem().columns, of.problem().goal, of.problem().row_weight, {}}, options);
  LUXRIG_CHECK(solved.has_value(), "{}", solved ? "" : solved.error().detail);
  if (!solved->converged) return 0;
  return of.of_goal(error_bound(of.problem(), solved->x));
}

std::vector<double> goal_error_bounds_by_count(const ColumnsView& columns, const LightingGoal& goal,
                                               const CountBoundOptions& options) {
  const GoalBoundProblem of(columns, goal);
  std::vector<double> bounds = error_bounds_by_count(of.problem(), options);
  for (double& bound : bounds) bound = of.of_goal(bound);
  return bounds;
}

}  // namespace luxrig
