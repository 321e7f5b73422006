#include "tools/bench/loop/lamp_groups.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <bit>
#include <cmath>
#include <random>

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Lamps over a floor with a few meters, or lamps and meters at random; noise of either kind; limits in some.
LampDesignProblem random_problem(std::uint64_t seed, Index lamps, Index meters) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit;
  LampDesignProblem problem;
  const double reach = 0.2 + 1.5 * unit(random), reflected = 0.05 * unit(random);
  problem.lux.resize(meters, lamps);
  problem.goals.resize(lamps, lamps);
  std::vector<std::pair<double, double>> at(static_cast<std::size_t>(lamps + meters));
  for (auto& [x, y] : at) x = 4 * unit(random), y = 4 * unit(random);
  const auto light = [&](Index from, Index to) {
    const auto& [x, y] = at[static_cast<std::size_t>(from)];
    const auto& [u, v] = at[static_cast<std::size_t>(to)];
    return 200 * (std::exp(-((x - u) * (x - u) + (y - v) * (y - v)) / (2 * reach * reach)) + reflected);
  };
  for (Index j = 0; j < lamps; ++j) {
    for (Index m = 0; m < meters; ++m) problem.lux(m, j) = light(j, lamps + m);
    for (Index p = 0; p < lamps; ++p) problem.goals(p, j) = light(j, p);
  }
  for (Index p = 0; p < lamps; ++p) problem.goals.row(p) /= problem.goals.row(p).sum();
  problem.log_sd = VectorXd::Constant(lamps, 0.15);
  problem.noise_share = seed % 3 == 0 ? 0 : 0.03 * unit(random);
  problem.noise_lx = seed % 3 == 1 ? 0.02 : 0.02 + 5 * unit(random);
  problem.rest_share = 0.03 * unit(random);
  if (seed % 4 == 0) {
    problem.of_limit.resize(1, lamps);
    for (Index j = 0; j < lamps; ++j) problem.of_limit(0, j) = 0.6 * unit(random);
  }
  return problem;
}

TEST(LampGroups, InEachOf200RigsTheyTellAtLeastAsMuchAsOneLampAtATimeAndAsHadamard) {
  double log_over_alone = 0, log_over_hadamard = 0;
  int hadamard_counts = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Index lamps = 4 + static_cast<Index>(seed % 8), meters = 1 + static_cast<Index>(seed % 4);
    const LampDesignProblem problem = random_problem(seed, lamps, meters);
    const auto count = static_cast<std::size_t>(lamps);
    const std::size_t steps = std::bit_ceil(count + 1) - 1;
    const double alone = error_after(problem, one_at_a_time(count, steps));
    const double coded = error_after(problem, hadamard_steps(count, steps));
    const LampDesign best = best_design(problem, steps);
    const double chosen = error_after(problem, best);
    EXPECT_EQ(best.size(), steps);
    EXPECT_LE(chosen, std::min(alone, coded) * (1 + 1e-9)) << seed;
    log_over_alone += std::log(chosen / alone) / 200;
    if (!std::isfinite(coded)) continue;
    log_over_hadamard += std::log(chosen / coded);
    ++hadamard_counts;
  }
  EXPECT_LT(log_over_alone, std::log(0.8));
  EXPECT_LT(log_over_hadamard / hadamard_counts, std::log(0.8));
  RecordProperty("variance_over_one_at_a_time", std::to_string(std::exp(log_over_alone)));
  RecordProperty("variance_over_hadamard", std::to_string(std::exp(log_over_hadamard / hadamard_counts)));
}

TEST(LampGroups, TheErrorIsThatOfSimulatedReadings) {
  for (const std::uint64_t seed : {2u, 5u, 9u}) {
    LampDesignProblem problem = random_problem(seed, 6, 3);
    problem.noise_share = 0.02;
    problem.rest_share = 0;  // the rest is drawn for each reading anew, so it would be noise here
    const LampDesign design = best_design(problem, 7);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    double sum = 0;
    constexpr int kTimes = 4000;
    for (int k = 0; k < kTimes; ++k) {
      VectorXd x(6);
      for (Index j = 0; j < 6; ++j) x[j] = problem.log_sd[j] * normal(random);
      MatrixXd normal_matrix = problem.log_sd.cwiseAbs2().cwiseInverse().asDiagonal();
      VectorXd right = VectorXd::Zero(6);
      for (const auto& lit : design)
        for (Index m = 0; m < 3; ++m) {
          VectorXd row = VectorXd::Zero(6);
          for (const std::size_t lamp : lit) row[static_cast<Index>(lamp)] = problem.lux(m, static_cast<Index>(lamp));
          const double sd = std::hypot(problem.noise_share * row.sum(), problem.noise_lx);
          const double off_lx = row.dot(x) + sd * normal(random);
          normal_matrix += row * row.transpose() / (sd * sd);
          right += row * off_lx / (sd * sd);
        }
      const VectorXd found = normal_matrix.inverse() * right;
      sum += (problem.goals * (found - x)).squaredNorm() / kTimes;
    }
    const double stated = error_after(problem, design);
    EXPECT_NEAR(sum, stated, 0.1 * stated) << seed;
  }
}

