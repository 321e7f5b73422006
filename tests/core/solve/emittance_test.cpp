#include "core/solve/emittance.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <vector>

#include "core/solve/least_squares/nnls.h"
#include "tests/core/solve/emittance_goals.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kInf = std::numeric_limits<double>::infinity();
const double kNone = std::numeric_limits<double>::quiet_NaN();

/// Random points and lights with goals, fixed light, weights, limits and highest levels. Every fourth is degenerate
/// (equal or zero columns and rows, lights with highest level 0, no room below a limit), every fifth in extreme units.
EmittanceProblem random_problem(int seed, Index max_points, Index max_lights) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> uniform;
  const auto pick = [&](Index n) { return std::uniform_int_distribution<Index>(0, n - 1)(random); };
  const Index points = 1 + pick(max_points), lights = 1 + pick(max_lights);
  EmittanceProblem p;
  p.lux_per_level.resize(points, lights);
  for (double& value : p.lux_per_level.reshaped()) value = std::max(0.0, 300 * uniform(random) - 100);
  p.fixed_lx.resize(points);
  p.goal_lx.resize(points);
  p.weight.resize(points);
  p.max_lx.resize(points);
  p.max_level.resize(lights);
  for (Index i = 0; i < points; ++i) {
    p.fixed_lx[i] = 10 * uniform(random);
    p.goal_lx[i] = uniform(random) < 0.2 ? kNone : 300 * uniform(random);
    p.weight[i] = uniform(random) < 0.5 ? 1 : 2 * uniform(random);
    p.max_lx[i] = uniform(random) < 0.5 ? kInf : p.fixed_lx[i] + 200 * uniform(random);
  }
  for (double& value : p.max_level) value = uniform(random) < 0.5 ? 1 : uniform(random);
  if (seed % 4 == 3) {
    p.lux_per_level.col(pick(lights)) = p.lux_per_level.col(pick(lights)).eval();
    p.lux_per_level.row(pick(points)).setZero();
    p.max_level[pick(lights)] = 0;
    p.lux_per_level.col(pick(lights)).setZero();
    const Index full = pick(points);
    p.max_lx[full] = p.fixed_lx[full];
  }
  if (seed % 5 == 4) {
    const double unit = std::pow(10.0, 24 * uniform(random) - 12);
    p.lux_per_level *= unit;
    p.fixed_lx *= unit;
    p.goal_lx *= unit;
    p.max_lx *= unit;
    for (Index j = 0; j < lights; ++j) p.lux_per_level.col(j) *= std::pow(10.0, 6 * uniform(random) - 3);
  }
  return p;
}

double goals_squared(const EmittanceProblem& p) {
  double sum = 0;
  for (Index i = 0; i < p.goal_lx.size(); ++i)
    if (!std::isnan(p.goal_lx[i])) sum += std::pow(p.weight[i] * missing_lx(p, i), 2);
  return sum;
}

/// Within limits in any order of summation.
void expect_within_limits(const EmittanceProblem& p, const VectorXd& level, int seed) {
  for (Index j = 0; j < level.size(); ++j) {
    ASSERT_GE(level[j], 0) << "seed " << seed;
    ASSERT_LE(level[j], p.max_level[j]) << "seed " << seed;
  }
  const VectorXd product = p.lux_per_level * level;
  for (Index i = 0; i < p.max_lx.size(); ++i) {
    ASSERT_LE(p.lux_per_level.row(i).dot(level) + p.fixed_lx[i], p.max_lx[i]) << "seed " << seed;
    ASSERT_LE(product[i] + p.fixed_lx[i], p.max_lx[i]) << "seed " << seed;
    double forwards = 0, backwards = 0;
    for (Index j = 0; j < level.size(); ++j) {
      forwards += p.lux_per_level(i, j) * level[j];
      backwards = std::fma(p.lux_per_level(i, level.size() - 1 - j), level[level.size() - 1 - j], backwards);
    }
    ASSERT_LE(forwards + p.fixed_lx[i], p.max_lx[i]) << "seed " << seed;
    ASSERT_LE(backwards + p.fixed_lx[i], p.max_lx[i]) << "seed " << seed;
  }
}

