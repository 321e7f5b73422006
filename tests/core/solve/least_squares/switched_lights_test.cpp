// Lights that are on or off, compared with every setting of them, each solved by another method (limited_nnls.h).
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/solve/emittance.h"
#include "core/solve/least_squares/limited_nnls.h"
#include "core/solve/least_squares/switched_least_squares.h"
#include "tests/core/solve/emittance_goals.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kBoundless = std::numeric_limits<double>::infinity();
const double kNoGoal = std::numeric_limits<double>::quiet_NaN();

/// Every third is degenerate: equal and dark lights, no room below a limit, highest level 0.
EmittanceProblem random_switched_problem(unsigned seed, Index max_points, Index max_lights) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform;
  const auto pick = [&](Index n) { return std::uniform_int_distribution<Index>(0, n - 1)(random); };
  const Index points = 1 + pick(max_points), lights = 1 + pick(max_lights);
  const double unit = seed % 7 == 6 ? std::pow(10.0, 12 * uniform(random) - 6) : 1;
  EmittanceProblem p;
  p.lux_per_level.resize(points, lights);
  for (double& value : p.lux_per_level.reshaped()) value = unit * std::max(0.0, 300 * uniform(random) - 100);
  p.fixed_lx.resize(points);
  p.goal_lx.resize(points);
  p.weight.resize(points);
  p.max_lx.resize(points);
  p.max_level = VectorXd::Ones(lights);
  p.watts.setConstant(lights, 10);
  if (uniform(random) < 0.3) p.max_watts = 10.0 * static_cast<double>(lights) * uniform(random);
  for (Index i = 0; i < points; ++i) {
    p.fixed_lx[i] = unit * 10 * uniform(random);
    p.goal_lx[i] = uniform(random) < 0.2 ? kNoGoal : unit * 300 * uniform(random);
    p.weight[i] = uniform(random) < 0.5 ? 1 : 2 * uniform(random);
    p.max_lx[i] = uniform(random) < 0.5 ? kBoundless : p.fixed_lx[i] + unit * 200 * uniform(random);
  }
  for (Index j = 0; j < lights; ++j) p.switched.push_back(uniform(random) < 0.6);
  if (seed % 3 == 2) {
    p.lux_per_level.col(pick(lights)) = p.lux_per_level.col(pick(lights)).eval();
    p.lux_per_level.col(pick(lights)).setZero();
    p.max_level[pick(lights)] = 0;
    const Index full = pick(points);
    p.max_lx[full] = p.fixed_lx[full];
  }
  return p;
}

double error_of(const EmittanceProblem& p, const VectorXd& level) { return std::sqrt(objective(p, level)); }

