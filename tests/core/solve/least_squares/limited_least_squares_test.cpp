#include "core/solve/least_squares/limited_least_squares.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

#include "core/solve/least_squares/limited_methods.h"
#include "core/solve/least_squares/nnls.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// Lux per level, goals and limits, scaled as in solve_emittance() and with its tie term.
LimitedLeastSquares scaled_lights(const MatrixXd& lux_per_level, const VectorXd& goal_lx, const VectorXd& max_lx,
                                  const VectorXd& max_level) {
  constexpr double kTieWeight = 1e-5;
  const Index points = lux_per_level.rows(), lights = lux_per_level.cols();
  const double goal_norm = goal_lx.norm() > 0 ? goal_lx.norm() : 1;
  LimitedLeastSquares p;
  p.E = MatrixXd::Zero(points + lights, lights);
  p.f = VectorXd::Zero(points + lights);
  p.f.head(points) = goal_lx / goal_norm;
  VectorXd unit(lights);
  for (Index j = 0; j < lights; ++j) {
    const double norm = lux_per_level.col(j).norm() > 0 ? lux_per_level.col(j).norm() : 1;
    p.E.col(j).head(points) = lux_per_level.col(j) / norm;
    p.E(points + j, j) = kTieWeight;
    unit[j] = norm / goal_norm;
  }
  p.upper = max_level.cwiseProduct(unit);
  std::vector<Index> limited;
  for (Index i = 0; i < points; ++i)
    if (std::isfinite(max_lx[i]) && lux_per_level.row(i).maxCoeff() > 0) limited.push_back(i);
  p.G = lux_per_level(limited, Eigen::all) * unit.cwiseInverse().asDiagonal();
  p.slack = max_lx(limited);
  for (Index k = 0; k < p.G.rows(); ++k) {
    const double norm = p.G.row(k).norm();
    p.G.row(k) /= norm;
    p.slack[k] /= norm;
  }
  return p;
}

/// Sparse for even seeds. Every third is degenerate: equal lights and points, points that no light reaches, limits of
/// 0, lights with highest level 0. Every fourth has a limit at each goal.
LimitedLeastSquares random_lights(int seed, Index lights, Index points) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> uniform;
  const auto any = [&](Index count) { return static_cast<Index>(random() % static_cast<std::uint32_t>(count)); };
  const double filled = seed % 2 == 0 ? 0.05 : 0.9;
  MatrixXd lux(points, lights);
  for (double& value : lux.reshaped()) value = uniform(random) < filled ? 300 * uniform(random) : 0;
  VectorXd goal_lx(points), max_lx(points), max_level(lights);
  for (Index i = 0; i < points; ++i) {
    goal_lx[i] = 300 * uniform(random);
    max_lx[i] = seed % 4 == 1           ? goal_lx[i]
                : uniform(random) < 0.5 ? kUnbounded
                                        : goal_lx[i] * (0.2 + 2 * uniform(random));
  }
  for (double& value : max_level) value = uniform(random) < 0.5 ? 1 : uniform(random);
  if (seed % 3 == 2) {
    for (Index k = 0; k < lights / 3; ++k) lux.col(any(lights)) = lux.col(any(lights)).eval();
    for (Index k = 0; k < points / 5; ++k) lux.row(any(points)) = lux.row(any(points)).eval();
    for (Index k = 0; k < points / 10; ++k) lux.row(any(points)).setZero();
    for (Index k = 0; k < 2; ++k) max_lx[any(points)] = 0;
    for (Index k = 0; k < lights / 10; ++k) max_level[any(lights)] = 0;
  }
  return scaled_lights(lux, goal_lx, max_lx, max_level);
}

/// Distance from the optimum without the solver's multipliers: they are found here by least squares.
double distance_from_optimum(const LimitedLeastSquares& p, const VectorXd& z) {
  const VectorXd gradient = p.E.transpose() * (p.E * z - p.f), over = p.G * z - p.slack;
  double worst = over.size() > 0 ? std::max(0.0, over.maxCoeff()) : 0;
  std::vector<VectorXd> pulls;  // one per active constraint
  for (Index j = 0; j < z.size(); ++j) {
    worst = std::max({worst, -z[j], z[j] - p.upper[j]});
    if (z[j] == 0) pulls.emplace_back(VectorXd::Unit(z.size(), j));
    if (z[j] == p.upper[j]) pulls.emplace_back(-VectorXd::Unit(z.size(), j));
  }
  for (Index i = 0; i < over.size(); ++i)
    if (over[i] > -1e-11) pulls.emplace_back(-p.G.row(i).transpose());
  MatrixXd columns(z.size(), static_cast<Index>(pulls.size()));
  for (std::size_t k = 0; k < pulls.size(); ++k) columns.col(static_cast<Index>(k)) = pulls[k];
  return std::max(worst, solve_nnls(columns, gradient).residual_norm);
}

