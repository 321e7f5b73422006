#include "core/solve/placement/scene/mounting.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/solve/placement/scene/surface_lattice.h"
#include "tests/core/solve/placement/mounted_room.h"

namespace luxrig {
namespace {

struct MountedRoom {
  Scene scene = mounted_room();
  RayScene rays{scene};
  MountingSpec spec;

  [[nodiscard]] Checked<Mounting> make() const { return Mounting::make(spec, "rig.toml", scene, rays); }
  void hang_off(const char* pattern, double from_m, double to_m) {
    spec.surfaces = {{pattern, {7, 3}}};
    spec.offset_min_m = from_m;
    spec.offset_max_m = to_m;
  }
};

template <class Expected>
void expect_may_hang_where(const Mounting& mounting, const Expected& expected) {
  std::mt19937_64 random(3);
  int good = 0;
  for (int i = 0; i < 5000; ++i) {
    const auto within = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    const double x = within(-0.2, 4.2), y = within(-0.2, 3.2), z = within(-0.2, 2.7);
    const Vec3 p(x, y, z);
    EXPECT_EQ(mounting.may_hang(p), expected(p)) << p.transpose();
    good += expected(p) ? 1 : 0;
  }
  EXPECT_GT(good, 50);
}

double to_sides_m(const Vec3& p) { return std::min({p.x(), 4 - p.x(), p.y(), 3 - p.y()}); }

TEST(Mounting, InTheAirKeepsItsClearanceFromEverything) {
  MountedRoom room;
  room.spec.clearance_m = 0.3;
  expect_may_hang_where(*room.make(), [](const Vec3& p) {
    return std::min({to_sides_m(p), p.z(), 2.5 - p.z()}) >= 0.3;
  });
}

TEST(Mounting, StaysInItsBox) {
  MountedRoom room;
  room.spec.clearance_m = 0.1;
  room.spec.box_world_m = Eigen::AlignedBox3d(Vec3(1, 1, 1), Vec3(3, 2.95, 2.45));
  expect_may_hang_where(*room.make(), [](const Vec3& p) {
    return p.x() >= 1 && p.x() <= 3 && p.y() >= 1 && p.y() <= 2.9 && p.z() >= 1 && p.z() <= 2.4;
  });
}

TEST(Mounting, OffTheCeilingKeepsItsOffsetsAndWallClearance) {
  MountedRoom room;
  room.hang_off("ceil*", 0.1, 0.4);
  room.spec.clearance_m = 0.5;
  expect_may_hang_where(*room.make(),
                        [](const Vec3& p) { return p.z() <= 2.4 && p.z() >= 2.1 && to_sides_m(p) >= 0.5; });
}

TEST(Mounting, SnapsToTheNearestPlaceAndFixesOnlyNeededAxes) {
  MountedRoom room;
  room.hang_off("ceiling", 0.1, 0.4);
  room.spec.clearance_m = 0.5;
  const Mounting mounting = *room.make();
  const auto good = mounting.snapped(Vec3(1, 1, 2.25));
  ASSERT_TRUE(good);
  EXPECT_EQ(good->place_world_m, Vec3(1, 1, 2.25));
  EXPECT_EQ(good->per_wanted, Mat3(Mat3::Identity()));
  for (const auto& [wanted_z, z] : {std::pair(1.0, 2.1), std::pair(2.45, 2.4)}) {
    const auto at = mounting.snapped(Vec3(1, 1, wanted_z));
    ASSERT_TRUE(at);
    EXPECT_LE((at->place_world_m - Vec3(1, 1, z)).norm(), 1e-9);
    EXPECT_LE((at->per_wanted - Mat3(Vec3(1, 1, 0).asDiagonal())).norm(), 1e-6);
    EXPECT_TRUE(mounting.may_hang(at->place_world_m));
  }
  EXPECT_FALSE(mounting.snapped(Vec3(0.2, 1, 2.3))) << "a wall is too near, and no bound of the mounting";
  EXPECT_FALSE(mounting.snapped(Vec3::Constant(std::nan(""))));
}

TEST(Mounting, SnapsIntoACornerOfItsBox) {
  MountedRoom room;
  room.spec.box_world_m = Eigen::AlignedBox3d(Vec3(1, 1, 1), Vec3(2, 2, 2));
  const auto at = room.make()->snapped(Vec3(0.5, 1.5, 2.4));
  ASSERT_TRUE(at);
  EXPECT_EQ(at->place_world_m, Vec3(1, 1.5, 2));
  EXPECT_EQ(at->per_wanted, Mat3(Vec3(0, 1, 0).asDiagonal()));
}

TEST(Mounting, CandidatesFillTheAirEvenly) {
  MountedRoom room;
  room.spec.clearance_m = 0;
  room.spec.spacing_m = 0.25;
  const auto places_m = room.make()->candidates(2);
  ASSERT_TRUE(places_m);
  EXPECT_EQ(places_m->size(), 16u * 12 * 10);
  room.spec.clearance_m = 0.25;  // drops the outermost, 0.125 m off the walls
  EXPECT_EQ(room.make()->candidates(2)->size(), 14u * 10 * 8);
  room.spec.spacing_m = std::nullopt;
  room.spec.clearance_m = 0;
  EXPECT_NEAR(static_cast<double>(room.make()->candidates(1)->size()), 20'000, 2'000);
}

TEST(Mounting, CandidatesOffASurfaceLieOnOneLatticeInLayers) {
  MountedRoom room;
  room.hang_off("ceiling", 0.1, 0.5);
  room.spec.clearance_m = 0.3;
  room.spec.spacing_m = 0.2;
  const Mounting mounting = *room.make();
  const auto places_m = mounting.candidates(1);
  ASSERT_TRUE(places_m);
  // 0.3, 0.5 … 3.7 by 0.3 … 2.7, at 0.2 and 0.4 below the ceiling. Above the ceiling is outside the box.
  EXPECT_EQ(places_m->size(), 18u * 13 * 2);
  for (const Vec3& place_m : *places_m) {
    EXPECT_TRUE(mounting.may_hang(place_m));
    EXPECT_LE(std::min(std::abs(place_m.z() - 2.3), std::abs(place_m.z() - 2.1)), 1e-6);
  }
  EXPECT_EQ(*mounting.candidates(3), *places_m) << "whatever the threads";
}

TEST(Mounting, UnknownNamesAreRefusedWithPlaceAndRemedy) {
  MountedRoom room;
  room.hang_off("ceilng", 0.1, 0.2);
  const auto mounting = room.make();
  ASSERT_FALSE(mounting);
  ASSERT_EQ(mounting.error().size(), 1u);
  EXPECT_TRUE(mounting.error()[0].text().starts_with("rig.toml:7:3: surfaces \"ceilng\" fits no material or object"))
      << mounting.error()[0].text();
  EXPECT_EQ(mounting.error()[0].mend, "did you mean \"ceiling\"?");
}

TEST(Mounting, AnEmptySceneNeedsABox) {
  const Scene scene;
  const RayScene rays(scene);
  MountingSpec spec;
  EXPECT_FALSE(Mounting::make(spec, "rig.toml", scene, rays));
  spec.box_world_m = Eigen::AlignedBox3d(Vec3(0, 0, 2), Vec3(4, 4, 2.1));
  const auto mounting = Mounting::make(spec, "rig.toml", scene, rays);
  ASSERT_TRUE(mounting);
  EXPECT_GT(mounting->candidates(1)->size(), 10'000u);
}

TEST(Mounting, RefusesTooManyPlacesOrNone) {
  MountedRoom room;
  room.spec.spacing_m = 0.002;
  const auto many = room.make()->candidates(1);
  ASSERT_FALSE(many);
  EXPECT_NE(many.error().detail.find("3.75e+09 places"), std::string::npos) << many.error().detail;
  room.spec.spacing_m = 0.5;
  room.spec.clearance_m = 1.3;
  const auto none = room.make()->candidates(1);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().detail.find("no light may hang anywhere"), std::string::npos) << none.error().detail;
}

TEST(SurfaceLattice, IsTheSameForAnyTriangulation) {
  const Vec3 low(0, 0, 1), right(2, 0, 1), high(2, 2, 1), left(0, 2, 1);
  const auto points_of = [](const std::vector<std::array<Vec3, 3>>& triangles) {
    std::vector<std::array<double, 3>> points;
    for (const auto& triangle : triangles)
      for (const Vec3& p : lattice_on(triangle, 0.25)) points.push_back({p.x(), p.y(), p.z()});
    std::sort(points.begin(), points.end());
    return points;
  };
  // The diagonal runs through the middles of eight cells.
  const auto halves = points_of({{low, right, high}, {low, high, left}});
  EXPECT_EQ(halves.size(), 64u);
  EXPECT_TRUE(std::adjacent_find(halves.begin(), halves.end()) == halves.end()) << "a point twice";
  const Vec3 inside(0.7, 1.1, 1);
  EXPECT_EQ(points_of({{inside, low, right}, {right, high, inside}, {left, inside, high}, {low, inside, left}}),
            halves);
}

TEST(SurfaceLattice, LiesOnSlantedTriangles) {
  const std::array<Vec3, 3> triangle = {Vec3(0, 0, 0), Vec3(3, 0, 1), Vec3(0, 3, 2)};
  const auto points = lattice_on(triangle, 0.1);
  EXPECT_NEAR(static_cast<double>(points.size()), widest_shadow_m2(triangle) / 0.01, 15);
  for (const Vec3& p : points) EXPECT_NEAR(p.z(), p.x() / 3 + 2 * p.y() / 3, 1e-12);
  EXPECT_TRUE(lattice_on({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)}, 0.1).empty());
}

}  // namespace
}  // namespace luxrig
