#include "core/solve/least_squares/limited_nnls.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "core/solve/least_squares/limited_least_squares.h"
#include "tests/core/solve/least_squares/least_squares_problem.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

struct LimitedCase {
  LeastSquaresCase least_squares;
  MatrixXd C;
  LinearLimits limits;
};

/// Limits from 0 up. Every fourth problem has equal rows, dependent ones, and empty ones.
LimitedCase limited_case(int seed, Index max_rows, Index max_columns, Index max_limits) {
  std::mt19937 random(static_cast<unsigned>(seed) + 77);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  LimitedCase c{least_squares_case(seed, max_rows, max_columns), {}, {}};
  const LeastSquaresCase& ls = c.least_squares;
  const Index n = ls.A.cols(), k = std::uniform_int_distribution<Index>(1, max_limits)(random);
  VectorXd keeps(n);
  for (Index j = 0; j < n; ++j) {
    const double norm = ls.A.col(j).norm();
    keeps[j] = uniform(random) < 0.5 || norm == 0 ? 0 : uniform(random) * ls.goal.norm() / norm;
    if (ls.upper.size() > 0) keeps[j] = std::min(keeps[j], ls.upper[j]);
  }
  c.C.resize(k, n);
  for (Index i = 0; i < k; ++i)
    for (Index j = 0; j < n; ++j)
      c.C(i, j) = (seed % 2 ? std::max(0.0, normal(random)) : uniform(random)) * std::max(ls.A.col(j).norm(), 1e-30);
  if (seed % 4 == 3 && k > 2) {
    c.C.row(0) = c.C.row(1);
    c.C.row(2).setZero();
    c.C.row(k - 1) = c.C.row(0) + c.C.row(1);
  }
  c.limits.most.resize(k);
  for (Index i = 0; i < k; ++i) {
    c.limits.most[i] = c.C.row(i).dot(keeps) + (uniform(random) < 0.3 ? 0 : uniform(random)) * ls.goal.norm();
    if (seed % 3 == 2) c.limits.most[i] -= 2 * uniform(random) * ls.goal.norm();
    c.limits.most[i] = std::max(0.0, c.limits.most[i]);
    if (uniform(random) < 0.1) c.limits.most[i] = kUnlimited;
  }
  c.limits.rows = c.C.sparseView(1, 1e-300);
  return c;
}

/// Relative to what the row's columns can give, each up to the goal's norm or to its bound.
VectorXd violation(const LimitedCase& c, const VectorXd& x) {
  const LeastSquaresCase& ls = c.least_squares;
  VectorXd over = VectorXd::Zero(c.C.rows());
  for (Index i = 0; i < c.C.rows(); ++i) {
    double squares = 0;
    for (Index j = 0; j < x.size(); ++j) {
      const double norm =
          ls.row_weight.size() > 0 ? ls.row_weight.cwiseProduct(ls.A.col(j)).norm() : ls.A.col(j).norm();
      double most = norm > 0 ? weighted_goal(ls) / norm : 0;
      if (norm == 0 && c.C(i, j) != 0) most = weighted_goal(ls) / c.C.col(j).cwiseAbs().maxCoeff();
      if (ls.upper.size() > 0) most = std::min(most, ls.upper[j]);
      squares += std::pow(c.C(i, j) * most, 2);
    }
    const double scale = std::sqrt(squares);
    if (scale > 0 && c.limits.most[i] < kUnlimited) over[i] = (c.C.row(i).dot(x) - c.limits.most[i]) / scale;
  }
  return over;
}

/// A limit of 0 stated as a bound of each of its columns.
LeastSquaresCase closed_where_dark(const LimitedCase& c) {
  LeastSquaresCase closed = c.least_squares;
  if (closed.upper.size() == 0) closed.upper = VectorXd::Constant(closed.A.cols(), kUnlimited);
  for (Index i = 0; i < c.C.rows(); ++i)
    for (Index j = 0; j < c.C.cols(); ++j)
      if (c.limits.most[i] == 0 && c.C(i, j) > 0) closed.upper[j] = 0;
  return closed;
}

TEST(LimitedNnls, OptimalityHoldsOnThousandsOfDegenerateProblems) {
  double worst = 0, worst_over = 0;
  int solved = 0, dark = 0;
  for (int seed = 0; seed < 3000; ++seed) {
    const LimitedCase c = limited_case(seed, 20, 15, 8);
    const auto solution = solve_limited_nnls(c.least_squares.sparse(), c.limits);
    ASSERT_TRUE(solution.has_value()) << seed << ": " << solution.error().detail;
    const VectorXd& x = solution->least_squares.x;
    ASSERT_TRUE(x.allFinite()) << seed;
    ASSERT_TRUE(solution->least_squares.converged) << seed;
    if (weighted_goal(c.least_squares) == 0) continue;
    const double over = violation(c, x).maxCoeff();
    EXPECT_LT(over, 1e-9) << seed;
    const VectorXd pull = c.C.transpose() * solution->multiplier;
    const double kkt = kkt_violation(closed_where_dark(c), x, pull);
    EXPECT_LT(kkt, 1e-9) << seed;
    EXPECT_GE(solution->multiplier.minCoeff(), 0) << seed;
    EXPECT_LT(solution->least_squares.kkt.worst(), 1e-9) << seed;
    worst = std::max(worst, kkt);
    worst_over = std::max(worst_over, over);
    ++solved;
    dark += c.limits.most.minCoeff() == 0 ? 1 : 0;
  }
  EXPECT_GT(solved, 2000);
  EXPECT_GT(dark, 500);
  std::printf("%d solved, %d with a limit of 0: worst KKT violation %.2e, worst violation of a limit %.2e\n", solved,
              dark, worst, worst_over);
}

