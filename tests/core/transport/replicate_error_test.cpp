#include "core/transport/replicate_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/transport/evaluator.h"

namespace luxrig {
namespace {

TEST(ReplicateError, StudentQuantilesMatchTheTables) {
  EXPECT_NEAR(student_t_975(3), 3.182, 0.032);
  EXPECT_NEAR(student_t_975(7), 2.365, 0.002);
  EXPECT_NEAR(student_t_975(15), 2.1314, 0.0005);
  EXPECT_NEAR(student_t_975(31), 2.0395, 0.0005);
  EXPECT_NEAR(student_t_975(1e9), 1.95996, 1e-5);
}

TEST(ReplicateError, TwoErrorsCoverNinetyFivePercentOfNormalMeans) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(3, 2);
  int covered = 0;
  constexpr int kTrials = 20000;
  for (int t = 0; t < kTrials; ++t) {
    std::vector<double> x(16);
    double mean = 0;
    for (double& v : x) mean += (v = normal(random)) / 16;
    covered += std::abs(mean - 3) < 1.959964 * standard_error_of_mean(x);
  }
  // Binomial: 0.95 ± 4·0.0015.
  EXPECT_NEAR(covered / static_cast<double>(kTrials), 0.95, 0.0062);
}

TEST(ReplicateError, OfTheMatrixKeepsTheCorrelationBetweenColumns) {
  TransportMatrix matrix;
  matrix.lux_per_level = Eigen::MatrixXd::Constant(1, 2, 10);
  for (int k = 0; k < 16; ++k) {  // one column gains as much as the other loses
    const double d = k % 2 ? 1 : -1;
    matrix.replicates.push_back((Eigen::MatrixXd(1, 2) << 10 + d, 10 - d).finished());
  }
  EXPECT_NEAR(matrix.standard_error_lux(Eigen::Vector2d(1, 1))[0], 0, 1e-12);
  const double plain = std::sqrt(16.0 / (16 * 15));
  EXPECT_NEAR(matrix.standard_error_lux(Eigen::Vector2d(1, 0))[0], plain * 2.1314 / 1.95996, 1e-4);
  EXPECT_NEAR(matrix.standard_error_lux(Eigen::Vector2d(2, 0))[0], 2 * plain * 2.1314 / 1.95996, 1e-4);
  matrix.replicates.clear();
  EXPECT_EQ(matrix.standard_error_lux(Eigen::Vector2d(1, 1))[0], 0);
}

}  // namespace
}  // namespace luxrig
