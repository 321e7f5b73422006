#include "core/goals/surface_patches.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/goals/dicing.h"
#include "core/goals/triangle_cut.h"
#include "tests/core/goals/built_scene.h"

namespace luxrig {
namespace {

SurfacePatches patches_of(const Scene& scene, double cell_m, int threads = 1) {
  auto surface = make_surface_patches(scene, RayScene(scene), {cell_m, threads});
  EXPECT_TRUE(surface) << surface.error().detail;
  return std::move(*surface);
}

std::uint32_t group_at(const SurfacePatches& surface, const RayScene& rays, const Vec3& position, const Vec3& normal) {
  const auto patch = patch_at(surface, rays, {position, normal});
  EXPECT_TRUE(patch) << position.transpose();
  return patch ? surface.group_of_patch[*patch] : ~0u;
}

void expect_same(const SurfacePatches& a, const SurfacePatches& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t p = 0; p < a.size(); ++p) {
    EXPECT_EQ(a.patches[p].position_m, b.patches[p].position_m) << p;
    EXPECT_EQ(a.patches[p].normal, b.patches[p].normal) << p;
    EXPECT_EQ(a.patches[p].area_m2, b.patches[p].area_m2) << p;
  }
  EXPECT_EQ(a.cells, b.cells);
  EXPECT_EQ(a.first_link, b.first_link);
  EXPECT_EQ(a.group_of_patch, b.group_of_patch);
  EXPECT_EQ(a.patches_by_group, b.patches_by_group);
  for (std::size_t i = 0; i < a.links.size(); ++i) {
    EXPECT_EQ(a.links[i].patch, b.links[i].patch);
    EXPECT_EQ(a.links[i].length, b.links[i].length);
  }
}

/// What holds for every scene.
void expect_sound(const SurfacePatches& surface, const Scene& scene) {
  double area = 0;
  for (std::uint32_t p = 0; p < surface.size(); ++p) {
    area += surface.patches[p].area_m2;
    EXPECT_NEAR(surface.patches[p].normal.norm(), 1, 1e-5);
    const Vec3 in_cells = surface.grid.cells_of(surface.patches[p].position_m.cast<double>());
    const auto cell = cell_of(surface.cells[surface.cell_of_patch[p]]);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(in_cells[axis], cell[axis] + 0.5, 0.5 + 1e-4);
    for (const PatchLink& link : surface.links_of(p)) {
      EXPECT_EQ(surface.group_of_patch[link.patch], surface.group_of_patch[p]);
      EXPECT_GT(surface.patches[p].normal.dot(surface.patches[link.patch].normal), std::cos(kOneGroup_rad));
      EXPECT_GE(link.length, 1u);
      const auto back = surface.links_of(link.patch);
      EXPECT_EQ(std::count_if(back.begin(), back.end(), [&](const PatchLink& l) { return l.patch == p; }), 1);
    }
  }
  EXPECT_NEAR(area, 2 * area_m2(scene), 1e-5 * area + 1e-12);
  std::vector<std::uint32_t> all = surface.patches_by_group;
  std::sort(all.begin(), all.end());
  std::vector<std::uint32_t> each(surface.size());
  std::iota(each.begin(), each.end(), 0u);
  EXPECT_EQ(all, each);  // each patch is in exactly one group
  for (std::uint32_t g = 0; g < surface.groups(); ++g) {
    ASSERT_FALSE(surface.patches_of_group(g).empty());
    for (const std::uint32_t p : surface.patches_of_group(g)) EXPECT_EQ(surface.group_of_patch[p], g);
  }
}

TEST(TriangleCut, PartsLieInTheirCellsAndAddUpToTheTriangle) {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const double size = random.log_between(0.01, 20);
    const Vec3 at(30, 30, 30);
    std::array<Vec3, 3> corners{at + size * random.in_cube(), at + size * random.in_cube(),
                                at + size * random.in_cube()};
    if (i % 5 == 0)  // corners and edges in the boundaries
      for (Vec3& corner : corners) corner = corner.array().round();
    std::vector<CutPiece> pieces;
    cut_triangle(corners, pieces);
    const Vec3 cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    double area = 0;
    Vec3 moment = Vec3::Zero();
    for (const CutPiece& piece : pieces) {
      area += piece.area;
      moment += piece.area * piece.centroid;
      for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(piece.centroid[axis], piece.cell[axis] + 0.5, 0.5 + 1e-9);
    }
    EXPECT_NEAR(area, 0.5 * cross.norm(), 1e-9 * (1 + area));
    const Vec3 middle = (corners[0] + corners[1] + corners[2]) / 3;
    EXPECT_LT((moment - area * middle).norm(), 1e-8 * (1 + area)) << "the same centroid";
  }
}

