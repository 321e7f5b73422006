#include "core/transport/candidates/blockers.h"

#include <gtest/gtest.h>

#include <random>

#include "core/transport/candidates/point_tree.h"
#include "tests/core/transport/candidates/box_rooms.h"

namespace luxrig {
namespace {

TEST(Blockers, JoinTheTwoTrianglesOfEachFaceOfABox) {
  Scene scene = two_rooms(0.5, true);
  const Blockers blockers(scene);
  for (std::uint32_t t = 0; t < scene.triangles.size(); t += 2) {
    EXPECT_EQ(blockers.index_of_triangle(t), blockers.index_of_triangle(t + 1));
    EXPECT_EQ(blockers.of_triangle(t).sides, 4u);
  }
}

TEST(Blockers, HiddenPointsAreOccludedAtEveryScaleAndPlace) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vector = [&](double size) { return Vec3(size * Vec3(unit(random), unit(random), unit(random))); };
  for (const double scale_m : {1e-3, 1.0, 1e4}) {
    int hidden = 0;
    for (int trial = 0; trial < 3000; ++trial) {
      Scene scene;
      scene.materials = {{"any", Vec3::Constant(0.5)}};
      scene.object_names = {"scene"};
      // A parallelogram, sometimes degenerate: a sliver or a point.
      const Vec3 corner = vector(scale_m), u = vector(scale_m),
                 v = trial % 10 == 0 ? Vec3(1e-7 * u + vector(1e-6 * scale_m)) : vector(scale_m);
      for (const Vec3& p : {corner, Vec3(corner + u), Vec3(corner + u + v), Vec3(corner + v)})
        scene.vertices_m.push_back(p.cast<float>());
      scene.triangles = {{0, 1, 2}, {0, 2, 3}};
      scene.material_of_triangle = {0, 0};
      scene.object_of_triangle = {0, 0};
      const RayScene rays(scene);
      const Blockers blockers(scene);
      const Vec3 from = vector(scale_m);
      const Vec3 middle = corner + 0.5 * (1 + unit(random)) * u + 0.5 * (1 + unit(random)) * v;
      const Vec3 beyond = from + (1 + std::abs(unit(random))) * (middle - from);
      const Vec3 half = vector(0.2 * scale_m * std::pow(10, 2 * unit(random) - 2)).cwiseAbs();
      const double error_m = std::max(
          {rays.surface_error_m(from), rays.surface_error_m(beyond + half), rays.surface_error_m(beyond - half)});
      const BlockerShadow shadow(blockers.of_triangle(0), from, error_m);
      if (!shadow.hides_box(beyond - half, beyond + half)) continue;
      ++hidden;
      for (int i = 0; i < 20; ++i) {
        Vec3 target = beyond + half.cwiseProduct(vector(1));
        if (i < 8) target = beyond + half.cwiseProduct(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
        ASSERT_TRUE(rays.occluded(from, Vec3::Zero(), target)) << "scale " << scale_m << " trial " << trial;
      }
    }
    EXPECT_GT(hidden, 300);
  }
}

TEST(PointTree, HoldsEachPointOnceInsideItsBoxes) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> coarse(0, 9);
  for (const std::size_t count : {0u, 1u, 8u, 9u, 1000u}) {
    std::vector<Vec3> points_m;  // many coincide
    for (std::size_t i = 0; i < count; ++i) points_m.emplace_back(coarse(random), coarse(random), 0);
    const PointTree tree(points_m);
    std::vector<int> seen(count, 0);
    for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
      const PointTree::Node& node = tree.nodes[n];
      for (std::uint32_t i = node.begin; i < node.end; ++i) {
        const Vec3& p = points_m[tree.order[i]];
        EXPECT_TRUE((p.array() >= node.low_m.array()).all() && (p.array() <= node.high_m.array()).all());
        if (node.right == 0) ++seen[tree.order[i]];
      }
      EXPECT_TRUE(node.right != 0 || node.end - node.begin <= PointTree::kLeafPoints);
    }
    EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int s) { return s == 1; }));
  }
}

}  // namespace
}  // namespace luxrig
