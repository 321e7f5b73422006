#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cstdio>

#include "core/solve/least_squares/nnls.h"
#include "core/solve/least_squares/nnls_search.h"
#include "tests/core/solve/least_squares/least_squares_problem.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Least error over all choices of each column at a bound or free, where free columns stay within their bounds. By QR.
double enumerated(const LeastSquaresCase& c) {
  const Index n = c.A.cols();
  const bool bounded = c.upper.size() > 0;
  const VectorXd weight = c.row_weight.size() > 0 ? c.row_weight : VectorXd::Ones(c.goal.size());
  double least = weighted_goal(c);
  std::vector<int> place(static_cast<std::size_t>(n), 0);
  while (true) {
    std::vector<Index> free;
    VectorXd goal = weight.cwiseProduct(c.goal);
    bool possible = true;
    for (Index j = 0; j < n; ++j) {
      const int at = place[static_cast<std::size_t>(j)];
      if (at == 1) free.push_back(j);
      if (at != 2) continue;
      possible = possible && std::isfinite(c.upper[j]);
      if (possible) goal -= c.upper[j] * weight.cwiseProduct(c.A.col(j));
    }
    if (possible && static_cast<Index>(free.size()) <= c.A.rows()) {
      MatrixXd part = weight.asDiagonal() * c.A(Eigen::all, free);
      VectorXd norm(part.cols());
      for (Index k = 0; k < part.cols(); ++k) {  // otherwise the reference takes short columns for dependent
        norm[k] = part.col(k).norm() > 0 ? part.col(k).norm() : 1;
        part.col(k) /= norm[k];
      }
      const VectorXd x = free.empty() ? VectorXd() : VectorXd(part.colPivHouseholderQr().solve(goal));
      bool inside = x.allFinite();
      for (Index k = 0; k < x.size(); ++k)
        inside = inside && x[k] >= 0 && (!bounded || x[k] <= norm[k] * c.upper[free[static_cast<std::size_t>(k)]]);
      if (inside) least = std::min(least, free.empty() ? goal.norm() : (part * x - goal).norm());
    }
    std::size_t digit = 0;
    while (digit < place.size() && ++place[digit] > (bounded ? 2 : 1)) place[digit++] = 0;
    if (digit == place.size()) return least;
  }
}

TEST(NnlsProperties, OptimalityHoldsOnSixThousandDegenerateProblems) {
  double worst = 0, worst_said = 0;
  int orthogonal = 0;
  for (int seed = 0; seed < 6000; ++seed) {
    const LeastSquaresCase c = least_squares_case(seed, 30, seed % 3 == 0 ? 80 : 12);
    const auto solution = solve_nnls(seed % 2 ? c.dense() : c.sparse());
    ASSERT_TRUE(solution.has_value()) << seed << ": " << solution.error().detail;
    ASSERT_TRUE(solution->converged) << seed;
    const double violation = kkt_violation(c, solution->x);
    ASSERT_LT(violation, 1e-10) << seed;
    ASSERT_LT(solution->kkt.worst(), 1e-10) << seed;
    ASSERT_NEAR(solution->residual_norm, weighted_norm(c, solution->x), 1e-10 * weighted_goal(c)) << seed;
    worst = std::max(worst, violation);
    worst_said = std::max(worst_said, solution->kkt.worst());
    orthogonal += solution->orthogonal ? 1 : 0;
  }
  std::printf("6000 problems: worst KKT violation %.2e, as the solver says %.2e; %d needed orthogonal factors\n", worst,
              worst_said, orthogonal);
}

TEST(NnlsProperties, MatchesEnumerationOfAllActiveSets) {
  double worst = 0;
  for (int seed = 0; seed < 1800; ++seed) {
    const bool bounded = seed % 12 == 9 || seed % 12 == 11;
    const LeastSquaresCase c = least_squares_case(seed, 12, bounded ? 6 : 8);
    const auto solution = solve_nnls(c.sparse());
    ASSERT_TRUE(solution.has_value());
    const double goal = weighted_goal(c), difference = solution->residual_norm - enumerated(c);
    // Enumeration rounds too: it may take nearly equal columns for dependent and then finds a larger error.
    ASSERT_LE(difference, 1e-9 * goal) << seed;
    ASSERT_GE(difference, -1e-9 * goal - (seed % 12 == 5 || seed % 12 == 11 ? 1e-6 * goal : 0)) << seed;
    if (goal > 0) worst = std::max(worst, std::abs(difference) / goal);
  }
  std::printf("1800 problems: largest difference from enumeration %.2e of the goal\n", worst);
}

