#pragma once
/// Random least-squares problems of every degenerate kind, with their optimality conditions in long double.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "core/solve/least_squares/nnls.h"

namespace luxrig {

/// Dense and sparse form of the same matrix.
struct LeastSquaresCase {
  Eigen::MatrixXd A;
  Eigen::VectorXd goal, row_weight, upper;
  std::vector<std::uint64_t> begin;
  std::vector<std::uint32_t> row;
  std::vector<float> value;

  [[nodiscard]] NnlsProblem dense() const { return {ColumnsView(A), goal, row_weight, upper}; }
  [[nodiscard]] NnlsProblem sparse() const {
    return {ColumnsView(A.rows(), begin, row, std::span<const float>(value)), goal, row_weight, upper};
  }
};

/// Twelve kinds: plain; non-negative; sparse; equal, zero or nearly equal columns; low rank; units from 1e-12 to 1e12;
/// exactly reachable goal; upper bounds; weights; several of these together.
inline LeastSquaresCase least_squares_case(int seed, Eigen::Index max_rows, Eigen::Index max_columns) {
  using Eigen::Index;
  std::mt19937 random(static_cast<unsigned>(seed));
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Index m = std::uniform_int_distribution<Index>(1, max_rows)(random);
  const Index n = std::uniform_int_distribution<Index>(1, max_columns)(random);
  std::uniform_int_distribution<Index> pick(0, n - 1);
  LeastSquaresCase c;
  c.A.resize(m, n);
  c.goal.resize(m);
  for (double& v : c.A.reshaped()) v = normal(random);
  for (double& v : c.goal) v = normal(random);
  const int kind = seed % 12;
  if (kind != 0) c.A = c.A.cwiseAbs();
  if (kind == 2 || kind == 11)
    for (double& v : c.A.reshaped()) v = uniform(random) < 0.2 ? v : 0;
  if (kind == 3 || kind == 11)
    for (int k = 0; k < 3; ++k) c.A.col(pick(random)) = c.A.col(pick(random)) * 3.0;
  if (kind == 4) c.A.col(pick(random)).setZero();
  if (kind == 5 || kind == 11) {
    const double nearness = std::pow(10.0, -15 * std::abs(uniform(random)));
    for (Index j = 1; j < n; ++j)
      if (kind == 5 || j % 2) c.A.col(j) = c.A.col(0) + nearness * c.A.col(j);
  }
  if (kind == 6) {
    const Index rank = std::min<Index>({2, m, n});
    const Eigen::MatrixXd left = c.A.leftCols(rank), right = c.A.topRows(rank);
    c.A = left * right;
  }
  if (kind == 7 || kind == 11) {
    for (Index j = 0; j < n; ++j) c.A.col(j) *= std::pow(10.0, 12 * uniform(random));
    c.goal *= std::pow(10.0, 12 * uniform(random));
  }
  if (kind == 9 || kind == 11) {
    c.upper.resize(n);
    const double unit = c.goal.norm();
    for (Index j = 0; j < n; ++j)
      c.upper[j] = std::max(0.0, uniform(random)) * unit / std::max(c.A.col(j).norm(), 1e-300);
    c.upper[pick(random)] = std::numeric_limits<double>::infinity();
  }
  if (kind == 10 || kind == 11) {
    c.row_weight.resize(m);
    for (double& v : c.row_weight) v = std::max(0.0, 3 * uniform(random));
  }
  // Rounded to float like the sparse matrix. Values far below 1e-38 become zero.
  c.A = c.A.cast<float>().cast<double>();
  if (kind == 8) {
    Eigen::VectorXd x(n);
    for (double& v : x) v = std::max(0.0, uniform(random));
    c.goal = c.A * x;
  }
  c.begin.push_back(0);
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < m; ++i) {
      if (c.A(i, j) == 0) continue;
      c.row.push_back(static_cast<std::uint32_t>(i));
      c.value.push_back(static_cast<float>(c.A(i, j)));
    }
    c.begin.push_back(c.row.size());
  }
  return c;
}

/// Worst violation of the optimality conditions, relative to the column's norm times the goal's; infinite outside the
/// bounds. Computed from scratch in long double. pull_j, the effect of limits, is subtracted from the gradient.
inline double kkt_violation(const LeastSquaresCase& c, const Eigen::VectorXd& x,
                            const Eigen::VectorXd& pull = Eigen::VectorXd()) {
  using Long = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  Long A = c.A.cast<long double>();
  Long b = c.goal.cast<long double>();
  if (c.row_weight.size() > 0) {
    A = c.row_weight.cast<long double>().asDiagonal() * A;
    b = c.row_weight.cast<long double>().asDiagonal() * b;
  }
  const Long gradient = A.transpose() * (b - A * x.cast<long double>());
  const long double goal = b.norm();
  double worst = 0;
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    const long double norm = A.col(j).norm();
    const double upper = c.upper.size() > 0 ? c.upper[j] : std::numeric_limits<double>::infinity();
    if (x[j] < 0 || x[j] > upper || !std::isfinite(x[j])) return std::numeric_limits<double>::infinity();
    if (norm == 0 || goal == 0 || upper == 0) continue;
    const long double minus = pull.size() > 0 ? static_cast<long double>(pull[j]) : 0;
    const auto g = static_cast<double>((gradient(j, 0) - minus) / (norm * goal));
    worst = std::max(worst, x[j] == 0 ? g : x[j] == upper ? -g : std::abs(g));
  }
  return worst;
}

inline double weighted_norm(const LeastSquaresCase& c, const Eigen::VectorXd& x) {
  const Eigen::VectorXd residual = c.A * x - c.goal;
  return c.row_weight.size() > 0 ? c.row_weight.cwiseProduct(residual).norm() : residual.norm();
}
inline double weighted_goal(const LeastSquaresCase& c) { return weighted_norm(c, Eigen::VectorXd::Zero(c.A.cols())); }

}  // namespace luxrig