/// Distance of the negative gradient from the cone of the active constraints' normals (Farkas), relative to the
/// columns' norms times that of the right-hand side. Independent of the solver's multipliers.
double gradient_off_cone(const EmittanceProblem& p, const VectorXd& level) {
  const Index n = level.size();
  const double right = std::sqrt(goals_squared(p));
  if (right == 0) return 0;
  VectorXd norm = VectorXd::Zero(n), gradient = VectorXd::Zero(n);
  for (Index i = 0; i < p.goal_lx.size(); ++i) {
    if (std::isnan(p.goal_lx[i])) continue;
    const VectorXd row = p.weight[i] * p.lux_per_level.row(i).transpose();
    norm += row.cwiseAbs2();
    gradient += row * p.weight[i] * (p.lux_per_level.row(i).dot(level) - missing_lx(p, i));
  }
  norm = norm.cwiseSqrt();
  for (Index j = 0; j < n; ++j)
    if (norm[j] == 0) norm[j] = std::max(p.lux_per_level.col(j).norm(), 1e-300);
  std::vector<VectorXd> normals;
  for (Index j = 0; j < n; ++j) {
    if (level[j] == 0) normals.push_back(-VectorXd::Unit(n, j));
    if (level[j] >= p.max_level[j] * (1 - 1e-11)) normals.push_back(VectorXd::Unit(n, j));
  }
  for (Index i = 0; i < p.max_lx.size(); ++i) {
    const VectorXd row = p.lux_per_level.row(i).transpose().cwiseQuotient(norm);
    if (p.lux_per_level.row(i).dot(level) + p.fixed_lx[i] >= p.max_lx[i] * (1 - 1e-11) && row.norm() > 0)
      normals.push_back(row.normalized());
  }
  MatrixXd cone(n, static_cast<Index>(normals.size()));
  for (std::size_t k = 0; k < normals.size(); ++k) cone.col(static_cast<Index>(k)) = normals[k];
  const VectorXd wanted = -gradient.cwiseQuotient(norm) / right;
  return solve_nnls(cone, wanted).residual_norm;
}

/// Least objective over all choices of active constraints, each solved as an equality-constrained problem.
double enumerated_objective(const EmittanceProblem& p) {
  const Index n = p.lux_per_level.cols();
  std::vector<Index> goals, limits;
  for (Index i = 0; i < p.goal_lx.size(); ++i) {
    if (!std::isnan(p.goal_lx[i])) goals.push_back(i);
    if (std::isfinite(p.max_lx[i])) limits.push_back(i);
  }
  MatrixXd E(static_cast<Index>(goals.size()), n);
  VectorXd f(E.rows());
  for (Index k = 0; k < E.rows(); ++k) {
    const Index i = goals[static_cast<std::size_t>(k)];
    E.row(k) = p.weight[i] * p.lux_per_level.row(i);
    f[k] = p.weight[i] * missing_lx(p, i);
  }
  double least = objective(p, VectorXd::Zero(n));
  int bounds = 1;
  for (Index j = 0; j < n; ++j) bounds *= 3;
  for (int choice = 0; choice < bounds; ++choice)
    for (unsigned rows = 0; rows < (1u << limits.size()); ++rows) {
      std::vector<VectorXd> normal;
      std::vector<double> value;
      for (Index j = 0, rest = choice; j < n; ++j, rest /= 3) {
        if (rest % 3 == 0) continue;
        normal.push_back(VectorXd::Unit(n, j));
        value.push_back(rest % 3 == 1 ? 0 : p.max_level[j]);
      }
      for (std::size_t k = 0; k < limits.size(); ++k) {
        const double norm = p.lux_per_level.row(limits[k]).norm();
        if (!(rows >> k & 1u) || norm == 0) continue;
        normal.push_back(p.lux_per_level.row(limits[k]).transpose() / norm);
        value.push_back((p.max_lx[limits[k]] - p.fixed_lx[limits[k]]) / norm);
      }
      const auto held = static_cast<Index>(normal.size());
      if (held > n) continue;
      VectorXd c = VectorXd::Zero(n);
      MatrixXd null_space = MatrixXd::Identity(n, n);
      if (held > 0) {
        MatrixXd N(n, held);
        VectorXd d(held);
        for (Index k = 0; k < held; ++k) {
          N.col(k) = normal[static_cast<std::size_t>(k)];
          d[k] = value[static_cast<std::size_t>(k)];
        }
        const Eigen::ColPivHouseholderQR<MatrixXd> qr(N);
        if (qr.rank() < held) continue;
        c = N.transpose().completeOrthogonalDecomposition().solve(d);
        null_space = MatrixXd(qr.householderQ()).rightCols(n - held);
      }
      if (null_space.cols() > 0 && E.rows() > 0) {
        const MatrixXd reduced = E * null_space;
        c += null_space * reduced.completeOrthogonalDecomposition().solve(f - E * c);
      }
      bool feasible = c.minCoeff() >= -1e-10 && (p.max_level - c).minCoeff() >= -1e-10;
      for (const Index i : limits)
        feasible = feasible && p.lux_per_level.row(i).dot(c) + p.fixed_lx[i] <= p.max_lx[i] + 1e-9 * (1 + p.max_lx[i]);
      if (feasible) least = std::min(least, objective(p, c));
    }
  return least;
}