TEST(TriangleCut, ExpectedPartsAreTheMeanOverOffsets) {
  Random random(2);
  for (int i = 0; i < 20; ++i) {
    const std::array<Vec3, 3> corners{5 * random.in_cube(), 5 * random.in_cube(), 5 * random.in_cube()};
    double sum = 0;
    constexpr int kOffsets = 400;
    for (int offset = 0; offset < kOffsets; ++offset) {
      const Vec3 by = Vec3(10, 10, 10) + 0.5 * random.in_cube();
      std::vector<CutPiece> pieces;
      cut_triangle({corners[0] + by, corners[1] + by, corners[2] + by}, pieces);
      sum += static_cast<double>(pieces.size());
    }
    EXPECT_NEAR(expected_pieces(corners) / (sum / kOffsets), 1, 0.05);
  }
}

TEST(CellGrid, OrderAndIndexAgreeWithTheStandardLibrary) {
  Random random(3);
  for (const std::size_t count : {0, 1, 2, 1000}) {
    std::vector<CellKey> keys;
    for (std::size_t i = 0; i < count; ++i)
      keys.push_back(
          key_of({static_cast<std::uint32_t>(random.below(i % 2 ? 9 : kMaxCells)),
                  static_cast<std::uint32_t>(random.below(9)), static_cast<std::uint32_t>(random.below(9))}));
    std::vector<std::uint32_t> expected(count);
    std::iota(expected.begin(), expected.end(), 0u);
    std::stable_sort(expected.begin(), expected.end(), [&](auto a, auto b) { return keys[a] < keys[b]; });
    EXPECT_EQ(order_of(keys), expected);
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    const CellIndex index(keys);
    for (std::uint32_t i = 0; i < keys.size(); ++i) EXPECT_EQ(index.find(keys[i]), i);
    EXPECT_EQ(index.find(key_of({kMaxCells, kMaxCells, kMaxCells})), CellIndex::kNone);
  }
  EXPECT_EQ(CellIndex().find(5), CellIndex::kNone);
  EXPECT_EQ(next_cell(key_of({3, 7, 1}), 1), key_of({3, 8, 1}));
  EXPECT_EQ(cell_of(key_of({123456, 7, kMaxCells})), (std::array<std::uint32_t, 3>{123456, 7, kMaxCells}));
}

TEST(SurfacePatches, AnySceneIsSoundWhateverTheOrderOfItsTriangles) {
  Random random(4);
  for (int i = 0; i < 6; ++i) {
    BuiltScene built;
    built.clutter(random, 60, 1);
    if (i % 2 == 0) built.column({0.2, 0.1, -0.5}, 0.4, 1, 24).sheet({-1, -1, -0.5}, {2, 0, 0}, {0, 2, 0}, 5, 5);
    const double cell_m = random.log_between(0.05, 0.5);
    const SurfacePatches surface = patches_of(built.scene(), cell_m);
    expect_sound(surface, built.scene());
    expect_same(surface, patches_of(shuffled(built.scene(), random), cell_m));
  }
}

TEST(SurfacePatches, PatchesOfACellDifferByMoreThan85Degrees) {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    std::vector<DicedPiece> pieces(1 + random.below(30));
    for (DicedPiece& piece : pieces)
      piece = {random.in_cube().cast<float>(), random.direction().cast<float>(),
               static_cast<float>(random.between(0.1, 1))};
    std::vector<SurfacePatch> patches;
    append_patches_of_cell(pieces, Vec3f::Zero(), 2, patches);
    // As many directions as can be 85 degrees apart: fewer than nine fit on a sphere.
    EXPECT_LT(patches.size(), 9u);
    EXPECT_GE(patches.size(), 2u);
    double area = 0, wanted = 0;
    for (const SurfacePatch& patch : patches) area += patch.area_m2;
    for (const DicedPiece& piece : pieces) wanted += 2 * piece.area_m2;
    EXPECT_NEAR(area, wanted, 1e-4 * wanted);
    if (pieces.size() == 1) {
      EXPECT_LT(patches[0].normal.dot(patches[1].normal), -0.999F);
    }
  }
  // Floor and wall stay apart; floor and a ramp of 80 degrees do not.
  const Vec3f up = Vec3f::UnitZ(), level = Vec3f::UnitX(),
              ramp(std::sin(static_cast<float>(rad_from_deg(80))), 0, std::cos(static_cast<float>(rad_from_deg(80))));
  for (const auto& [other, expected] : {std::pair{level, 4u}, std::pair{ramp, 2u}}) {
    std::vector<DicedPiece> pieces{{Vec3f::Zero(), up, 1}, {Vec3f::Zero(), other, 0.5F}};
    std::vector<SurfacePatch> patches;
    append_patches_of_cell(pieces, Vec3f::Zero(), 1, patches);
    EXPECT_EQ(patches.size(), expected);
  }
}

