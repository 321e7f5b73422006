#include "tools/bench/cache/volume/voxel_walk.h"

#include <gtest/gtest.h>

#include <random>

namespace luxrig {
namespace {

/// Length of a segment within a voxel, by clipping at its six faces: independent of any walk.
double length_within(const Eigen::Vector3i& voxel, const Vec3& from, const Vec3& to) {
  double begin = 0, end = 1;
  for (int i = 0; i < 3; ++i) {
    const double way = to[i] - from[i], low = voxel[i], high = voxel[i] + 1;
    if (way == 0) {
      if (from[i] < low || from[i] > high) return 0;
      continue;
    }
    begin = std::max(begin, std::min((low - from[i]) / way, (high - from[i]) / way));
    end = std::min(end, std::max((low - from[i]) / way, (high - from[i]) / way));
  }
  return std::max(0.0, end - begin) * (to - from).norm();
}

struct Segments {
  std::mt19937 random{11};
  Eigen::Vector3i size{13, 9, 11};
  std::pair<Vec3, Vec3> next(int i) {
    std::uniform_real_distribution<double> unit(-0.4, 1.4);
    const auto any = [&]() -> Vec3 {
      return Vec3(unit(random), unit(random), unit(random)).cwiseProduct(size.cast<double>());
    };
    Vec3 from = any(), to = any();
    if (i % 4 == 1) to[i % 3] = from[i % 3];                                // parallel to a plane of the grid
    if (i % 8 == 2) to = from + Vec3::Unit(i % 3) * (i % 2 ? 9.0 : -9.0);   // along an axis
    if (i % 16 == 3) from = from.array().round(), to = to.array().round();  // through corners of voxels
    return {from, to};
  }
};

TEST(VoxelWalk, VisitsExactlyTheVoxelsOfTheSegmentInOrder) {
  Segments segments;
  for (int i = 0; i < 3000; ++i) {
    const auto [from, to] = segments.next(i);
    BitVolume visited(segments.size);
    double last = 0;
    Eigen::Vector3i before(0, 0, 0);
    bool first = true;
    for (VoxelWalk walk(segments.size, from, to); !walk.done(); walk.next()) {
      visited.set(walk.voxel());
      EXPECT_GE(walk.entered_at(), last - 1e-12);
      last = walk.entered_at();
      if (!first) {
        EXPECT_EQ((walk.voxel() - before).cwiseAbs().sum(), 1);
      }
      before = walk.voxel();
      first = false;
    }
    for (int z = 0; z < segments.size.z(); ++z)
      for (int y = 0; y < segments.size.y(); ++y)
        for (int x = 0; x < segments.size.x(); ++x) {
          const Eigen::Vector3i voxel(x, y, z);
          const double length = length_within(voxel, from, to);
          // A segment in a face belongs to both voxels; a walk visits one of them.
          bool in_face = false;
          for (int axis = 0; axis < 3; ++axis)
            in_face = in_face || (from[axis] == to[axis] && from[axis] == std::round(from[axis]));
          if (length > 1e-9 && !in_face) {
            ASSERT_TRUE(visited.test(voxel)) << i << ": " << voxel.transpose();
          }
          if (visited.test(voxel)) {
            const Vec3 wide = Vec3::Constant(1e-9);
            const Vec3 low = voxel.cast<double>() - wide, high = voxel.cast<double>() + Vec3::Ones() + wide;
            Eigen::AlignedBox3d box(low, high);
            double nearest = 1e300;
            for (int k = 0; k <= 2000; ++k)
              nearest = std::min(nearest, box.exteriorDistance(Vec3(from + (to - from) * k / 2000)));
            ASSERT_LT(nearest, (to - from).norm() / 2000) << i << ": " << voxel.transpose();
          }
        }
  }
}

TEST(VoxelWalk, StridesByDistanceFindTheSameVoxelsAsSingleSteps) {
  Segments segments;
  segments.size = {40, 33, 29};
  int hits = 0;
  for (const int set : {3, 40, 600}) {
    BitVolume volume(segments.size);
    std::mt19937 random(12);
    for (int i = 0; i < set; ++i)
      volume.set(static_cast<int>(random() % 40), static_cast<int>(random() % 33), static_cast<int>(random() % 29));
    const DistanceField field(volume);
    for (int i = 0; i < 20000; ++i) {
      if (i % 16 == 3) continue;  // through corners, where either of two voxels is right
      const auto [from, to] = segments.next(i);
      const auto walked = first_voxel_by_walk(volume, from, to), strode = first_voxel_by_distance(field, from, to);
      ASSERT_EQ(walked.has_value(), strode.has_value()) << i;
      if (!walked) continue;
      ++hits;
      EXPECT_EQ(walked->voxel, strode->voxel) << i;
      EXPECT_NEAR(walked->t, strode->t, 1e-9);
    }
  }
  EXPECT_GT(hits, 1000);
}

TEST(VoxelWalk, TheSparseMarchFindsOnlySetVoxelsAndMissesThinOnes) {
  BitVolume volume({64, 64, 64});
  for (int y = 0; y < 64; ++y)
    for (int z = 0; z < 64; ++z) volume.set(30, y, z);  // a wall one voxel thick
  std::mt19937 random(13);
  std::uniform_real_distribution<double> unit(0, 1);
  int found_by_march = 0, found_by_walk = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 from(1 + 20 * unit(random), 63 * unit(random), 63 * unit(random));
    const Vec3 to(40 + 20 * unit(random), 63 * unit(random), 63 * unit(random));
    const auto hit = first_voxel_by_march(volume, from, to, 10, unit(random));
    if (hit) {
      EXPECT_TRUE(volume.test(hit->voxel));
    }
    found_by_march += hit.has_value();
    found_by_walk += first_voxel_by_walk(volume, from, to).has_value();
  }
  EXPECT_EQ(found_by_walk, 4000);
  // Ten samples over about 40 voxels hit a wall one voxel thick one time in four.
  EXPECT_NEAR(found_by_march, 1000, 250);
}

TEST(VoxelWalk, DegenerateSegmentsEndAtOnce) {
  const Eigen::Vector3i size(4, 4, 4);
  int visited = 0;
  for (VoxelWalk walk(size, {1.5, 1.5, 1.5}, {1.5, 1.5, 1.5}); !walk.done(); walk.next()) ++visited;
  EXPECT_EQ(visited, 1);
  EXPECT_TRUE(VoxelWalk(size, {-1, -1, -1}, {-1, -1, -1}).done());
  EXPECT_TRUE(VoxelWalk(size, {9, 9, 9}, {5, 7, 6}).done());
  EXPECT_TRUE(VoxelWalk({0, 0, 0}, {0, 0, 0}, {1, 1, 1}).done());
}

}  // namespace
}  // namespace luxrig