TEST(LampGroups, LampsThatDifferentMetersSeeGoTogether) {
  LampDesignProblem problem;
  problem.lux = MatrixXd::Constant(3, 12, 0.1);
  for (Index j = 0; j < 12; ++j) problem.lux(j / 4, j) = 100;
  problem.log_sd = VectorXd::Constant(12, 0.15);
  problem.noise_share = 0.02;
  problem.noise_lx = 0.02;
  problem.goals = MatrixXd::Identity(12, 12);
  const LampDesign packed = packed_by_meters(problem, 4);
  ASSERT_EQ(packed.size(), 4u);
  for (const auto& lit : packed) EXPECT_EQ(lit.size(), 3u);
  // In a third of the steps, all is as well known as one at a time.
  const double alone = error_after(problem, one_at_a_time(12, 12));
  EXPECT_LT(error_after(problem, best_design(problem, 4)), 1.05 * alone);
}

TEST(LampGroups, FiftyLampsUnderSixMetersTakeFifteenSteps) {
  constexpr Index kLamps = 50, kMeters = 6;
  LampDesignProblem problem;
  problem.lux.resize(kMeters, kLamps);
  for (Index j = 0; j < kLamps; ++j)
    for (Index m = 0; m < kMeters; ++m) {
      const double x = 2.0 * static_cast<double>(j % 10) + 1 - (3.3 + 6.7 * static_cast<double>(m % 3));
      const double y = 2.0 * static_cast<double>(j / 10) + 1 - (2.5 + 5.0 * static_cast<double>(m / 3));
      problem.lux(m, j) = 300 * (std::exp(-(x * x + y * y) / (2 * 2.5 * 2.5)) + 0.01);
    }
  problem.log_sd = VectorXd::Constant(kLamps, 0.15);
  problem.noise_share = 0.02 / std::sqrt(3.0);
  problem.noise_lx = 0.02;
  problem.rest_share = 0.005;
  problem.goals = MatrixXd::Identity(kLamps, kLamps);
  const auto rms = [&](const LampDesign& design) { return std::sqrt(error_after(problem, design) / kLamps); };
  EXPECT_LT(rms(best_design(problem, 15)), 0.015);
  EXPECT_GT(rms(one_at_a_time(kLamps, 15)), 0.1);
  EXPECT_GT(rms(hadamard_steps(kLamps, 15)), 0.03);
}

TEST(LampGroups, CodingHelpsOnlyWhereNoiseDoesNotDependOnTheLight) {
  LampDesignProblem problem;
  problem.lux = MatrixXd::Constant(1, 7, 100);
  problem.log_sd = VectorXd::Constant(7, 10);
  problem.goals = MatrixXd::Identity(7, 7);
  problem.noise_lx = 1;
  // The S-matrix of order 7: variance 4·7/(7 + 1)² of one at a time.
  const double alone = error_after(problem, one_at_a_time(7, 7));
  EXPECT_NEAR(error_after(problem, hadamard_steps(7, 7)) / alone, 28.0 / 64, 1e-3);
  problem.noise_share = 0.02;
  problem.noise_lx = 1e-3;
  EXPECT_GT(error_after(problem, hadamard_steps(7, 7)), 4 * error_after(problem, one_at_a_time(7, 7)));
}

TEST(LampGroups, NoStepExceedsALimit) {
  for (std::uint64_t seed = 4; seed <= 40; seed += 4) {
    const LampDesignProblem problem = random_problem(seed, 8, 2);
    for (const auto& lit : best_design(problem, 9)) {
      double sum = 0;
      for (const std::size_t lamp : lit) sum += problem.of_limit(0, static_cast<Index>(lamp));
      EXPECT_LE(sum, 1 + 1e-9);
    }
  }
}

}  // namespace
}  // namespace luxrig
