#include "tools/bench/cache/surface_sides.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/tools/bench/cache/cache_rooms.h"
#include "tests/tools/bench/cache/surface_sides_fixture.h"
#include "tools/bench/cache/volume/voxelise.h"
#include "tools/bench/rooms/lit_room.h"

namespace luxrig {
namespace {

using namespace surface_sides_fixture;

TEST(SurfaceSides, AreasAddUpToBothFacesOfEveryTriangle) {
  for (const Scene& scene : {make_cube(2, 0.5), make_icosphere(1.3, 3, 0.5), two_rooms(0.5), make_box_room().scene}) {
    const RayScene rays(scene);
    const SurfaceSides sides = sides_of(scene, rays, 24);
    double of_sides = 0, of_groups = 0, of_pieces = 0;
    for (std::size_t s = 0; s < sides.sides(); ++s) of_sides += sides.area_of_side_m2(s);
    for (std::size_t g = 0; g < sides.groups(); ++g) of_groups += sides.area_of_group_m2(g);
    for (const SurfacePiece& piece : sides.pieces()) of_pieces += static_cast<double>(piece.area_m2);
    EXPECT_NEAR(of_sides, 2 * area_m2(scene), 1e-5 * of_sides);
    EXPECT_NEAR(of_groups, of_sides, 1e-9 * of_sides);
    EXPECT_NEAR(of_pieces, of_sides, 1e-9 * of_sides);
    EXPECT_LT(sides.groups(), sides.sides());
  }
}

TEST(SurfaceSides, EverySurfacePlaceFindsANearSideFacingItsWay) {
  const Scene scene = make_box_room().scene;
  const RayScene rays(scene);
  const VoxelGrid cells = VoxelGrid::around(triangle_bounds_m(scene), 32);
  const SurfaceSides sides = sides_of(scene, rays, 32);
  std::uint64_t cast = 0;
  std::size_t own = 0;
  for (const SurfacePiece& piece : sides.pieces()) {
    const Vec3 normal = piece.normal_world.cast<double>();
    const std::uint32_t side = sides.side_at(piece.position_world_m, normal, cast);
    ASSERT_NE(side, SurfaceSides::kNone);
    own += side == piece.side;
    bool near = false;
    for (const SurfacePiece& other : sides.pieces_of_side(side))
      near = near || ((other.position_world_m - piece.position_world_m).norm() < 3.5 * cells.voxel_m &&
                      other.normal_world.cast<double>().dot(normal) > 0.4);
    EXPECT_TRUE(near);
  }
  // Small sides that share a cell but joined different neighbours may be confused.
  EXPECT_GT(static_cast<double>(own), 0.97 * static_cast<double>(sides.pieces().size()));
}

TEST(SurfaceSides, AFloorUnderAWallHasASeparateSideInEachRoom) {
  const Scene scene = two_rooms(0.5);
  const RayScene rays(scene);
  for (const int cells : {6, 12, 40}) {
    const SurfaceSides sides = sides_of(scene, rays, cells);
    std::vector<int> rooms_of_group(sides.groups(), 0);
    for (const SurfacePiece& piece : sides.pieces()) {
      const Vec3& p = piece.position_world_m;
      const Vec3 before = p + 0.001 * piece.normal_world.cast<double>();
      const Eigen::AlignedBox3d left(Vec3(0, 0, 0), Vec3(2, 2, 2)), right(Vec3(2.15, 0, 0), Vec3(4.15, 2, 2));
      rooms_of_group[sides.group_of_side(piece.side)] |= left.contains(before) ? 1 : right.contains(before) ? 2 : 0;
    }
    for (const int rooms : rooms_of_group) EXPECT_NE(rooms, 3) << cells << " cells";
  }
}

TEST(SurfaceSides, ZeroAreaTrianglesAreIgnored) {
  Scene scene = make_cube(2, 0.5);
  const std::size_t before = [&] {
    const RayScene rays(scene);
    return sides_of(scene, rays, 12).sides();
  }();
  scene.triangles.push_back({0, 0, 1});
  scene.triangles.push_back({2, 2, 2});
  scene.material_of_triangle.resize(scene.triangles.size(), 0);
  const RayScene rays(scene);
  EXPECT_EQ(sides_of(scene, rays, 12).sides(), before);
  const RayScene nothing{Scene{}};
  const SurfaceSides none = sides_of(Scene{}, nothing, 12);
  std::uint64_t cast = 0;
  EXPECT_EQ(none.sides(), 0u);
  EXPECT_EQ(none.side_at(Vec3::Zero(), Vec3::UnitZ(), cast), SurfaceSides::kNone);
}

TEST(SurfaceSides, FacingsDivideTheSphereEvenlyAndNoAxisSplitsOne) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<int> count(54, 0);
  for (int i = 0; i < 54'000; ++i) {
    const Vec3 d = Vec3(normal(random), normal(random), normal(random)).normalized();
    ASSERT_LT(facing_of(d), 54u);
    ++count[facing_of(d)];
    EXPECT_NE(facing_of(d), facing_of(-d));
  }
  for (const int n : count) {
    EXPECT_GT(n, 400);
    EXPECT_LT(n, 1900);
  }
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 100; ++i) {
      const Vec3 near = (Vec3::Unit(axis) + 1e-3 * Vec3(normal(random), normal(random), normal(random))).normalized();
      EXPECT_EQ(facing_of(near), facing_of(Vec3::Unit(axis)));
    }
}

}  // namespace
}  // namespace luxrig
