#include "core/solve/bounds/error_bound.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/solve/bounds/block_bound.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

}  // namespace

VectorXd BoundProblem::weights() const { return row_weight.size() > 0 ? row_weight : VectorXd::Ones(goal.size()); }

std::string BoundProblem::complaint() const {
  if (goal.size() != columns.rows()) return fmt::format("{} goals for {} rows", goal.size(), columns.rows());
  if (row_weight.size() != 0 && row_weight.size() != goal.size())
    return fmt::format("{} weights for {} rows", row_weight.size(), goal.size());
  if (!light_of_column.empty() && light_of_column.size() != static_cast<std::size_t>(columns.columns()))
    return fmt::format("{} lights for {} columns", light_of_column.size(), columns.columns());
  if (std::string text = columns.complaint(); !text.empty()) return text;
  std::vector<std::uint32_t> rows;
  std::vector<double> values;
  for (Index j = 0; j < columns.columns(); ++j) {
    columns.entries(j, rows, values);
    for (std::size_t k = 0; k < rows.size(); ++k)
      if (values[k] < 0) return fmt::format("entry ({}, {}) is {}", rows[k], j, values[k]);
  }
  for (Index i = 0; i < goal.size(); ++i) {
    if (!(std::abs(goal[i]) <= ColumnsView::kLargestEntry)) return fmt::format("goal {} is {}", i, goal[i]);
    if (row_weight.size() > 0 && !(row_weight[i] >= 0 && row_weight[i] <= 1e70))
      return fmt::format("weight {} is {}", i, row_weight[i]);
  }
  return {};
}

std::vector<Index> unreachable_rows(const BoundProblem& of) {
  std::vector<char> reached(static_cast<std::size_t>(of.goal.size()), 0);
  std::vector<std::uint32_t> rows;
  std::vector<double> values;
  for (Index j = 0; j < of.columns.columns(); ++j) {
    of.columns.entries(j, rows, values);
    for (const std::uint32_t i : rows) reached[i] = 1;
  }
  std::vector<Index> dark;
  for (Index i = 0; i < of.goal.size(); ++i)
    if (!reached[static_cast<std::size_t>(i)] && (of.row_weight.size() == 0 || of.row_weight[i] > 0)) dark.push_back(i);
  return dark;
}

double error_bound(const BoundProblem& of, const VectorXd& x) {
  LUXRIG_CHECK(of.complaint().empty(), "{}", of.complaint());
  LUXRIG_CHECK(x.size() == of.columns.columns(), "{} levels for {} columns", x.size(), of.columns.columns());
  const VectorXd weight = of.weights();
  const Index rows = of.goal.size();
  const double goal_norm = weight.cwiseProduct(of.goal).norm();
  if (!(goal_norm > 0)) return 0;
  const VectorXd goal = weight.cwiseProduct(of.goal) / goal_norm;

  using Long = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
  Long exact = of.goal.cast<long double>();
  for (Index j = 0; j < x.size(); ++j)
    if (x[j] > 0 && std::isfinite(x[j])) of.columns.add(j, -static_cast<long double>(x[j]), exact.data());
  VectorXd y = (weight.cast<long double>().cwiseProduct(exact) / static_cast<long double>(goal_norm)).cast<double>();
  if (!y.allFinite()) y = goal;

  // Aᵀ W y ≤ 0 makes y a proof. It nearly holds; lowering all of y by a constant makes it hold, because a column of
  // norm 1 sums to at least 1.
  VectorXd reached = VectorXd::Ones(rows);
  for (const Index i : unreachable_rows(of)) reached[i] = 0;
  const VectorXd vector = weight.cwiseProduct(y), sum = weight.cwiseProduct(reached), size = vector.cwiseAbs();
  const VectorXd ones = VectorXd::Ones(x.size());
  VectorXd pull(x.size()), sums(x.size()), sizes(x.size());
  of.columns.dot_all(vector.data(), ones.data(), pull.data());
  of.columns.dot_all(sum.data(), ones.data(), sums.data());
  of.columns.dot_all(size.data(), ones.data(), sizes.data());
  const double rounding = rounding_of_sums(rows);
  double lower = 0;
  for (Index j = 0; j < x.size(); ++j)
    if (sums[j] > 0) lower = std::max(lower, (pull[j] + rounding * sizes[j]) / sums[j]);
  y -= lower * (1 + 4 * rounding) * reached;

  // Any multiple of y is also a proof; the best proves yᵀb / ‖y‖.
  const double norm = y.norm();
  if (!(norm > 0)) return 0;
  const double proven = (y.dot(goal) - rounding * y.cwiseAbs().dot(goal.cwiseAbs())) / norm;
  return std::clamp(proven * (1 - rounding), 0.0, 1.0);
}

}  // namespace luxrig
