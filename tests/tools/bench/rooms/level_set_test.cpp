#include "tools/bench/rooms/level_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tools/bench/rooms/solid_model.h"

namespace luxrig {
namespace {

double volume_of(const ClosedMesh& mesh) {
  double six_m3 = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    six_m3 += mesh.vertices_m[a].dot(mesh.vertices_m[b].cross(mesh.vertices_m[c]));
  return six_m3 / 6;
}

/// Every edge appears equally often in both directions.
bool is_closed(const ClosedMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> walked;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (a == b) return false;
      walked[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  return !mesh.triangles.empty() &&
         std::all_of(walked.begin(), walked.end(), [](const auto& edge) { return edge.second == 0; });
}

Eigen::AlignedBox3d box_of(double half_m) { return {Vec3::Constant(-half_m), Vec3::Constant(half_m)}; }

TEST(LevelSet, OfABallHasItsVolumeToSecondOrderAndFacesOutward) {
  double errors[2] = {};
  for (const int halving : {0, 1}) {
    const double cell_m = 0.2 / (1 + halving);
    const ClosedMesh ball = mesh_level_set(box_of(1.3), cell_m, [](const Vec3& p) { return p.norm() - 1; });
    EXPECT_TRUE(is_closed(ball));
    const double exact_m3 = 4 * kPi / 3;
    errors[halving] = std::abs(volume_of(ball) / exact_m3 - 1);  // positive: outward
    // A vertex is the mean of points of the ball that share a cell: at most the sagitta of the cell's diagonal below
    // the surface.
    for (const Vec3& v : ball.vertices_m) EXPECT_NEAR(v.norm(), 1, 3 * cell_m * cell_m / 8 + 1e-3);
  }
  EXPECT_LT(errors[0], 0.05);
  EXPECT_LT(errors[1], 0.35 * errors[0]);
}

TEST(LevelSet, IsFlatWhereAPlaneCutsABall) {
  const ClosedMesh dome =
      mesh_level_set(box_of(1.3), 0.1, [](const Vec3& p) { return std::max(p.norm() - 1, 0.05 - p.z()); });
  EXPECT_TRUE(is_closed(dome));
  int flat = 0;
  for (const Vec3& v : dome.vertices_m)
    if (v.head<2>().norm() < 0.8 && v.z() < 0.3) {
      EXPECT_NEAR(v.z(), 0.05, 1e-12);
      ++flat;
    }
  EXPECT_GT(flat, 150);
}

TEST(LevelSet, IsClosedAtTheBoxAndWithZerosOnTheGrid) {
  EXPECT_TRUE(is_closed(mesh_level_set(box_of(1), 0.25, [](const Vec3&) { return -1.0; })));
  EXPECT_TRUE(is_closed(mesh_level_set(box_of(1), 0.25, [](const Vec3& p) { return p.cwiseAbs().maxCoeff() - 0.5; })));
  // A chessboard of cubes: up to four of them meet at each edge of the grid.
  EXPECT_TRUE(is_closed(mesh_level_set(box_of(1), 0.25, [](const Vec3& p) {
    return static_cast<int>(std::floor(4 * p.x()) + std::floor(4 * p.y()) + std::floor(4 * p.z())) % 2 == 0 ? 0.1
                                                                                                            : -0.1;
  })));
  EXPECT_TRUE(mesh_level_set(box_of(1), 0.25, [](const Vec3&) { return 1.0; }).triangles.empty());
}

TEST(LevelSet, DistancesMatchGeometry) {
  const Vec3 a(0, 0, 0), b(2, 0, 0);
  EXPECT_DOUBLE_EQ(distance_to_segment_m({1, 3, 4}, a, b), 5);
  EXPECT_DOUBLE_EQ(distance_to_segment_m({-3, 4, 0}, a, b), 5);
  EXPECT_DOUBLE_EQ(distance_to_segment_m({5, 0, 4}, a, b), 5);
  EXPECT_DOUBLE_EQ(distance_to_segment_m({0, 0, 2}, a, a), 2);
  EXPECT_DOUBLE_EQ(blended_least_m(1, 5, 0.5), 1);
  EXPECT_DOUBLE_EQ(blended_least_m(1, 1, 0.4), 0.9);
}

TEST(SolidModel, ArchHasTheVolumeOfItsBlockWithoutTheOpening) {
  constexpr int kSegments = 48;
  for (const bool along_x : {true, false}) {
    SolidModel model;
    const auto stone = model.material("stone", Vec3::Constant(0.5));
    model.begin_object("arch");
    const Vec3 high = along_x ? Vec3(3, 0.4, 2) : Vec3(0.4, 3, 2);
    model.arch(Vec3::Zero(), high, 0.25, kSegments, stone);
    ClosedMesh mesh;
    const Scene scene = model.scene();
    for (const Vec3f& v : scene.vertices_m) mesh.vertices_m.push_back(v.cast<double>());
    mesh.triangles = scene.triangles;
    EXPECT_TRUE(is_closed(mesh));
    // Half of an inscribed regular polygon of twice as many sides.
    const double radius_m = 1.25, opening_m2 = radius_m * radius_m / 2 * kSegments * std::sin(kPi / kSegments);
    EXPECT_NEAR(volume_of(mesh), 0.4 * (3 * 2 - opening_m2), 1e-5);
    EXPECT_FALSE(model.occupied(along_x ? Vec3(1.5, 0.2, 0.9) : Vec3(0.2, 1.5, 0.9), 0));
    EXPECT_TRUE(model.occupied(along_x ? Vec3(1.5, 0.2, 1.6) : Vec3(0.2, 1.5, 1.6), 0));
  }
}

TEST(SolidModel, AHollowBlockFacesIntoItsCavity) {
  SolidModel model;
  const auto rock = model.material("rock", Vec3::Constant(0.3));
  model.begin_object("cave");
  const ClosedMesh ball = mesh_level_set(box_of(1.3), 0.1, [](const Vec3& p) { return p.norm() - 1; });
  model.hollow_block(Vec3::Constant(-2), Vec3::Constant(2), ball, rock);
  ClosedMesh mesh;
  const Scene scene = model.scene();
  for (const Vec3f& v : scene.vertices_m) mesh.vertices_m.push_back(v.cast<double>());
  mesh.triangles = scene.triangles;
  EXPECT_TRUE(is_closed(mesh));
  EXPECT_NEAR(volume_of(mesh), 64 - volume_of(ball), 1e-4);
}

}  // namespace
}  // namespace luxrig