double residual_norm_of(const LimitedLeastSquares& p, const VectorXd& z) { return (p.E * z - p.f).norm(); }

TEST(LimitedLeastSquares, ManyConstraintsAtATimeMatchOneAtATime) {
  constexpr int kProblems = 600;
  int taken = 0;
  double worst = 0, worst_kkt = 0, worst_tie = 0;
  for (int seed = 0; seed < kProblems; ++seed) {
    const LimitedLeastSquares p = random_lights(seed, 1 + 7 * seed % 60, 1 + 13 * seed % 60);
    const LimitedLeastSquaresResult reference = solve_by_active_set(p, {});
    ASSERT_TRUE(reference.converged) << seed;
    EXPECT_LT(distance_from_optimum(p, reference.z), 1e-9) << seed;
    const auto at = solve_by_multipliers(p, {});
    if (!at) continue;  // not verified: the solver then uses the reference method
    ++taken;
    ASSERT_TRUE(at->converged) << seed;
    const double kkt = distance_from_optimum(p, at->z);
    EXPECT_LT(kkt, 1e-9) << seed;
    const double difference = std::abs(residual_norm_of(p, at->z) - residual_norm_of(p, reference.z));
    EXPECT_LT(difference, 1e-10) << seed;
    const double tie = (at->z - reference.z).cwiseAbs().maxCoeff();
    EXPECT_LT(tie, 1e-3) << seed;  // the gradient is exact to 1e-14, the tie term is 1e-10
    worst = std::max(worst, difference);
    worst_kkt = std::max(worst_kkt, kkt);
    worst_tie = std::max(worst_tie, tie);
  }
  EXPECT_GT(taken, kProblems * 98 / 100);
  std::printf("%d of %d verified: worst KKT %.1e, error off by %.1e, levels by %.1e\n", taken, kProblems, worst_kkt,
              worst, worst_tie);
}

TEST(LimitedLeastSquares, AStartChangesNothingButTheNumberOfSteps) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform;
  int steps = 0, steps_from_dark = 0;
  for (int seed = 0; seed < 400; ++seed) {
    const LimitedLeastSquares p = random_lights(seed, 1 + 7 * seed % 40, 1 + 13 * seed % 60);
    const LimitedLeastSquaresResult from_dark = solve_limited_least_squares(p, {});
    ASSERT_TRUE(from_dark.converged) << seed;
    // The optimum of goals and limits that differ by up to 3 %.
    LimitedLeastSquares before = p, nearby = p, anywhere = p;
    for (double& goal : before.f) goal *= 0.97 + 0.06 * uniform(random);
    for (double& limit : before.slack) limit *= 0.97 + 0.06 * uniform(random);
    nearby.start = solve_limited_least_squares(before, {}).z;
    // Out of bounds, and beyond limits.
    anywhere.start.resize(p.E.cols());
    for (double& level : anywhere.start) level = 4 * uniform(random) - 1;
    for (const LimitedLeastSquares& started : {nearby, anywhere}) {
      const LimitedLeastSquaresResult at = solve_limited_least_squares(started, {});
      ASSERT_TRUE(at.converged) << seed;
      EXPECT_LT(distance_from_optimum(p, at.z), 1e-9) << seed;
      EXPECT_NEAR(residual_norm_of(p, at.z), residual_norm_of(p, from_dark.z), 1e-10) << seed;
      EXPECT_LT((at.z - from_dark.z).cwiseAbs().maxCoeff(), 1e-3) << seed;  // by the tie term, as above
    }
    steps += solve_limited_least_squares(nearby, {}).iterations;
    steps_from_dark += from_dark.iterations;
  }
  EXPECT_LT(4 * steps, 3 * steps_from_dark);
  std::printf("%d steps from a start near the optimum, %d from dark\n", steps, steps_from_dark);
}