TEST(SurfacePatches, AnEmptySceneAndOneWithoutAreaHaveNone) {
  EXPECT_EQ(patches_of(Scene{}, 0.1).size(), 0u);
  EXPECT_EQ(patches_of(Scene{}, 0.1).groups(), 0u);
  BuiltScene built;
  built.triangle({0, 0, 0}, {1, 0, 0}, {2, 0, 0}).triangle({1, 1, 1}, {1, 1, 1}, {1, 1, 1});
  auto surface = dice_surfaces(built.scene(), {0.1, 1});
  ASSERT_TRUE(surface);
  EXPECT_EQ(surface->size(), 0u);
  Scene broken = BuiltScene().triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}).scene();
  broken.vertices_m[1].x() = std::numeric_limits<float>::quiet_NaN();
  surface = dice_surfaces(broken, {0.1, 1});
  ASSERT_TRUE(surface);
  EXPECT_EQ(surface->size(), 0u);
}

TEST(SurfacePatches, CellsThatCannotBeAreRefusedWithASizeThatDoes) {
  const Scene scene = BuiltScene().sheet({-10000, -10000, 0}, {20000, 0, 0}, {0, 20000, 0}).scene();
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (const double cell_m : {0.0, -1.0, nan, infinity}) EXPECT_FALSE(dice_surfaces(scene, {cell_m, 1})) << cell_m;
  const auto refused = dice_surfaces(scene, {0.1, 1});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().cause, Cause::invalid);
  EXPECT_NE(refused.error().detail.find("at least 3 m"), std::string::npos) << refused.error().detail;
  EXPECT_FALSE(dice_surfaces(scene, {1e-9, 1}));
}

TEST(SurfacePatches, TheTwoSidesOfAWallAreTwoGroupsHoweverThinItIs) {
  for (const double thickness_m : {0.0, 0.004, 0.03, 0.09, 0.25})
    for (const double at_m : {0.0, 0.013, 0.05, 0.0764}) {
      BuiltScene built;
      if (thickness_m > 0)
        built.box({at_m, -2, 0}, {at_m + thickness_m, 2, 2.5});
      else
        built.sheet({at_m, -2, 0}, {0, 4, 0}, {0, 0, 2.5});
      const SurfacePatches surface = patches_of(built.scene(), 0.1);
      const RayScene rays(built.scene());
      const std::uint32_t west = group_at(surface, rays, {at_m, 0.3, 1}, -Vec3::UnitX()),
                          east = group_at(surface, rays, {at_m + thickness_m, 0.3, 1}, Vec3::UnitX());
      EXPECT_NE(west, east);
      for (const auto& [group, x_m, out] : {std::tuple{west, at_m, -1.0}, {east, at_m + thickness_m, 1.0}}) {
        double area = 0;
        for (const std::uint32_t p : surface.patches_of_group(group)) {
          EXPECT_NEAR(surface.patches[p].position_m.x(), x_m, 1e-5);
          EXPECT_NEAR(surface.patches[p].normal.x(), out, 1e-5);
          area += surface.patches[p].area_m2;
        }
        // The front side also stands for what lies behind it in a cell.
        EXPECT_GE(area, 10 - 1e-3) << thickness_m << " " << at_m;
        EXPECT_LE(area, 20.3) << thickness_m << " " << at_m;
      }
    }
}

