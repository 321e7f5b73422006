#include "core/solve/least_squares/nnls_of_few.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "tests/core/solve/least_squares/least_squares_problem.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Only the chosen columns, for the other solver.
LeastSquaresCase chosen(const LeastSquaresCase& c, std::span<const Index> columns) {
  LeastSquaresCase part = c;
  part.A = c.A(Eigen::all, std::vector<Index>(columns.begin(), columns.end()));
  if (c.upper.size() > 0) part.upper = c.upper(std::vector<Index>(columns.begin(), columns.end()));
  return part;
}

TEST(NnlsOfFew, IsOptimalAfterEachOfTwentyThousandExchanges) {
  double worst = 0;
  int checked = 0;
  for (int seed = 0; seed < 600; ++seed) {
    const LeastSquaresCase c = least_squares_case(seed, 40, 60);
    const auto problem = share_problem(c.sparse());
    ASSERT_TRUE(problem.has_value());
    NnlsOfFew few(*problem);
    std::mt19937 random(static_cast<unsigned>(seed));
    const auto pick = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
    const auto column = [&] { return static_cast<Index>(pick(static_cast<std::size_t>(c.A.cols()))); };
    few.choose(std::vector<Index>{column(), column(), column(), column()});
    for (int step = 0; step < 34; ++step) {
      const std::size_t what = pick(8);
      if (what == 0 && few.columns().size() < 12)
        few.add(column());
      else if (what == 1 && few.columns().size() > 1)
        few.drop(pick(few.columns().size()));
      else
        few.exchange(pick(few.columns().size()), column());
      const LeastSquaresCase part = chosen(c, few.columns());
      VectorXd x(part.A.cols());
      for (Index k = 0; k < x.size(); ++k) x[k] = few.level(static_cast<std::size_t>(k));
      const double violation = kkt_violation(part, x), goal = weighted_goal(c);
      ASSERT_LT(violation, 1e-10) << seed << ' ' << step;
      ASSERT_LT(few.kkt().worst(), 1e-10) << seed << ' ' << step;
      ASSERT_NEAR(few.residual_norm(), weighted_norm(part, x), 1e-10 * goal) << seed << ' ' << step;
      ASSERT_LE((few.residual() - (part.goal - part.A * x)).norm(), 1e-10 * c.goal.norm()) << seed;
      if (step == 33) {
        const auto fresh = solve_nnls(part.dense());
        ASSERT_NEAR(few.residual_norm(), fresh->residual_norm, 1e-9 * goal) << seed;
      }
      worst = std::max(worst, violation);
      ++checked;
    }
  }
  std::printf("%d exchanges: worst KKT violation %.2e\n", checked, worst);
}

TEST(NnlsOfFew, ACopyRestoresAnEarlierState) {
  const LeastSquaresCase c = least_squares_case(13, 40, 60);
  NnlsOfFew few(*share_problem(c.sparse()));
  few.choose(std::vector<Index>{0, 1 % c.A.cols(), 2 % c.A.cols()});
  const NnlsOfFew kept = few;
  const double before = few.residual_norm();
  few.exchange(0, c.A.cols() - 1);
  few = kept;
  EXPECT_EQ(few.residual_norm(), before);
  EXPECT_EQ(few.columns()[0], 0);
}

TEST(NnlsOfFew, HandlesNoColumnsAndNoGoal) {
  LeastSquaresCase c = least_squares_case(1, 10, 5);
  NnlsOfFew none(*share_problem(c.sparse()));
  none.choose({});
  EXPECT_NEAR(none.residual_norm(), c.goal.norm(), 1e-15 * c.goal.norm());
  c.goal.setZero();
  NnlsOfFew dark(*share_problem(c.sparse()));
  dark.choose(std::vector<Index>{0});
  EXPECT_EQ(dark.level(0), 0);
  EXPECT_EQ(dark.residual_norm(), 0);
  c.goal[0] = NAN;
  EXPECT_FALSE(share_problem(c.sparse()).has_value());
}

}  // namespace
}  // namespace luxrig
