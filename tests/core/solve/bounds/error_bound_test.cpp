#include "core/solve/bounds/error_bound.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/solve/least_squares/nnls.h"
#include "tests/core/solve/bounds/error_bound_fixture.h"
#include "tests/random.h"

namespace luxrig {
namespace {

using namespace error_bound_fixture;

constexpr double kEnumerationRounding = 1e-12;

TEST(ErrorBound, EqualsTheLeastErrorAtOptimalLevels) {
  int above_zero = 0;
  for (unsigned seed = 1; seed <= 3000; ++seed) {
    const TinyLights tiny(seed);
    const VectorXd b = tiny.weighted_goal();
    const auto best = solve_nnls(NnlsProblem{ColumnsView(tiny.A), tiny.goal, tiny.weight, {}});
    ASSERT_TRUE(best.has_value());
    const double least = b.norm() > 0 ? best->residual_norm / b.norm() : 0;
    const double bound = error_bound(tiny.candidates(), best->x);
    EXPECT_LE(bound, least + kEnumerationRounding) << seed;
    EXPECT_GE(bound, least - 1e-9) << seed;
    above_zero += bound > 1e-3 ? 1 : 0;
  }
  EXPECT_GT(above_zero, 1500);
}

TEST(ErrorBound, HoldsForAnyLevels) {
  for (unsigned seed = 1; seed <= 3000; ++seed) {
    const TinyLights tiny(seed);
    const VectorXd b = tiny.weighted_goal();
    const auto best = solve_nnls(NnlsProblem{ColumnsView(tiny.A), tiny.goal, tiny.weight, {}});
    ASSERT_TRUE(best.has_value());
    Random random(seed);
    VectorXd x = best->x;
    for (double& level : x) level *= random.between(0.5, 1.5);
    if (seed % 3 == 0) x.setZero();
    if (seed % 50 == 0) x[0] = -1;
    if (seed % 51 == 0) x[0] = std::numeric_limits<double>::infinity();
    EXPECT_LE(error_bound(tiny.candidates(), x),
              (b.norm() > 0 ? best->residual_norm / b.norm() : 0) + kEnumerationRounding)
        << seed;
  }
}

// Thousands of problems, with arbitrary and with sensible prices, and from one block to as many as rows.
TEST(ErrorBoundsByCount, AreNeverAboveTheErrorOfAnyChoiceOfLights) {
  constexpr std::size_t kMax = 3;
  double bound_sum = 0, min_sum = 0;
  for (unsigned seed = 1; seed <= 4000; ++seed) {
    const TinyLights tiny(seed);
    Random random(seed);
    CountBoundOptions options;
    options.max_lights = kMax;
    options.threads = 1;
    options.price_rounds = random.below(4);
    options.nodes_a_round = 10;
    options.nodes = random.below(60);
    options.min_similarity = random.between(0, 1);
    const bool made_up = seed % 2 == 0;
    if (made_up) {
      PriceGuess guess{random.below(5), tiny.weighted_goal()};
      for (double& r : guess.residual) r *= random.between(-1, 1);
      options.guesses = {guess};
    }
    const std::vector<double> least = tiny.min_errors(kMax);
    const std::vector<double> bound = error_bounds_by_count(tiny.candidates(), options);
    ASSERT_EQ(bound.size(), kMax + 1);
    for (std::size_t k = 0; k <= kMax; ++k) {
      EXPECT_LE(bound[k], least[k] + kEnumerationRounding) << seed << ", " << k << " lights";
      if (k > 0) {
        EXPECT_LE(bound[k], bound[k - 1]) << seed;
      }
      if (!made_up && options.nodes > 30) bound_sum += bound[k], min_sum += least[k];
    }
  }
  EXPECT_GT(bound_sum, 0.8 * min_sum);
}

// One block loses nothing: branch and bound ends at the least error.
TEST(ErrorBoundsByCount, ReachTheLeastErrorInOneBlock) {
  for (unsigned seed = 1; seed <= 400; ++seed) {
    const TinyLights tiny(seed);
    CountBoundOptions options;
    options.max_lights = 3;
    options.threads = 1;
    options.price_rounds = 0;
    options.nodes = 2000;
    options.min_similarity = -1;
    for (std::size_t k = 1; k <= 3; ++k) options.guesses.push_back({k, VectorXd::Zero(tiny.goal.size())});
    const std::vector<double> least = tiny.min_errors(3);
    const std::vector<double> bound = error_bounds_by_count(tiny.candidates(), options);
    for (std::size_t k = 1; k <= 3; ++k) {
      EXPECT_LE(bound[k], least[k] + kEnumerationRounding) << seed << ", " << k << " lights";
      EXPECT_GE(bound[k] * bound[k], least[k] * least[k] - 1e-5) << seed << ", " << k << " lights";
    }
  }
}

TEST(ErrorBound, NamesUnreachableRowsAndCountsThem) {
  MatrixXd A(3, 2);
  A << 1, 2, 0, 0, 1, 1;
  const VectorXd goal = VectorXd::Ones(3);
  const BoundProblem of{ColumnsView(A), goal, {}, {}};
  EXPECT_EQ(unreachable_rows(of), std::vector<Index>{1});
  EXPECT_NEAR(error_bound(of, VectorXd::Unit(2, 0)), std::sqrt(1.0 / 3), 1e-12);
  CountBoundOptions options;
  options.max_lights = 1;
  const std::vector<double> bound = error_bounds_by_count(of, options);
  EXPECT_NEAR(bound[0], 1, 1e-12);
  EXPECT_NEAR(bound[1], std::sqrt(1.0 / 3), 1e-6);
}

TEST(ErrorBound, RefusesProblemsItCannotBound) {
  MatrixXd A(1, 2);
  A << 1, -1;
  const VectorXd goal = VectorXd::Ones(1);
  EXPECT_NE(BoundProblem({ColumnsView(A), goal, {}, {}}).complaint(), "");
  A(0, 1) = 1;
  EXPECT_EQ(BoundProblem({ColumnsView(A), goal, {}, {}}).complaint(), "");
  EXPECT_NE(BoundProblem({ColumnsView(A), goal, {}, {0}}).complaint(), "");
  EXPECT_NE(BoundProblem({ColumnsView(A), goal, -goal, {}}).complaint(), "");
  EXPECT_NE(BoundProblem({ColumnsView(A), VectorXd::Ones(2), {}, {}}).complaint(), "");
}

}  // namespace
}  // namespace luxrig