TEST(SurfacePatches, AFloorThatWallsStandOnIsAGroupInEachRoom) {
  // One floor of two triangles, three rooms: walls of a sheet and of a box, each from floor to ceiling.
  BuiltScene built;
  built.sheet({0, 0, 0}, {9, 0, 0}, {0, 3, 0}).box({2.9, -0.1, -0.1}, {3.02, 3.1, 2.6});
  built.sheet({6.003, -0.1, -0.1}, {0, 3.2, 0}, {0, 0, 2.7});
  const SurfacePatches surface = patches_of(built.scene(), 0.1);
  const RayScene rays(built.scene());
  std::vector<std::uint32_t> rooms;
  for (const double x_m : {1.5, 4.5, 7.5}) rooms.push_back(group_at(surface, rays, {x_m, 1.5, 0}, Vec3::UnitZ()));
  EXPECT_NE(rooms[0], rooms[1]);
  EXPECT_NE(rooms[1], rooms[2]);
  EXPECT_NE(rooms[0], rooms[2]);
  const double expected_m2[] = {2.9 * 3, (6.003 - 3.02) * 3, (9 - 6.003) * 3};
  for (std::size_t room = 0; room < 3; ++room) {
    double area = 0;
    for (const std::uint32_t p : surface.patches_of_group(rooms[room])) area += surface.patches[p].area_m2;
    EXPECT_NEAR(area, expected_m2[room], 0.1 * 3) << "within a row of patches";
  }
  // Right beside a wall, where the middle of the patch is in it, a click still means the room that it was made in.
  for (double x_m = 2.805; x_m < 2.9; x_m += 0.01)
    EXPECT_EQ(group_at(surface, rays, {x_m, 1.5, 0}, Vec3::UnitZ()), rooms[0]) << x_m;
  for (double x_m = 3.03; x_m < 3.2; x_m += 0.01)
    EXPECT_EQ(group_at(surface, rays, {x_m, 1.5, 0}, Vec3::UnitZ()), rooms[1]) << x_m;
}

TEST(SurfacePatches, InAColonnadeEachShaftIsAGroupAndTheFloorIsOne) {
  BuiltScene built;
  built.sheet({0, 0, 0}, {10, 0, 0}, {0, 4, 0})
      .sheet({0, 0, 3}, {10, 0, 0}, {0, 4, 0})
      .sheet({0, 0, 0}, {10, 0, 0}, {0, 0, 3});
  for (int i = 0; i < 4; ++i) built.column({2.0 * i + 2, 2, 0}, 0.35, 3, 32);
  const SurfacePatches surface = patches_of(built.scene(), 0.08);
  const RayScene rays(built.scene());
  std::vector<std::uint32_t> groups;
  for (int i = 0; i < 4; ++i) {
    groups.push_back(group_at(surface, rays, {2.0 * i + 2.35, 2, 1.5}, Vec3::UnitX()));
    EXPECT_EQ(group_at(surface, rays, {2.0 * i + 1.65, 2, 1}, -Vec3::UnitX()), groups.back()) << "all around";
    double area = 0;
    for (const std::uint32_t p : surface.patches_of_group(groups.back())) area += surface.patches[p].area_m2;
    EXPECT_NEAR(area, 2 * kPi * 0.35 * 3, 0.06 * area);
  }
  groups.push_back(group_at(surface, rays, {1, 1, 0}, Vec3::UnitZ()));
  EXPECT_EQ(group_at(surface, rays, {9, 3.5, 0}, Vec3::UnitZ()), groups.back());
  groups.push_back(group_at(surface, rays, {1, 1, 3}, -Vec3::UnitZ()));
  groups.push_back(group_at(surface, rays, {5, 0, 1}, Vec3::UnitY()));
  groups.push_back(group_at(surface, rays, {5, 0, 1}, -Vec3::UnitY()));
  std::sort(groups.begin(), groups.end());
  EXPECT_EQ(std::unique(groups.begin(), groups.end()), groups.end());
}

TEST(SurfacePatches, WherePeoplePointAtNothingThereIsNoPatch) {
  const Scene scene = BuiltScene().sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}).scene();
  const SurfacePatches surface = patches_of(scene, 0.1);
  const RayScene rays(scene);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(patch_at(surface, rays, {{0.5, 0.5, 0}, Vec3::UnitZ()}));
  EXPECT_FALSE(patch_at(surface, rays, {{0.5, 0.5, 1}, Vec3::UnitZ()}));
  EXPECT_FALSE(patch_at(surface, rays, {{0.5, 0.5, 0}, Vec3::UnitX()}));
  EXPECT_FALSE(patch_at(surface, rays, {{nan, 0, 0}, Vec3::UnitZ()}));
  EXPECT_FALSE(patch_at(surface, rays, {{0.5, 0.5, 0}, {nan, 0, 0}}));
  EXPECT_FALSE(patch_at(surface, rays, {{1e300, -1e300, 0}, Vec3::UnitZ()}));
  const Scene none;
  EXPECT_FALSE(patch_at(patches_of(none, 0.1), RayScene(none), {{0, 0, 0}, Vec3::UnitZ()}));
}

}  // namespace
}  // namespace luxrig