TEST(Emittance, MeetsTheKktConditionsOnAThousandProblems) {
  double worst = 0, worst_own = 0;
  for (int seed = 0; seed < 1000; ++seed) {
    const EmittanceProblem p = random_problem(seed, 25, 15);
    const auto solution = solve_emittance(p);
    ASSERT_TRUE(solution) << solution.error().detail;
    const double violation = gradient_off_cone(p, solution->level);
    EXPECT_LT(violation, 1e-9) << "seed " << seed;
    EXPECT_LT(solution->kkt_residual, 1e-9) << "seed " << seed;
    worst = std::max(worst, violation);
    worst_own = std::max(worst_own, solution->kkt_residual);
  }
  std::printf("worst KKT residual of 1000: %.2e, as the solver reports it %.2e\n", worst, worst_own);
}

TEST(Emittance, MatchesEnumerationOfAllActiveSets) {
  for (int seed = 0; seed < 600; ++seed) {
    if (seed % 5 == 4) continue;  // the reference cannot handle extreme units
    const EmittanceProblem p = random_problem(seed, 4, 3);
    const auto solution = solve_emittance(p);
    ASSERT_TRUE(solution) << solution.error().detail;
    EXPECT_NEAR(objective(p, solution->level), enumerated_objective(p), 1e-7 * (1 + goals_squared(p)))
        << "seed " << seed;
  }
}

TEST(Emittance, KeepsEveryLimitExactlyOnTenThousandProblems) {
  for (int seed = 0; seed < 10000; ++seed) {
    const EmittanceProblem p = random_problem(seed, 8, 6);
    const auto solution = solve_emittance(p);
    ASSERT_TRUE(solution) << solution.error().detail;
    expect_within_limits(p, solution->level, seed);
    if (HasFatalFailure()) return;
  }
}

TEST(Emittance, GivesAReasonForMissedGoalsOnly) {
  for (int seed = 0; seed < 1000; ++seed) {
    const EmittanceProblem p = random_problem(seed, 10, 6);
    const auto solution = solve_emittance(p);
    ASSERT_TRUE(solution);
    for (Index i = 0; i < p.goal_lx.size(); ++i) {
      const PointOutcome& outcome = solution->points[static_cast<std::size_t>(i)];
      const bool met = std::isnan(p.goal_lx[i]) || std::abs(outcome.shortfall_lx) <= 0.01 * p.goal_lx[i];
      EXPECT_EQ(met, outcome.binding == Binding::none) << "seed " << seed << " point " << i;
      EXPECT_EQ(met, outcome.reason.empty()) << "seed " << seed << " point " << i;
      for (const int k : outcome.limit_points)
        EXPECT_NEAR(solution->points[static_cast<std::size_t>(k)].lux, p.max_lx[k], 2e-6 * p.max_lx[k]);
      for (const int j : outcome.limit_lights) EXPECT_NEAR(solution->level[j], p.max_level[j], 2e-6);
    }
  }
}

TEST(Emittance, EqualsNnlsWhereNothingBindsFromAbove) {
  for (int seed = 0; seed < 200; ++seed) {
    EmittanceProblem p = random_problem(seed, 12, 6);
    p.max_lx.setConstant(kInf);
    p.max_level.setConstant(1e30);
    p.weight.setOnes();
    for (double& goal : p.goal_lx) goal = std::isnan(goal) ? 1 : goal;
    const auto solution = solve_emittance(p);
    ASSERT_TRUE(solution);
    const NnlsResult nnls = solve_nnls(p.lux_per_level, (p.goal_lx - p.fixed_lx).cwiseMax(0.0));
    EXPECT_NEAR(std::sqrt(objective(p, solution->level)), nnls.residual_norm, 1e-7 * std::sqrt(goals_squared(p)));
  }
}

TEST(Emittance, APointOverlitByDaylightHoldsNoOtherDown) {
  EmittanceProblem p;
  p.lux_per_level = MatrixXd{{20.0, 1.0}, {2.0, 100.0}};
  p.fixed_lx = VectorXd{{5000, 100}};
  p.goal_lx = VectorXd{{500, 150}};
  p.max_lx = VectorXd::Constant(2, kInf);
  const auto solution = solve_emittance(p);
  ASSERT_TRUE(solution) << solution.error().detail;
  // The first point is too bright in any case. The second gets its goal, less a trifle because of spill on the first.
  EXPECT_NEAR(solution->points[1].lux, 150, 0.02);
  EXPECT_LT(solution->level[0], 1e-9);
  EXPECT_NE(solution->points[0].reason.find("5000 lx are there with all its lights off"), std::string::npos)
      << solution->points[0].reason;
}

