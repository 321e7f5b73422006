#include "core/scene/large_faces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/scene/ray_scene.h"
#include "core/tasks/scene_builder.h"
#include "tests/core/scene/room_on_ground.h"
#include "tests/random.h"

namespace luxrig {
namespace {

double area_m2(const PlacedMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3& at = mesh.vertices_world_m[a];
    sum += (mesh.vertices_world_m[b] - at).cross(mesh.vertices_world_m[c] - at).norm() / 2;
  }
  return sum;
}

double distance_m(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double at = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (a + at * (b - a) - p).norm();
}

/// A closed box whose faces do not share corners, as most exporters write them.
PlacedMesh closed_box(const Vec3& half_m, const Mat3& turn, const Vec3& middle_m) {
  PlacedMesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {-1, 1}) {
      const auto base = static_cast<std::uint32_t>(mesh.vertices_world_m.size());
      for (const auto& [u, v] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
        Vec3 at;
        at[axis] = side, at[(axis + 1) % 3] = u, at[(axis + 2) % 3] = v;
        mesh.vertices_world_m.emplace_back(middle_m + turn * half_m.cwiseProduct(at));
      }
      mesh.triangles.insert(mesh.triangles.end(), {{base, base + 1, base + 2}, {base, base + 2, base + 3}});
    }
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) mesh.material_of_triangle.push_back(t);
  mesh.materials.resize(12);
  return mesh;
}

TEST(LargeFaces, AreCutWithoutGapsOverlapsOrLongEdges) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Vec3 half_m(std::pow(10, random.between(-1, 4)), std::pow(10, random.between(0, 4)), 1e4);
    const Vec3 origin_m = i % 2 ? Vec3(1e6 * random.in_cube()) : Vec3(Vec3::Zero());
    const PlacedMesh whole = closed_box(half_m, random.rotation(), origin_m + half_m.cwiseProduct(random.in_cube()));
    PlacedMesh cut = whole;
    ASSERT_TRUE(cut_large_faces(origin_m, cut));
    ASSERT_GT(cut.triangles.size(), whole.triangles.size());
    ASSERT_LT(cut.triangles.size(), 20'000u);
    ASSERT_EQ(cut.triangles.size(), cut.material_of_triangle.size());
    EXPECT_NEAR(area_m2(cut), area_m2(whole), 1e-9 * area_m2(whole));
    // A closed surface has each edge twice, once in each direction: by the coordinates of its ends, to the last bit.
    std::map<std::array<double, 6>, int> edges;
    for (const auto& triangle : cut.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 &a = cut.vertices_world_m[triangle[k]], &b = cut.vertices_world_m[triangle[(k + 1) % 3]];
        EXPECT_LE((b - a).norm(), std::max(50.0, 0.5 * distance_m(origin_m, a, b) * (1 + 1e-9)));
        const bool forth = std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
        const Vec3 &from = forth ? a : b, &to = forth ? b : a;
        ++edges[{from.x(), from.y(), from.z(), to.x(), to.y(), to.z()}];
      }
    for (const auto& [ends, count] : edges) ASSERT_EQ(count, 2) << i;
  }
}

TEST(LargeFaces, SmallAndFarOnesStayUncut) {
  const PlacedMesh room = closed_box({14, 14, 3}, Mat3::Identity(), {3, 0, 0});
  PlacedMesh cut = room;
  ASSERT_TRUE(cut_large_faces(Vec3::Zero(), cut));
  EXPECT_EQ(cut.triangles, room.triangles);
  const PlacedMesh town = closed_box({300, 300, 100}, Mat3::Identity(), {5000, 0, 0});
  cut = town;
  ASSERT_TRUE(cut_large_faces(Vec3::Zero(), cut));
  EXPECT_EQ(cut.triangles, town.triangles);
}

struct Ground {
  double size_m;
  Vec3 aside_m, at_m;
};

class OnGround : public testing::TestWithParam<Ground> {};
INSTANTIATE_TEST_SUITE_P(OfAnySize, OnGround,
                         testing::Values(Ground{8, {0, 0, 0}, {0, 0, 0}}, Ground{2000, {0, 0, 0}, {0, 0, 0}},
                                         Ground{20'000, {0, 0, 0}, {0, 0, 0}},
                                         Ground{20'000, {3000, -9000, 0}, {0, 0, 0}},
                                         Ground{20'000, {3000, -9000, 0}, {654'321.7, 5'432'101.3, 412.3}}));

TEST_P(OnGround, ASheetAMillimetreBelowALampBlocksItsLight) {
  const auto& [size_m, aside_m, at_m] = GetParam();
  const Rig rig = room_on_ground(size_m, aside_m, at_m, 0.001);
  const auto scene = build_scene(rig);
  ASSERT_TRUE(scene.has_value());
  const RayScene rays(*scene);
  const Vec3 lamp_m = rig.fixtures.front().world_from_mount.translation_m, point_m = rig.points[0].position_world_m;
  EXPECT_LT(rays.surface_error_m(point_m), 1e-4);
  EXPECT_TRUE(rays.occluded(point_m, Vec3::UnitZ(), lamp_m));
  EXPECT_FALSE(rays.occluded(at_m + Vec3(0, 0, 1), Vec3::Zero(), point_m));
  const auto below = rays.nearest(lamp_m, -Vec3::UnitZ(), Vec3::Zero());
  ASSERT_TRUE(below.has_value());
  EXPECT_NEAR(below->distance_m, 0.0009, 1e-5);
}

TEST_P(OnGround, RoomCornersMatchTheRigToAMicrometre) {
  const auto& [size_m, aside_m, at_m] = GetParam();
  const auto scene = build_scene(room_on_ground(size_m, aside_m, at_m, 0.001));
  ASSERT_TRUE(scene.has_value());
  Eigen::AlignedBox3d east;
  for (std::size_t t = 0; t < scene->triangles.size(); ++t)
    if (scene->object_names[scene->object_of_triangle[t]] == "east")
      for (const std::uint32_t vertex : scene->triangles[t]) east.extend(scene->vertex_world_m(vertex));
  EXPECT_LT((east.min() - at_m - Vec3(3, -2.5, 0)).norm(), 1e-6);
  EXPECT_LT((east.max() - at_m - Vec3(3.1, 2.5, 3)).norm(), 1e-6);
}

TEST_P(OnGround, AFarOutlierDoesNotMoveTheOrigin) {
  const auto& [size_m, aside_m, at_m] = GetParam();
  Rig rig = room_on_ground(size_m, aside_m, at_m, 0.001);
  rig.fixtures.insert(rig.fixtures.begin(), 2, rig.fixtures.front());
  rig.fixtures.front().world_from_mount.translation_m += Vec3(4e5, 4e5, 0);
  const auto scene = build_scene(rig);
  ASSERT_TRUE(scene.has_value());
  EXPECT_LT((scene->origin_world_m - at_m).norm(), 10);
}

TEST_P(OnGround, WithoutFixturesTheOriginIsWhereMostCornersAre) {
  const auto& [size_m, aside_m, at_m] = GetParam();
  Rig rig = room_on_ground(size_m, aside_m, at_m, 0.001);
  rig.fixtures.clear();
  rig.points.clear();
  const auto scene = build_scene(rig);
  ASSERT_TRUE(scene.has_value());
  EXPECT_LT((scene->origin_world_m - at_m).norm(), 10);
}

}  // namespace
}  // namespace luxrig
