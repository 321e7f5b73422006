#include "tools/bench/cache/volume/bit_volume.h"

#include <gtest/gtest.h>

#include <random>

#include "tools/bench/cache/volume/distance_field.h"

namespace luxrig {
namespace {

BitVolume random_volume(const Eigen::Vector3i& size, double share, unsigned seed) {
  BitVolume volume(size);
  std::mt19937 random(seed);
  std::bernoulli_distribution set(share);
  for (int z = 0; z < size.z(); ++z)
    for (int y = 0; y < size.y(); ++y)
      for (int x = 0; x < size.x(); ++x)
        if (set(random)) volume.set(x, y, z);
  return volume;
}

const Eigen::Vector3i kVolumeSizes[] = {{130, 7, 5}, {64, 9, 3}, {1, 1, 1}, {63, 2, 11}, {65, 6, 6}};

TEST(BitVolume, VisitsAndCountsExactlyTheSetVoxels) {
  for (const auto& size : kVolumeSizes) {
    const BitVolume volume = random_volume(size, 0.2, 1);
    BitVolume copy(size);
    std::size_t n = 0;
    volume.for_each([&](const Eigen::Vector3i& v) {
      copy.set(v);
      ++n;
    });
    EXPECT_EQ(copy, volume);
    EXPECT_EQ(n, volume.count());
  }
}

TEST(BitVolume, DilationSetsOnlyNeighbours) {
  for (const auto& size : kVolumeSizes) {
    const BitVolume volume = random_volume(size, 0.03, 2), dilated = volume.dilated();
    std::size_t n = 0;
    for (int z = 0; z < size.z(); ++z)
      for (int y = 0; y < size.y(); ++y)
        for (int x = 0; x < size.x(); ++x) {
          bool near = false;
          volume.for_each([&](const Eigen::Vector3i& v) {
            near = near || (v - Eigen::Vector3i(x, y, z)).cwiseAbs().maxCoeff() <= 1;
          });
          ASSERT_EQ(dilated.test(x, y, z), near) << x << " " << y << " " << z;
          n += near;
        }
    EXPECT_EQ(dilated.count(), n) << "bits past the rows' ends";
  }
}

TEST(BitVolume, ReductionIsTheOrOfEachBlock) {
  for (const auto& size : kVolumeSizes) {
    const BitVolume volume = random_volume(size, 0.02, 3), cells = volume.reduced(4);
    EXPECT_EQ(cells.size(), Eigen::Vector3i((size.array() + 3) / 4));
    BitVolume expected(cells.size());
    volume.for_each([&](const Eigen::Vector3i& v) { expected.set(v.x() / 4, v.y() / 4, v.z() / 4); });
    EXPECT_EQ(cells, expected);
  }
}

TEST(DistanceField, MatchesTheChessboardDistanceByBruteForce) {
  for (const auto& size : {Eigen::Vector3i(20, 17, 9), Eigen::Vector3i(70, 3, 4), Eigen::Vector3i(1, 1, 1)}) {
    for (const double share : {0.002, 0.05}) {
      BitVolume volume = random_volume(size, share, 4);
      volume.set(0, 0, 0);
      const DistanceField field(volume);
      for (int z = 0; z < size.z(); ++z)
        for (int y = 0; y < size.y(); ++y)
          for (int x = 0; x < size.x(); ++x) {
            int least = DistanceField::kFarthest;
            volume.for_each([&](const Eigen::Vector3i& v) {
              least = std::min(least, (v - Eigen::Vector3i(x, y, z)).cwiseAbs().maxCoeff());
            });
            ASSERT_EQ(field.at({x, y, z}), least);
          }
    }
  }
}

TEST(DistanceField, SaturatesAtItsMaximumDistance) {
  EXPECT_EQ(DistanceField(BitVolume({5, 4, 3})).at({2, 2, 2}), DistanceField::kFarthest);
  BitVolume corridor({600, 1, 1});
  corridor.set(0, 0, 0);
  const DistanceField field(corridor);
  EXPECT_EQ(field.at({200, 0, 0}), 200);
  EXPECT_EQ(field.at({599, 0, 0}), DistanceField::kFarthest);
}

}  // namespace
}  // namespace luxrig