EmittanceProblem two_points_one_light() {
  EmittanceProblem p;
  p.lux_per_level = MatrixXd{{100.0}, {50.0}};
  p.goal_lx = VectorXd{{kNone, kNone}};
  p.max_lx = VectorXd::Constant(2, kInf);
  p.point_name = {"desk", "drawing"};
  p.light_name = {"spot-1"};
  return p;
}

TEST(Emittance, NamesThePointsOwnLimit) {
  EmittanceProblem p = two_points_one_light();
  p.goal_lx[0] = 80;
  p.max_lx[0] = 50;
  const auto solution = solve_emittance(p);
  ASSERT_TRUE(solution);
  EXPECT_NEAR(solution->level[0], 0.5, 1e-9);
  EXPECT_EQ(solution->points[0].binding, Binding::max_lux_here);
  EXPECT_EQ(solution->points[0].limit_points, std::vector<int>{0});
  EXPECT_EQ(solution->points[0].reason, "held at 50 lx by its own limit of 50 lx, goal 80 lx");
}

TEST(Emittance, NamesTheLimitElsewhere) {
  EmittanceProblem p = two_points_one_light();
  p.goal_lx[0] = 80;
  p.max_lx[1] = 20;
  const auto solution = solve_emittance(p);
  ASSERT_TRUE(solution);
  EXPECT_EQ(solution->points[0].binding, Binding::max_lux_elsewhere);
  EXPECT_EQ(solution->points[0].limit_points, std::vector<int>{1});
  EXPECT_EQ(solution->points[0].reason, "held at 40 lx by the limit of 20 lx at 'drawing', goal 80 lx");
  EXPECT_EQ(solution->points[1].binding, Binding::none);
}

TEST(Emittance, NamesTheLightAtItsHighestLevel) {
  EmittanceProblem p = two_points_one_light();
  p.goal_lx[0] = 200;
  const auto solution = solve_emittance(p);
  ASSERT_TRUE(solution);
  EXPECT_EQ(solution->level[0], 1);
  EXPECT_EQ(solution->points[0].binding, Binding::max_level);
  EXPECT_EQ(solution->points[0].limit_lights, std::vector<int>{0});
  EXPECT_EQ(solution->points[0].reason, "held at 100 lx by the highest level of 'spot-1', goal 200 lx");
}

TEST(Emittance, ReportsWhenNoLightReachesAPoint) {
  EmittanceProblem p = two_points_one_light();
  p.lux_per_level(1, 0) = 0;
  p.goal_lx = VectorXd{{80, 60}};
  const auto solution = solve_emittance(p);
  ASSERT_TRUE(solution);
  EXPECT_NEAR(solution->points[0].lux, 80, 1e-8);
  EXPECT_EQ(solution->points[1].binding, Binding::out_of_reach);
}

TEST(Emittance, ReportsWhenItIsTooBrightWithAllLightsOff) {
  EmittanceProblem p = two_points_one_light();
  p.goal_lx[1] = 10;
  p.fixed_lx = VectorXd{{0, 30}};
  const auto solution = solve_emittance(p);
  ASSERT_TRUE(solution);
  EXPECT_EQ(solution->level[0], 0);
  EXPECT_EQ(solution->points[1].binding, Binding::min_level);
  EXPECT_EQ(solution->points[1].reason, "30 lx are there with all its lights off, goal 10 lx");
}

TEST(Emittance, ReportsWhenGoalsWereTraded) {
  EmittanceProblem p = two_points_one_light();
  p.goal_lx = VectorXd{{50, 50}};
  const auto solution = solve_emittance(p);
  ASSERT_TRUE(solution);
  EXPECT_NEAR(solution->level[0], 0.6, 1e-9);  // (100·50 + 50·50) / (100² + 50²)
  EXPECT_EQ(solution->points[0].binding, Binding::traded);
  EXPECT_EQ(solution->points[1].binding, Binding::traded);
  EXPECT_TRUE(solution->points[1].limit_points.empty());
}

TEST(Emittance, NumbersPointsAndLightsWithoutNames) {
  EmittanceProblem p = two_points_one_light();
  p.point_name.clear();
  p.goal_lx[0] = 80;
  p.max_lx[1] = 20;
  const auto solution = solve_emittance(p);
  ASSERT_TRUE(solution);
  EXPECT_EQ(solution->points[0].reason, "held at 40 lx by the limit of 20 lx at point 1, goal 80 lx");
}