/// Accelerated projected gradient (Nesterov 1983; Beck & Teboulle 2009): works without active sets.
VectorXd projected_gradient(const MatrixXd& A, const VectorXd& b, int steps) {
  const double lipschitz = (A.transpose() * A).eval().cwiseAbs().rowwise().sum().maxCoeff();
  VectorXd x = VectorXd::Zero(A.cols()), y = x;
  double t = 1;
  for (int k = 0; k < steps; ++k) {
    const VectorXd next = (y + A.transpose() * (b - A * y) / lipschitz).cwiseMax(0.0);
    if ((next - x).dot(y - next) > 0) t = 1;  // restart where momentum points uphill
    const double after = (1 + std::sqrt(1 + 4 * t * t)) / 2;
    y = next + (t - 1) / after * (next - x);
    x = next;
    t = after;
  }
  return x;
}

TEST(NnlsProperties, MatchesProjectedGradients) {
  for (int seed = 0; seed < 60; ++seed) {
    LeastSquaresCase c = least_squares_case(12 * seed + 1, 60, 50);
    const auto solution = solve_nnls(c.sparse());
    ASSERT_TRUE(solution.has_value());
    EXPECT_NEAR(solution->residual_norm, weighted_norm(c, projected_gradient(c.A, c.goal, 20000)), 1e-9 * c.goal.norm())
        << seed;
  }
}

/// The fallback, which none of the problems above needs, must be as good.
TEST(NnlsProperties, OrthogonalFactorsGiveTheSameResult) {
  double worst = 0;
  for (int seed = 0; seed < 1200; ++seed) {
    const LeastSquaresCase c = least_squares_case(seed, 30, seed % 3 == 0 ? 60 : 12);
    const NnlsProblem problem = c.sparse();
    const ScaledColumns scaled(problem);
    NnlsSearch search(scaled, make_orthogonal_columns(scaled));
    search.run({1, {}});
    const NnlsSolution solution = search.solution();
    ASSERT_TRUE(solution.converged) << seed;
    ASSERT_LT(kkt_violation(c, solution.x), 1e-10) << seed;
    ASSERT_NEAR(solution.residual_norm, solve_nnls(problem)->residual_norm, 1e-10 * weighted_goal(c)) << seed;
    worst = std::max(worst, kkt_violation(c, solution.x));
  }
  std::printf("1200 problems by orthogonal factors: worst KKT violation %.2e\n", worst);
}

TEST(NnlsProperties, OneAndManyColumnsAtATimeGiveTheSameResult) {
  for (int seed = 0; seed < 40; ++seed) {
    const LeastSquaresCase c = least_squares_case(12 * seed + 2, 120, 600);
    NnlsOptions one;
    one.max_entering = 1;
    const auto fast = solve_nnls(c.sparse()), slow = solve_nnls(c.sparse(), one);
    ASSERT_TRUE(fast && slow);
    EXPECT_NEAR(fast->residual_norm, slow->residual_norm, 1e-12 * c.goal.norm()) << seed;
    EXPECT_LE(fast->iterations, slow->iterations);
  }
}

