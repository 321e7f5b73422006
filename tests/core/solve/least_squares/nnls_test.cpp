#include "core/solve/least_squares/nnls.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Case {
  MatrixXd A;
  VectorXd b;
};

/// A random problem of one of eight kinds: plain, non-negative, duplicate, zero or nearly equal columns, low rank,
/// scales from 1e-12 to 1e12, a right-hand side that can be reached exactly.
Case random_case(int seed, Index max_columns) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_int_distribution<Index> rows(1, 30), columns(1, max_columns);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Index m = rows(random), n = columns(random);
  Case c{MatrixXd(m, n), VectorXd(m)};
  for (double& value : c.A.reshaped()) value = normal(random);
  for (double& value : c.b) value = normal(random);
  std::uniform_int_distribution<Index> pick(0, n - 1);
  switch (seed % 8) {
    case 1:
      c.A = c.A.cwiseAbs();
      break;
    case 2:
      c.A = c.A.cwiseAbs();
      for (int k = 0; k < 3; ++k) c.A.col(pick(random)) = c.A.col(pick(random)) * 3.0;
      break;
    case 3:
      c.A.col(pick(random)).setZero();
      c.b = c.b.cwiseAbs();
      break;
    case 4: {
      const Index rank = std::min<Index>({2, m, n});
      c.A = (MatrixXd::Random(m, rank).cwiseAbs() * MatrixXd::Random(rank, n).cwiseAbs()).eval();
      break;
    }
    case 5:
      for (Index j = 0; j < n; ++j) c.A.col(j) *= std::pow(10.0, 12 * uniform(random));
      c.b *= std::pow(10.0, 12 * uniform(random));
      break;
    case 6: {
      c.A = c.A.cwiseAbs();
      const double nearness = std::pow(10.0, -15 * std::abs(uniform(random)));
      for (Index j = 1; j < n; ++j) c.A.col(j) = c.A.col(0) + nearness * c.A.col(j);
      c.b = c.b.cwiseAbs();
      break;
    }
    case 7:
      c.b = c.A * VectorXd::Random(n).cwiseMax(0.0);
      break;
    default:
      break;
  }
  return c;
}

/// KKT as the header states it, computed from scratch in long double.
double kkt_violation(const Case& c, const VectorXd& x) {
  using Long = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const Long A = c.A.cast<long double>();
  const Long r = c.b.cast<long double>() - A * x.cast<long double>();
  const Long w = A.transpose() * r;
  const long double b_norm = c.b.cast<long double>().norm();
  double worst = 0;
  for (Index j = 0; j < x.size(); ++j) {
    const long double norm = A.col(j).norm() * b_norm;
    if (norm == 0) continue;
    const auto relative = static_cast<double>(w(j, 0) / norm);
    worst = std::max(worst, x[j] > 0 ? std::abs(relative) : relative);
  }
  return worst;
}

/// Least residual norm over all sets of columns whose least-squares solution is non-negative.
double enumerated_residual_norm(const Case& c) {
  const Index n = c.A.cols();
  double least = c.b.norm();
  for (unsigned set = 1; set < (1u << n); ++set) {
    std::vector<Index> columns;
    for (Index j = 0; j < n; ++j)
      if (set >> j & 1u) columns.push_back(j);
    // Columns scaled to the same norm, otherwise the reference takes short ones for dependent.
    const MatrixXd part = c.A(Eigen::all, columns).colwise().normalized();
    if (part.cols() > part.rows()) continue;
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(part);
    const VectorXd x = qr.solve(c.b);
    if (x.allFinite() && x.minCoeff() >= 0) least = std::min(least, (part * x - c.b).norm());
  }
  return least;
}

TEST(Nnls, MeetsTheKktConditionsOnAThousandProblemsOfEveryKind) {
  double worst = 0;
  for (int seed = 0; seed < 1000; ++seed) {
    const Case c = random_case(seed, 40);
    const NnlsResult result = solve_nnls(c.A, c.b);
    ASSERT_TRUE(result.x.allFinite()) << "seed " << seed;
    ASSERT_TRUE(result.converged) << "seed " << seed;
    ASSERT_GE(result.x.minCoeff(), 0) << "seed " << seed;
    const double violation = kkt_violation(c, result.x);
    EXPECT_LT(violation, 1e-10) << "seed " << seed;
    EXPECT_LT(result.kkt_residual, 1e-10) << "seed " << seed;
    EXPECT_NEAR(result.residual_norm, (c.A * result.x - c.b).norm(), 1e-10 * c.b.norm()) << "seed " << seed;
    worst = std::max(worst, violation);
  }
  std::printf("worst KKT residual of 1000: %.2e\n", worst);
}