TEST(Emittance, SharesEquallyAmongEqualLightsAndStaysNearAPreference) {
  EmittanceProblem p;
  p.lux_per_level = MatrixXd::Constant(1, 4, 100);
  p.goal_lx = VectorXd::Constant(1, 120);
  p.max_lx = VectorXd::Constant(1, kInf);
  auto solution = solve_emittance(p);
  ASSERT_TRUE(solution);
  EXPECT_LT((solution->level - VectorXd::Constant(4, 0.3)).norm(), 1e-6);
  p.near_level = VectorXd{{0.6, 0.2, 0, 0.2}};
  solution = solve_emittance(p);
  ASSERT_TRUE(solution);
  EXPECT_LT((solution->level - VectorXd{{0.65, 0.25, 0.05, 0.25}}).norm(), 1e-6);
}

TEST(Emittance, LeavesUnneededLightsOff) {
  EmittanceProblem p = two_points_one_light();
  auto solution = solve_emittance(p);
  ASSERT_TRUE(solution);
  EXPECT_EQ(solution->level[0], 0);
  EXPECT_EQ(solution->normalised_error, 0);
}

TEST(Emittance, HandlesNoLightsAndNoPoints) {
  EmittanceProblem p;
  p.lux_per_level.resize(0, 3);
  auto solution = solve_emittance(p);
  ASSERT_TRUE(solution) << solution.error().detail;
  EXPECT_EQ(solution->level, VectorXd::Zero(3));
  p.lux_per_level.resize(2, 0);
  p.goal_lx = VectorXd{{10, kNone}};
  solution = solve_emittance(p);
  ASSERT_TRUE(solution) << solution.error().detail;
  EXPECT_EQ(solution->level.size(), 0);
  EXPECT_EQ(solution->points[0].binding, Binding::out_of_reach);
  EXPECT_DOUBLE_EQ(solution->normalised_error, 1);
}

TEST(Emittance, RefusesInvalidInputAndNamesThePoint) {
  EmittanceProblem p = two_points_one_light();
  p.fixed_lx = VectorXd{{0, 30}};
  p.max_lx[1] = 20;
  auto solution = solve_emittance(p);
  ASSERT_FALSE(solution);
  EXPECT_EQ(solution.error().cause, Cause::invalid);
  EXPECT_EQ(solution.error().detail, "point 'drawing': the limit of 20 lx is below the 30 lx that are there anyway");
  p = two_points_one_light();
  p.start_level = VectorXd::Ones(2);
  solution = solve_emittance(p);
  ASSERT_FALSE(solution);
  EXPECT_EQ(solution.error().detail, "start_level has 2 entries, 1 are needed");
  for (const double bad : {-1.0, kNone, kInf}) {
    p = two_points_one_light();
    p.lux_per_level(1, 0) = bad;
    EXPECT_FALSE(solve_emittance(p));
    p = two_points_one_light();
    p.weight = VectorXd{{1, bad}};
    EXPECT_FALSE(solve_emittance(p));
    p = two_points_one_light();
    p.max_level = VectorXd{{bad}};
    EXPECT_FALSE(solve_emittance(p));
  }
  p = two_points_one_light();
  p.max_lx[0] = kNone;
  EXPECT_FALSE(solve_emittance(p));
  p = two_points_one_light();
  p.goal_lx.resize(3);
  EXPECT_FALSE(solve_emittance(p));
}

TEST(Emittance, StopsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  Watch watch;
  watch.stop = source.get_token();
  const auto solution = solve_emittance(random_problem(1, 10, 5), watch);
  ASSERT_FALSE(solution);
  EXPECT_EQ(solution.error().cause, Cause::cancelled);
}

TEST(Emittance, SolvesAHundredLightsWithSixtyLimits) {
  EmittanceProblem p = random_problem(0, 1, 1);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform;
  p.lux_per_level.resize(150, 100);
  for (double& value : p.lux_per_level.reshaped()) value = std::pow(uniform(random), 4) * 100;
  p.goal_lx = VectorXd::Constant(150, 200);
  p.max_lx = VectorXd::Constant(150, kInf);
  p.max_lx.head(60).setConstant(150);
  p.fixed_lx.resize(0);
  p.weight.resize(0);
  p.max_level.resize(0);
  const auto solution = solve_emittance(p);
  ASSERT_TRUE(solution);
  EXPECT_LT(solution->kkt_residual, 1e-9);
  EXPECT_LT(solution->iterations, 1000);
}

}  // namespace
}  // namespace luxrig