/// Solves the dimmable lights for this setting; +inf if the setting alone exceeds a limit.
double min_error_with(const EmittanceProblem& p, const VectorXd& set) {
  std::vector<Index> dims, goals, limits;
  for (Index j = 0; j < set.size(); ++j)
    if (!p.switched[static_cast<std::size_t>(j)]) dims.push_back(j);
  for (Index i = 0; i < p.goal_lx.size(); ++i) {
    if (p.lux_per_level.row(i).dot(set) + p.fixed_lx[i] > p.max_lx[i]) return kBoundless;
    if (!std::isnan(p.goal_lx[i])) goals.push_back(i);
    if (std::isfinite(p.max_lx[i])) limits.push_back(i);
  }
  const double watts_left = p.max_watts - p.watts.dot(set);
  if (watts_left < 0) return kBoundless;
  if (dims.empty() || goals.empty()) return error_of(p, set);
  const auto columns = static_cast<Index>(dims.size());
  MatrixXd A(static_cast<Index>(goals.size()), columns);
  NnlsProblem problem;
  problem.goal.resize(A.rows());
  problem.upper.resize(columns);
  for (Index r = 0; r < A.rows(); ++r) {
    const Index i = goals[static_cast<std::size_t>(r)];
    for (Index c = 0; c < columns; ++c) A(r, c) = p.weight[i] * p.lux_per_level(i, dims[static_cast<std::size_t>(c)]);
    problem.goal[r] = p.weight[i] * (missing_lx(p, i) - p.lux_per_level.row(i).dot(set));
  }
  for (Index c = 0; c < columns; ++c) problem.upper[c] = p.max_level[dims[static_cast<std::size_t>(c)]];
  problem.columns = ColumnsView(A);
  LinearLimits of_dims;
  MatrixXd rows(static_cast<Index>(limits.size()) + 1, columns);
  of_dims.most.resize(rows.rows());
  for (Index r = 0; r + 1 < rows.rows(); ++r) {
    const Index i = limits[static_cast<std::size_t>(r)];
    for (Index c = 0; c < columns; ++c) rows(r, c) = p.lux_per_level(i, dims[static_cast<std::size_t>(c)]);
    of_dims.most[r] = std::max(0.0, p.max_lx[i] - p.fixed_lx[i] - p.lux_per_level.row(i).dot(set));
  }
  for (Index c = 0; c < columns; ++c) rows(rows.rows() - 1, c) = p.watts[dims[static_cast<std::size_t>(c)]];
  of_dims.most[rows.rows() - 1] = std::min(watts_left, 1e6);
  of_dims.rows = rows.sparseView();
  const auto solved = solve_limited_nnls(problem, of_dims);
  if (!solved) {
    ADD_FAILURE() << solved.error().detail;
    return kBoundless;
  }
  VectorXd level = set;
  for (Index c = 0; c < columns; ++c) level[dims[static_cast<std::size_t>(c)]] = solved->least_squares.x[c];
  return error_of(p, level);
}

double min_error_of_all_settings(const EmittanceProblem& p) {
  std::vector<Index> switched;
  for (Index j = 0; j < p.max_level.size(); ++j)
    if (p.switched[static_cast<std::size_t>(j)]) switched.push_back(j);
  double least = kBoundless;
  for (unsigned setting = 0; setting < 1u << switched.size(); ++setting) {
    VectorXd set = VectorXd::Zero(p.max_level.size());
    for (std::size_t k = 0; k < switched.size(); ++k)
      if ((setting >> k & 1u) != 0) set[switched[k]] = p.max_level[switched[k]];
    least = std::min(least, min_error_with(p, set));
  }
  return least;
}

void expect_allowed(const EmittanceProblem& p, const VectorXd& level, unsigned seed) {
  for (Index j = 0; j < level.size(); ++j) {
    ASSERT_TRUE(level[j] >= 0 && level[j] <= p.max_level[j]) << "seed " << seed;
    const bool dims = !p.switched[static_cast<std::size_t>(j)];
    ASSERT_TRUE(dims || level[j] == 0 || level[j] == p.max_level[j]) << "seed " << seed << ": " << level[j];
  }
  for (Index i = 0; i < p.max_lx.size(); ++i) {
    double backwards = 0;
    for (Index j = level.size(); j-- > 0;) backwards += p.lux_per_level(i, j) * level[j];
    ASSERT_LE(p.lux_per_level.row(i).dot(level) + p.fixed_lx[i], p.max_lx[i]) << "seed " << seed;
    ASSERT_LE(backwards + p.fixed_lx[i], p.max_lx[i]) << "seed " << seed;
  }
  ASSERT_LE(p.watts.dot(level), p.max_watts) << "seed " << seed;
}