/// The primal active-set method by QR, which takes full rank and limits that x = 0 keeps.
TEST(LimitedNnls, MatchesThePrimalMethod) {
  int compared = 0;
  double worst = 0;
  for (int seed = 0; seed < 600; ++seed) {
    LimitedCase c = limited_case(12 * seed + (seed % 2 ? 1 : 9), 30, 12, 6);
    LeastSquaresCase& ls = c.least_squares;
    if (ls.A.rows() < ls.A.cols() || ls.A.colwise().norm().minCoeff() < 1e-3) continue;
    LimitedLeastSquares primal;
    const VectorXd norm = ls.A.colwise().norm();
    primal.E = ls.A.colwise().normalized();
    primal.f = ls.goal.normalized();
    primal.upper = VectorXd::Constant(norm.size(), kUnlimited);
    if (ls.upper.size() > 0) primal.upper = ls.upper.cwiseProduct(norm) / ls.goal.norm();
    primal.G = c.C * norm.cwiseInverse().asDiagonal();
    primal.slack = c.limits.most / ls.goal.norm();
    for (Index i = 0; i < primal.G.rows(); ++i) {
      const double length = primal.G.row(i).norm();
      if (length == 0) continue;
      primal.G.row(i) /= length;
      primal.slack[i] /= length;
    }
    const LimitedLeastSquaresResult other = solve_limited_least_squares(primal, {});
    if (!other.converged) continue;
    const auto solution = solve_limited_nnls(ls.dense(), c.limits);
    ASSERT_TRUE(solution.has_value());
    const double difference =
        solution->least_squares.residual_norm / ls.goal.norm() - (primal.E * other.z - primal.f).norm();
    EXPECT_NEAR(difference, 0, 1e-9) << seed;
    worst = std::max(worst, std::abs(difference));
    ++compared;
  }
  EXPECT_GT(compared, 250);
  std::printf("%d compared: largest difference %.2e of the goal\n", compared, worst);
}

TEST(LimitedNnls, HandlesNoLimitsNoGoalAndLimitsWithoutColumns) {
  const LeastSquaresCase c = least_squares_case(1, 20, 10);
  LinearLimits none;
  none.rows.resize(0, c.A.cols());
  none.most.resize(0);
  EXPECT_NEAR(solve_limited_nnls(c.sparse(), none)->least_squares.residual_norm, solve_nnls(c.sparse())->residual_norm,
              1e-12 * c.goal.norm());

  LinearLimits dark;  // Σ x ≤ 0
  dark.rows = MatrixXd::Ones(1, c.A.cols()).sparseView();
  dark.most = VectorXd::Zero(1);
  const auto none_lit = solve_limited_nnls(c.sparse(), dark);
  ASSERT_TRUE(none_lit.has_value());
  EXPECT_LT(none_lit->least_squares.x.sum(), 1e-12 * c.goal.norm());

  LinearLimits empty;  // 0 ≤ 0
  empty.rows.resize(1, c.A.cols());
  empty.most = VectorXd::Zero(1);
  EXPECT_NEAR(solve_limited_nnls(c.sparse(), empty)->least_squares.residual_norm, solve_nnls(c.sparse())->residual_norm,
              1e-12 * c.goal.norm());
}

TEST(LimitedNnls, RefusesNegativeOrNonFiniteLimitsAndMismatchedSizes) {
  const LeastSquaresCase c = least_squares_case(1, 20, 10);
  LinearLimits limits;
  limits.rows.resize(1, c.A.cols());
  limits.most = VectorXd::Ones(1);
  limits.rows.insert(0, 0) = -1e-300;
  EXPECT_FALSE(solve_limited_nnls(c.sparse(), limits).has_value()) << "light is never negative";
  limits.rows.setZero();
  for (const double bad : {-1.0, -1e-300, std::numeric_limits<double>::quiet_NaN(), 1e150}) {
    limits.most = VectorXd::Constant(1, bad);
    EXPECT_FALSE(solve_limited_nnls(c.sparse(), limits).has_value()) << bad;
  }
  limits.most = VectorXd::Zero(2);
  EXPECT_FALSE(solve_limited_nnls(c.sparse(), limits).has_value());
  limits.most = VectorXd::Zero(1);
  limits.rows.resize(1, c.A.cols() + 1);
  EXPECT_FALSE(solve_limited_nnls(c.sparse(), limits).has_value());
}

}  // namespace
}  // namespace luxrig