TEST(NnlsProperties, ContinuesFromItsLastSolution) {
  const LeastSquaresCase c = least_squares_case(12 * 7 + 2, 200, 2000);
  auto solver = NnlsSolver::make(c.sparse());
  ASSERT_TRUE(solver.has_value());
  const NnlsSolution first = solver->solve();
  EXPECT_EQ(solver->solve().iterations, 0);
  // Another goal; one column forbidden and allowed again; a start from elsewhere.
  const VectorXd other = c.goal + 0.01 * c.goal.norm() * VectorXd::Ones(c.goal.size());
  solver->set_goal(other);
  const NnlsSolution warm = solver->solve();
  NnlsProblem changed = c.sparse();
  changed.goal = other;
  const auto cold = solve_nnls(changed);
  EXPECT_NEAR(warm.residual_norm, cold->residual_norm, 1e-12 * other.norm());
  Index strongest = 0;
  warm.x.maxCoeff(&strongest);
  solver->allow(strongest, false);
  const NnlsSolution without = solver->solve();
  EXPECT_EQ(without.x[strongest], 0);
  EXPECT_LT(without.kkt.worst(), 1e-12);
  EXPECT_FALSE(without.orthogonal);
  EXPECT_LT(without.iterations, 10);
  EXPECT_GT(without.residual_norm, warm.residual_norm);
  LeastSquaresCase less = c;
  less.upper = VectorXd::Constant(c.A.cols(), std::numeric_limits<double>::infinity());
  less.upper[strongest] = 0;
  less.goal = other;
  EXPECT_LT(kkt_violation(less, without.x), 1e-12);
  solver->allow(strongest, true);
  EXPECT_NEAR(solver->solve().residual_norm, cold->residual_norm, 1e-12 * other.norm());
  solver->start_from(VectorXd::Constant(c.A.cols(), 1e3));
  EXPECT_NEAR(solver->solve().residual_norm, cold->residual_norm, 1e-12 * other.norm());
  solver->start_from(first.x);
  EXPECT_NEAR(solver->solve().residual_norm, cold->residual_norm, 1e-12 * other.norm());
}

TEST(NnlsProperties, RefusesNaNAndMismatchedSizes) {
  MatrixXd A = MatrixXd::Ones(2, 2);
  const auto detail = [](const NnlsProblem& problem) {
    const auto solution = solve_nnls(problem);
    return solution.has_value() ? std::string("taken") : solution.error().detail;
  };
  const VectorXd two = VectorXd::Ones(2), three = VectorXd::Ones(3), bad = VectorXd::Constant(2, NAN);
  EXPECT_EQ(detail({ColumnsView(A), two, {}, {}}), "taken");
  EXPECT_EQ(detail({}), "taken");
  EXPECT_EQ(detail({ColumnsView(A), three, {}, {}}), "3 goals for 2 rows");
  EXPECT_EQ(detail({ColumnsView(A), two, three, {}}), "3 weights for 2 rows");
  EXPECT_EQ(detail({ColumnsView(A), two, {}, three}), "3 upper bounds for 2 columns");
  EXPECT_EQ(detail({ColumnsView(A), bad, {}, {}}), "goal 0 is nan");
  EXPECT_EQ(detail({ColumnsView(A), two, -two, {}}), "weight 0 is -1");
  EXPECT_EQ(detail({ColumnsView(A), two, {}, bad}), "upper bound 0 is nan");
  A(1, 0) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(detail({ColumnsView(A), two, {}, {}}), "entry (1, 0) is inf");
  A(1, 0) = 1e141;
  EXPECT_EQ(detail({ColumnsView(A), two, {}, {}}), "entry (1, 0) is 1e+141");
  const std::vector<std::uint64_t> begin = {0, 2};
  const std::vector<float> value = {1, 1};
  const std::vector<std::uint32_t> order = {1, 0}, range = {0, 2};
  EXPECT_EQ(detail({ColumnsView(2, begin, order, std::span<const float>(value)), two, {}, {}}),
            "column 0: row 0 is out of range or order");
  EXPECT_EQ(detail({ColumnsView(2, begin, range, std::span<const float>(value)), two, {}, {}}),
            "column 0: row 2 is out of range or order");
}

TEST(NnlsProperties, StopsWhenAsked) {
  const LeastSquaresCase c = least_squares_case(1, 30, 30);
  std::stop_source source;
  source.request_stop();
  NnlsOptions options;
  options.stop = source.get_token();
  const auto solution = solve_nnls(c.sparse(), options);
  ASSERT_TRUE(solution.has_value());
  EXPECT_FALSE(solution->converged);
  EXPECT_TRUE(solution->x.allFinite());
}

}  // namespace
}  // namespace luxrig
