#include "core/transport/paths/record_bias.h"

#include <gtest/gtest.h>

#include <random>

namespace luxrig {
namespace {

TEST(RecordBias, IsUnknownUntilEveryReplicateFoundLight) {
  RecordBias bias;
  EXPECT_FALSE(bias.measured());
  for (std::size_t k = 0; k + 1 < RecordBias::kReplicates; ++k) bias.add(k, 1.1, 1);
  EXPECT_FALSE(bias.believed());
  bias.add(RecordBias::kReplicates - 1, 1.1, 1);
  ASSERT_TRUE(bias.measured());
  EXPECT_NEAR(bias.measured()->mean, 0.1, 1e-12);
  EXPECT_NEAR(bias.believed()->mean, 0.1, 1e-9) << "certain: all replicates say the same";
}

TEST(RecordBias, BelievedErrsLessThanMeasuredAndAsStated) {
  // The records' error is about 0.01, the error of a check about 0.03. Over many trials the believed bias must be
  // closer than the measured one, and its stated error must be right.
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  double measured2 = 0, believed2 = 0, stated2 = 0;
  constexpr int kTrials = 2000;
  for (int trial = 0; trial < kTrials; ++trial) {
    const double truth = 0.01 * normal(random);
    RecordBias bias;
    for (std::size_t k = 0; k < RecordBias::kReplicates; ++k) bias.add(k, 1 + truth + 0.12 * normal(random), 1);
    measured2 += std::pow(bias.measured()->mean - truth, 2) / kTrials;
    believed2 += std::pow(bias.believed()->mean - truth, 2) / kTrials;
    stated2 += std::pow(bias.believed()->error, 2) / kTrials;
  }
  EXPECT_LT(believed2, 0.2 * measured2);
  EXPECT_NEAR(stated2 / believed2, 1, 0.15);  // noise of 1/√2000, and Student's factor of 1.06 on the measured part
}

}  // namespace
}  // namespace luxrig