TEST(Nnls, MatchesEnumerationOfAllActiveSets) {
  for (int seed = 0; seed < 400; ++seed) {
    const Case c = random_case(seed, 10);
    const NnlsResult result = solve_nnls(c.A, c.b);
    // Enumeration rounds too: nearly equal columns may make one of its sets slightly negative.
    const double reference = enumerated_residual_norm(c);
    EXPECT_NEAR(result.residual_norm, reference, 1e-9 * c.b.norm()) << "seed " << seed;
  }
}

TEST(Nnls, RecoversUniqueLevels) {
  for (int seed = 0; seed < 200; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    std::uniform_real_distribution<double> uniform;
    MatrixXd A(12, 8);
    for (double& value : A.reshaped()) value = uniform(random);
    VectorXd x(8);
    for (double& value : x) value = std::max(0.0, uniform(random) - 0.3);
    const NnlsResult result = solve_nnls(A, A * x);
    EXPECT_LT((result.x - x).cwiseAbs().maxCoeff(), 1e-9) << "seed " << seed;
  }
}

TEST(Nnls, HandlesEmptyInput) {
  EXPECT_EQ(solve_nnls(MatrixXd(3, 0), VectorXd::Ones(3)).x.size(), 0);
  EXPECT_DOUBLE_EQ(solve_nnls(MatrixXd(3, 0), VectorXd::Ones(3)).residual_norm, std::sqrt(3.0));
  const NnlsResult no_rows = solve_nnls(MatrixXd(0, 4), VectorXd(0));
  EXPECT_EQ(no_rows.x, VectorXd::Zero(4));
  EXPECT_TRUE(no_rows.converged);
  EXPECT_EQ(solve_nnls(MatrixXd::Zero(3, 2), VectorXd::Ones(3)).x, VectorXd::Zero(2));
  EXPECT_EQ(solve_nnls(MatrixXd::Ones(3, 2), VectorXd::Zero(3)).x, VectorXd::Zero(2));
}

TEST(Nnls, StaysFiniteAtTheEndsOfTheRangeOfDouble) {
  MatrixXd A(2, 3);
  A << 1e300, 1e-300, 1, 0, 1e-300, -1;
  for (const double scale : {1e-300, 1.0, 1e300}) {
    const NnlsResult result = solve_nnls(A, VectorXd::Constant(2, scale));
    EXPECT_TRUE(result.x.allFinite());
    EXPECT_GE(result.x.minCoeff(), 0);
    EXPECT_TRUE(std::isfinite(result.residual_norm));
  }
}

TEST(Nnls, DoesNotDependOnUnits) {
  const Case c = random_case(1, 20);
  const NnlsResult one = solve_nnls(c.A, c.b);
  const NnlsResult other = solve_nnls(c.A * 0x1p-30, c.b * 0x1p20);
  EXPECT_EQ(one.x * 0x1p50, other.x);
}

TEST(Nnls, SolvesFiveHundredColumnsInFewSteps) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform;
  Case c{MatrixXd(300, 500), VectorXd(300)};
  for (double& value : c.A.reshaped()) value = uniform(random);
  for (double& value : c.b) value = uniform(random);
  const NnlsResult result = solve_nnls(c.A, c.b);
  EXPECT_TRUE(result.converged);
  EXPECT_LT(kkt_violation(c, result.x), 1e-10);
  EXPECT_LT(result.iterations, 1000);
}

TEST(NnlsDeathTest, RefusesNonFiniteInput) {
  EXPECT_DEATH((void)solve_nnls(MatrixXd::Constant(1, 1, NAN), VectorXd::Ones(1)), "finite");
  EXPECT_DEATH((void)solve_nnls(MatrixXd::Ones(1, 1), VectorXd::Ones(2)), "rows");
}

}  // namespace
}  // namespace luxrig
