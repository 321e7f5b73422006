#include "core/transport/candidates/reflected/weighted_rows.h"

#include <gtest/gtest.h>

#include <random>

#include "core/transport/candidates/error_histogram.h"
#include "core/transport/candidates/reflected/direction_guide.h"
#include "core/transport/sobol.h"

namespace luxrig {
namespace {

TEST(WeightedRows, AddUpLikeRowsOneByOne) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (const std::size_t columns : {0u, 16u, 48u, 64u, 80u, 304u}) {
    const std::size_t count = 37;
    std::vector<float> rows(count * columns);
    for (float& x : rows) x = unit(random);
    std::vector<WeightedRow> list;
    for (int i = 0; i < 100; ++i) list.push_back({static_cast<std::uint32_t>(random() % count), unit(random)});
    std::vector<float> sums(columns, 0.5f);
    add_weighted_rows(rows.data(), list, sums);
    for (std::size_t c = 0; c < columns; ++c) {
      double want = 0.5;
      for (const WeightedRow& entry : list)
        want += static_cast<double>(entry.weight) * static_cast<double>(rows[entry.row * columns + c]);
      EXPECT_NEAR(static_cast<double>(sums[c]), want, 1e-5);
    }
    const std::vector<float> before = sums;
    add_weighted_rows(rows.data(), {}, sums);
    EXPECT_EQ(sums, before);
  }
}

TEST(DirectionGuide, SamplesWithItsStatedDensity) {
  for (const bool filled : {false, true}) {
    DirectionGuide guide;
    if (filled) {
      guide.add(Vec3::UnitX(), 5);
      guide.add(Vec3(0, 0.6, 0.8), 2);
      guide.add(-Vec3::UnitZ(), 1);
      guide.add(Vec3::UnitZ(), std::nan(""));
    }
    EXPECT_EQ(guide.empty(), !filled);
    guide.finish();
    const SobolSequence samples(3);
    // Integrals of 1, of z² and of a cap over the sphere, from drawn directions.
    double one = 0, square = 0, cap = 0;
    const std::uint32_t count = 1 << 16;
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto [u, v] = samples.pair(i, 0, 0);
      const DirectionSample drawn = guide.sample(u, v);
      ASSERT_NEAR(drawn.direction.norm(), 1, 1e-12);
      ASSERT_GT(drawn.density_per_sr, 0);
      one += 1 / drawn.density_per_sr / count;
      square += drawn.direction.z() * drawn.direction.z() / drawn.density_per_sr / count;
      cap += (drawn.direction.x() > 0.9) / drawn.density_per_sr / count;
    }
    EXPECT_NEAR(one, 4 * kPi, 0.02);
    EXPECT_NEAR(square, 4 * kPi / 3, 0.02);
    EXPECT_NEAR(cap, 2 * kPi * 0.1, 0.01);
    EXPECT_TRUE(!filled || guide.density_per_sr(Vec3::UnitX()) > 20 * guide.density_per_sr(-Vec3::UnitX()));
    for (const double u : {0.0, 1.0 - 1e-16})
      for (const double v : {0.0, 1.0 - 1e-16}) EXPECT_TRUE(guide.sample(u, v).direction.allFinite());
  }
}

TEST(ErrorHistogram, GivesTheMedianWithinThreePercent) {
  std::mt19937 random(9);
  std::lognormal_distribution<double> errors(-4, 1.5);
  ErrorHistogram all, part;
  std::vector<double> kept;
  for (int i = 0; i < 4001; ++i) {
    kept.push_back(errors(random));
    (i % 3 == 0 ? part : all).add(kept.back());
  }
  all.add(part);
  std::nth_element(kept.begin(), kept.begin() + 2000, kept.end());
  EXPECT_NEAR(all.median(), kept[2000], 0.03 * kept[2000]);
  ErrorHistogram exact;
  EXPECT_EQ(exact.median(), 0);
  exact.add(0);
  exact.add(1e9);
  EXPECT_EQ(exact.median(), 0);
}

}  // namespace
}  // namespace luxrig
