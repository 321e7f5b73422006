#include "core/transport/sobol.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace luxrig {
namespace {

// First points of the sequence in Joe and Kuo's order of dimensions, without Gray code. Worked by hand from the
// direction numbers v = m/2^k.
TEST(Sobol, StartsWithTheKnownPoints) {
  const double expected[4][4] = {
      {0, 0, 0, 0}, {0.5, 0.5, 0.5, 0.5}, {0.25, 0.75, 0.75, 0.75}, {0.75, 0.25, 0.25, 0.25}};
  for (std::uint32_t i = 0; i < 4; ++i)
    for (std::uint32_t d = 0; d < 4; ++d) EXPECT_EQ(sobol_bits(i, d) * 0x1p-32, expected[i][d]) << i << " " << d;
  // By the recurrence: m₃ = 2m₂ ^ m₂ = 5; 2·3 ^ 4·1 ^ 1 = 3; 1 as tabulated.
  const double fourth[4] = {0.125, 0.625, 0.375, 0.125};
  for (std::uint32_t d = 0; d < 4; ++d) EXPECT_EQ(sobol_bits(4, d) * 0x1p-32, fourth[d]) << d;
}

/// Each box of side 2^-a × 2^-(m-a) must hold exactly one of 2^m points.
template <class PointOf>
void expect_elementary_intervals(int m, const PointOf& point_of) {
  for (int a = 0; a <= m; ++a) {
    std::set<std::pair<int, int>> boxes;
    for (std::uint32_t i = 0; i < (1u << m); ++i) {
      const auto p = point_of(i);
      ASSERT_GE(p[0], 0);
      ASSERT_LT(p[0], 1);
      boxes.insert({static_cast<int>(std::ldexp(p[0], a)), static_cast<int>(std::ldexp(p[1], m - a))});
    }
    EXPECT_EQ(boxes.size(), 1u << m) << "boxes of 2^-" << a << " by 2^-" << m - a;
  }
}

TEST(Sobol, ScrambledFirstPairFillsEveryElementaryInterval) {
  for (const std::uint64_t key : {1u, 2u, 99u})
    for (std::uint32_t set = 0; set < 5; ++set)
      for (int m = 1; m <= 9; ++m)
        expect_elementary_intervals(m, [&](std::uint32_t i) { return SobolSequence(key).pair(i, set, 0); });
}

TEST(Sobol, EveryCoordinateIsStratified) {
  for (std::uint32_t d = 0; d < 4; ++d) {
    std::set<int> cells;
    for (std::uint32_t i = 0; i < 256; ++i) cells.insert(static_cast<int>(SobolSequence(7).set(i, 3)[d] * 256));
    EXPECT_EQ(cells.size(), 256u) << "dimension " << d;
  }
}

TEST(Sobol, APairIsTheSameAloneAndWithinItsSet) {
  const SobolSequence s(5);
  for (std::uint32_t i = 0; i < 100; ++i) {
    const auto all = s.set(i, 2);
    EXPECT_EQ(all[0], s.pair(i, 2, 0)[0]);
    EXPECT_EQ(all[3], s.pair(i, 2, 1)[1]);
  }
}

// Unbiased: the mean over keys of small-sample means is the integral. 4000 keys × 4 points of f = x²y on pairs of
// different sets. The mean must lie within 4 of its standard errors, from the measured standard deviation of one mean.
TEST(Sobol, ScramblesAreUnbiasedAndSetsAreIndependent) {
  const auto check = [](const auto& f, double truth) {
    double sum = 0, squares = 0;
    const int keys = 4000;
    for (int key = 0; key < keys; ++key) {
      const SobolSequence s(mixed(1, key));
      double mean = 0;
      for (std::uint32_t i = 0; i < 4; ++i) mean += f(s, i) / 4;
      sum += mean;
      squares += mean * mean;
    }
    const double mean = sum / keys, error = std::sqrt((squares / keys - mean * mean) / keys);
    EXPECT_LT(std::abs(mean - truth), 4 * error + 1e-12);
  };
  check([](const SobolSequence& s, std::uint32_t i) { return s.pair(i, 0, 0)[0]; }, 0.5);
  check(
      [](const SobolSequence& s, std::uint32_t i) {
        const auto p = s.pair(i, 0, 0);
        return p[0] * p[0] * p[1];
      },
      1.0 / 6);
  check([](const SobolSequence& s, std::uint32_t i) { return s.pair(i, 0, 0)[0] * s.pair(i, 1, 0)[0]; }, 0.25);
  check([](const SobolSequence& s, std::uint32_t i) { return s.pair(i, 0, 1)[1] * s.pair(i, 7, 0)[0]; }, 0.25);
  check([](const SobolSequence& s, std::uint32_t i) { return s.pair(i, 0, 0)[1] * s.pair(i, 0, 1)[0]; }, 0.25);
}

TEST(Sobol, ErrorOfASmoothIntegralFallsFasterThanWithRandomPoints) {
  const auto error_with = [](std::uint32_t n) {
    double squares = 0;
    for (int key = 0; key < 64; ++key) {
      const SobolSequence s(mixed(3, key));
      double mean = 0;
      for (std::uint32_t i = 0; i < n; ++i) {
        const auto p = s.pair(i, 0, 0);
        mean += std::sin(3 * p[0]) * std::exp(p[1]) / n;
      }
      const double truth = (1 - std::cos(3.0)) / 3 * (std::exp(1.0) - 1);
      squares += (mean - truth) * (mean - truth) / 64;
    }
    return std::sqrt(squares);
  };
  // With 64 times the samples, random points gain a factor of 8; a scrambled net of a smooth function about 64^1.5.
  EXPECT_LT(error_with(4096), error_with(64) / 100);
}

}  // namespace
}  // namespace luxrig
