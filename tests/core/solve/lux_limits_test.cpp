#include "core/solve/lux_limits.h"

#include <gtest/gtest.h>

#include <random>

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Lights over points on a line, by the inverse square law.
MatrixXd line_of_lights(Index points, Index lights) {
  MatrixXd T(points, lights);
  for (Index i = 0; i < points; ++i)
    for (Index j = 0; j < lights; ++j) {
      const double x = static_cast<double>(i) / static_cast<double>(points) -
                       (static_cast<double>(j) + 0.3) / static_cast<double>(lights);
      T(i, j) = 100 * 0.1 / std::pow(x * x + 0.01, 1.5);
    }
  return T;
}

struct Solved {
  LimitedNnlsSolution solution;
  VectorXd lux;
};
Solved solve(const MatrixXd& T, const VectorXd& goal, const LuxLimits& limits, const VectorXd& fixed) {
  NnlsProblem problem;
  problem.columns = ColumnsView(T);
  problem.goal = goal - fixed;
  auto solution = solve_limited_nnls(problem, limits.limits());
  EXPECT_TRUE(solution.has_value());
  const VectorXd lux = T * solution->least_squares.x + fixed;
  return {*solution, lux};
}

TEST(LuxLimits, HoldAtPointsInRatiosAndInPowerAndCostWhatTheyMust) {
  const MatrixXd T = line_of_lights(200, 40);
  VectorXd goal = VectorXd::Constant(200, 300);
  goal.segment(60, 20).setConstant(20);
  goal.segment(140, 10).setConstant(900);
  const VectorXd fixed = VectorXd::Constant(200, 5);
  LuxLimits none(ColumnsView(T), fixed);
  const Solved free = solve(T, goal, none, fixed);
  const double free_error = free.solution.least_squares.residual_norm;
  const auto check = [&](const LuxLimits& limits, const auto& holds) {
    const Solved bound = solve(T, goal, limits, fixed);
    ASSERT_TRUE(bound.solution.conflict.empty());
    ASSERT_TRUE(bound.solution.least_squares.converged);
    EXPECT_LT(bound.solution.least_squares.kkt.worst(), 1e-10);
    EXPECT_FALSE(holds(free)) << "the limit does not bind: the test shows nothing";
    EXPECT_TRUE(holds(bound));
    EXPECT_GT(bound.solution.least_squares.residual_norm, free_error * (1 + 1e-6));
  };
  const auto middle = [](const Solved& s) { return s.lux.segment(60, 20); };
  LuxLimits dark(ColumnsView(T), fixed);
  for (Index i = 60; i < 80; ++i) dark.at_most(i, 40);
  check(dark, [&](const Solved& s) { return middle(s).maxCoeff() <= 40 * (1 + 1e-10); });

  LuxLimits bright(ColumnsView(T), fixed);
  for (Index i = 0; i < 60; ++i) bright.at_least(i, 295);
  check(bright, [&](const Solved& s) { return s.lux.head(60).minCoeff() >= 295 * (1 - 1e-10); });

  std::vector<Index> left, all;
  for (Index i = 80; i < 200; ++i) left.push_back(i);
  LuxLimits to_mean(ColumnsView(T), fixed);
  to_mean.min_to_mean(left, 0.8);
  check(to_mean, [&](const Solved& s) {
    const VectorXd there = s.lux(left);
    return there.minCoeff() >= 0.8 * there.mean() * (1 - 1e-10);
  });
  LuxLimits to_max(ColumnsView(T), fixed);
  to_max.min_to_max(left, 0.6);
  check(to_max, [&](const Solved& s) {
    const VectorXd there = s.lux(left);
    return there.minCoeff() >= 0.6 * there.maxCoeff() * (1 - 1e-10);
  });
  LuxLimits contrast(ColumnsView(T), fixed);
  contrast.contrast_at_most(144, 70, 3);
  check(contrast, [&](const Solved& s) { return s.lux[144] <= 3 * s.lux[70] * (1 + 1e-10); });

  const VectorXd watts = VectorXd::LinSpaced(40, 10, 20);
  const double used = watts.dot(free.solution.least_squares.x);
  LuxLimits power(ColumnsView(T), fixed);
  power.power_at_most(watts, 0.8 * used);
  check(power, [&](const Solved& s) { return watts.dot(s.solution.least_squares.x) <= 0.8 * used * (1 + 1e-10); });
}

TEST(LuxLimits, NamesThoseThatCannotBeKeptTogether) {
  const MatrixXd T = line_of_lights(50, 10);
  LuxLimits limits((ColumnsView(T)));
  limits.at_most(10, 100);
  limits.at_most(40, 100);
  limits.at_least(11, 500);
  limits.at_least(25, 10);
  const Solved solved = solve(T, VectorXd::Constant(50, 300), limits, VectorXd::Zero(50));
  ASSERT_EQ(solved.solution.conflict, (std::vector<Index>{0, 2}));
  EXPECT_EQ(limits.text(0), "at most 100 lx at point 10");
  EXPECT_EQ(limits.text(2), "at least 500 lx at point 11");
}

}  // namespace
}  // namespace luxrig