TEST(LimitedLeastSquares, AStartOfAnotherSizeOrWithoutNumbersIsNone) {
  LimitedLeastSquares p = random_lights(1, 12, 20);
  const VectorXd expected = solve_limited_least_squares(p, {}).z;
  p.start = VectorXd::Ones(5);
  EXPECT_EQ(solve_limited_least_squares(p, {}).z, expected);
  p.start = VectorXd::Constant(12, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(solve_limited_least_squares(p, {}).z, expected);
}

TEST(LimitedLeastSquares, TwoHundredLightsAtThreeHundredPointsMatchTheReference) {
  for (int seed = 0; seed < 6; ++seed) {
    const LimitedLeastSquares p = random_lights(seed, 200, 300);
    const LimitedLeastSquaresResult at = solve_limited_least_squares(p, {});
    ASSERT_TRUE(at.converged) << seed;
    EXPECT_LT(distance_from_optimum(p, at.z), 1e-9) << seed;
    EXPECT_NEAR(residual_norm_of(p, at.z), residual_norm_of(p, solve_by_active_set(p, {}).z), 1e-10) << seed;
  }
}

/// A row of works, each lit by the lamps near it. With reflections, every lamp adds a little everywhere.
LimitedLeastSquares lights_along_a_wall(Index lights, Index points, bool reflections, bool limits_everywhere) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform;
  MatrixXd lux = MatrixXd::Zero(points, lights);
  for (Index j = 0; j < lights; ++j)
    for (Index i = 0; i < points; ++i) {
      const double apart =
          static_cast<double>(i) - static_cast<double>(j) * static_cast<double>(points) / static_cast<double>(lights);
      if (std::abs(apart) <= 4) lux(i, j) = 200 * (0.5 + uniform(random)) / (1 + 3 * apart * apart);
      if (reflections) lux(i, j) += 4 / (1 + 0.01 * apart * apart);
    }
  VectorXd goal_lx(points), max_lx = VectorXd::Constant(points, kUnbounded);
  for (Index i = 0; i < points; ++i) {
    goal_lx[i] = i % 5 == 3 ? 50 : i % 13 == 0 ? 1200 : 120 + 180 * uniform(random);
    if (i % 5 == 3 || limits_everywhere) max_lx[i] = goal_lx[i];
  }
  return scaled_lights(lux, goal_lx, max_lx, VectorXd::Ones(lights));
}

TEST(LimitedLeastSquares, AThousandLightsNeedNoFallback) {
  for (const bool limits_everywhere : {false, true}) {
    const LimitedLeastSquares p = lights_along_a_wall(1000, 500, false, limits_everywhere);
    const auto at = solve_by_multipliers(p, {});
    ASSERT_TRUE(at) << "verified, so that the slow way is not gone";
    EXPECT_LT(distance_from_optimum(p, at->z), 1e-9);
    EXPECT_GT(at->working_rows.size(), 90U);
  }
}

TEST(LimitedLeastSquares, ALimitAtEveryGoalMatchesTheReference) {
  for (const bool reflections : {false, true}) {
    const LimitedLeastSquares p = lights_along_a_wall(250, 125, reflections, true);
    const LimitedLeastSquaresResult at = solve_limited_least_squares(p, {});
    ASSERT_TRUE(at.converged);
    EXPECT_LT(distance_from_optimum(p, at.z), 1e-9);
    EXPECT_NEAR(residual_norm_of(p, at.z), residual_norm_of(p, solve_by_active_set(p, {}).z), 1e-10);
  }
}

TEST(LimitedLeastSquares, EqualLightsShareEqually) {
  LimitedLeastSquares one = random_lights(7, 110, 90);
  LimitedLeastSquares two;  // each light twice
  const Index n = one.E.cols(), points = one.E.rows() - n;
  two.E = MatrixXd::Zero(points + 2 * n, 2 * n);
  two.E.topLeftCorner(points, n) = two.E.topRightCorner(points, n) = one.E.topRows(points);
  two.E.bottomRows(2 * n) = 1e-5 * MatrixXd::Identity(2 * n, 2 * n);
  two.f = VectorXd::Zero(points + 2 * n);
  two.f.head(points) = one.f.head(points);
  two.upper = one.upper.replicate(2, 1);
  two.G = MatrixXd(one.G.rows(), 2 * n);
  two.G << one.G, one.G;
  two.slack = one.slack;
  const auto at = solve_by_multipliers(two, {});
  ASSERT_TRUE(at);
  EXPECT_LT((at->z.head(n) - at->z.tail(n)).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(LimitedLeastSquares, ALimitOfZeroKeepsItsLightsDark) {
  LimitedLeastSquares p = lights_along_a_wall(220, 110, false, true);
  p.slack[50] = 0;
  const LimitedLeastSquaresResult at = solve_limited_least_squares(p, {});
  ASSERT_TRUE(at.converged);
  EXPECT_LT(p.G.row(50).dot(at.z), 1e-15);
  EXPECT_LT(distance_from_optimum(p, at.z), 1e-9);
  EXPECT_NEAR(residual_norm_of(p, at.z), residual_norm_of(p, solve_by_active_set(p, {}).z), 1e-10);
}

TEST(LimitedLeastSquares, StopsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  EXPECT_TRUE(solve_limited_least_squares(lights_along_a_wall(400, 200, false, false), source.get_token()).stopped);
}

}  // namespace
}  // namespace luxrig
