/// Joining the columns of two matrices, with errors that follow from both.

#include <gtest/gtest.h>

#include "core/transport/evaluator.h"
#include "core/transport/replicate_error.h"

namespace luxrig {
namespace {

/// A column of 10 lx and 100 lx, with replicates `off` above and below.
TransportMatrix column(double off) {
  TransportMatrix matrix;
  matrix.lux_per_level = Eigen::MatrixXd{{10}, {100}};
  matrix.direct_lux_per_level = 0.5 * matrix.lux_per_level;
  for (int k = 0; off > 0 && k < 16; ++k)
    matrix.replicates.emplace_back(matrix.lux_per_level.array() + (k % 2 == 0 ? off : -off));
  return matrix;
}

/// Error of the mean of 16 values that lie `off` above and below it.
double error_of(double off) {
  std::vector<double> values;
  for (int k = 0; k < 16; ++k) values.push_back(k % 2 == 0 ? off : -off);
  return standard_error_of_mean(values);
}

TEST(JoinedColumns, KeepTheirOrderAndTheErrorOfTheirSum) {
  const TransportMatrix known = column(1), anew = column(2);
  EvaluateOptions options;
  options.levels = {1, 0.5};
  const TransportMatrix both =
      joined_columns(known, anew, std::vector<std::optional<std::size_t>>{std::nullopt, 0}, options);
  ASSERT_EQ(both.replicates.size(), 16u);
  EXPECT_EQ(both.replicates[0].col(0), anew.replicates[0].col(0));
  EXPECT_EQ(both.replicates[0].col(1), known.replicates[0].col(0));
  EXPECT_EQ(both.direct_lux_per_level, (Eigen::MatrixXd{{5, 5}, {50, 50}}));
  // 15 lx and 150 lx, both off by 2.5 lx in step.
  EXPECT_NEAR(both.relative_error, error_of(2.5) / 15, 1e-12);
  EXPECT_NEAR(both.rms_error, std::sqrt((1.0 / (15 * 15) + 1.0 / (150 * 150)) / 2) * error_of(2.5), 1e-12);
}

TEST(JoinedColumns, AnExactColumnAddsNoError) {
  const TransportMatrix exact = column(0), sampled = column(3);
  const std::vector<std::optional<std::size_t>> kept = {0, std::nullopt};
  const TransportMatrix both = joined_columns(exact, sampled, kept, {});
  EXPECT_NEAR(both.relative_error, error_of(3) / 20, 1e-12);
  const TransportMatrix none = joined_columns(exact, exact, kept, {});
  EXPECT_TRUE(none.replicates.empty());
  EXPECT_EQ(none.relative_error, 0);
}

TEST(JoinedColumns, DarkReceiversHaveNoRelativeError) {
  TransportMatrix dark = column(1);
  for (auto& replicate : dark.replicates) replicate.setZero();
  dark.lux_per_level.setZero();
  const TransportMatrix both = joined_columns(dark, dark, std::vector<std::optional<std::size_t>>{0, std::nullopt}, {});
  EXPECT_EQ(both.relative_error, 0);
  EXPECT_EQ(both.rms_error, 0);
}

TEST(MeanOf, TwoEstimatesCombinesTheirErrorsByShare) {
  const TransportMatrix both = mean_of(column(1), 0.25, column(2), {});
  EXPECT_EQ(both.lux_per_level, column(1).lux_per_level);
  EXPECT_NEAR(both.relative_error, error_of(0.25 * 1 + 0.75 * 2) / 10, 1e-12);
  EXPECT_EQ(mean_of(column(0), 0.5, column(0), {}).relative_error, 0) << "exact stays exact";
}

}  // namespace
}  // namespace luxrig