TEST(SwitchedLights, MatchTheBestOfAllSettings) {
  int with_switched = 0, with_some_on = 0, worse_than_dimmed = 0;
  for (unsigned seed = 0; seed < 600; ++seed) {
    const EmittanceProblem p = random_switched_problem(seed, 8, 7);
    const auto solution = solve_emittance(p);
    ASSERT_TRUE(solution) << "seed " << seed << ": " << solution.error().detail;
    expect_allowed(p, solution->level, seed);
    EXPECT_TRUE(solution->switches_proven);
    EXPECT_LT(solution->kkt_residual, 1e-8) << "seed " << seed;
    VectorXd none = VectorXd::Zero(p.max_level.size());
    const double error = error_of(p, solution->level), least = min_error_of_all_settings(p), dark = error_of(p, none);
    EXPECT_LE(error, least * (1 + 1e-6) + 1e-8 * dark) << "seed " << seed;
    EXPECT_GE(error, least * (1 - 1e-6) - 1e-8 * dark) << "seed " << seed << ": better than any setting?";
    EmittanceProblem dimmed = p;
    dimmed.switched.clear();
    const auto could = solve_emittance(dimmed);
    ASSERT_TRUE(could);
    EXPECT_GE(error, error_of(p, could->level) - 1e-8 * dark) << "seed " << seed;
    bool some = false, on = false;
    for (Index j = 0; j < p.max_level.size(); ++j) {
      some = some || p.switched[static_cast<std::size_t>(j)];
      on = on || (p.switched[static_cast<std::size_t>(j)] && solution->level[j] > 0);
    }
    with_switched += some;
    with_some_on += on;
    worse_than_dimmed += error > error_of(p, could->level) + 1e-3 * dark;
  }
  EXPECT_GT(with_switched, 400);
  EXPECT_GT(with_some_on, 150);
  EXPECT_GT(worse_than_dimmed, 150);
}

EmittanceProblem one_point(std::vector<double> lux, std::vector<bool> switched, double goal_lx, double max_lx) {
  EmittanceProblem p;
  p.lux_per_level = Eigen::Map<const Eigen::RowVectorXd>(lux.data(), static_cast<Index>(lux.size()));
  p.goal_lx = VectorXd::Constant(1, goal_lx);
  p.max_lx = VectorXd::Constant(1, max_lx);
  p.switched = std::move(switched);
  for (std::size_t j = 0; j < lux.size(); ++j) p.light_name.push_back(std::string(1, static_cast<char>('a' + j)));
  return p;
}

TEST(SwitchedLights, TurnOnAtHalfTheirLight) {
  EXPECT_EQ(solve_emittance(one_point({100}, {true}, 60, kBoundless))->level[0], 1);
  EXPECT_EQ(solve_emittance(one_point({100}, {true}, 40, kBoundless))->level[0], 0);
  EXPECT_EQ(solve_emittance(one_point({100}, {true}, 90, 99))->level[0], 0) << "it would be above the limit";
  EXPECT_EQ(solve_emittance(one_point({100}, {true}, 90, 100.001))->level[0], 1);
  const auto tight = solve_emittance(one_point({100}, {true}, 60, kBoundless));
  EXPECT_EQ(tight->points[0].binding, Binding::switched);
  EXPECT_NE(tight->points[0].reason.find("'a' can only be on or off"), std::string::npos) << tight->points[0].reason;
}

TEST(SwitchedLights, DimmableLightsMakeUpForThem) {
  const auto both = solve_emittance(one_point({100, 70, 50}, {true, true, false}, 190, kBoundless));
  EXPECT_EQ(both->level[0], 1);
  EXPECT_EQ(both->level[1], 1);
  EXPECT_NEAR(both->level[2], 0.4, 1e-6);
  const auto one = solve_emittance(one_point({100, 70, 50}, {true, true, false}, 85, kBoundless));
  EXPECT_EQ(one->level[0], 0);
  EXPECT_EQ(one->level[1], 1);
  EXPECT_NEAR(one->level[2], 0.3, 1e-6);
  EXPECT_TRUE(both->points[0].reason.empty() && one->points[0].reason.empty());
}

TEST(SwitchedLights, ManyEqualOnesFinishAndStateWhetherTheyAreProven) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform;
  EmittanceProblem p;
  p.lux_per_level.resize(60, 40);
  for (double& value : p.lux_per_level.reshaped()) value = 10 + uniform(random);
  p.goal_lx = VectorXd::Constant(60, 203);
  p.switched.assign(40, true);
  const auto solution = solve_emittance(p);
  ASSERT_TRUE(solution);
  EXPECT_FALSE(solution->switches_proven) << "if it were, the test asks for too little";
  EXPECT_NEAR(solution->level.sum(), 203 / 10.5, 1) << "as many as make the goal";
  EXPECT_LT(solution->normalised_error, 0.03);
}

}  // namespace
}  // namespace luxrig
