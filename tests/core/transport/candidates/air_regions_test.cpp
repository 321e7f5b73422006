#include "core/transport/candidates/air_regions.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "tests/core/transport/candidates/box_rooms.h"

namespace luxrig {
namespace {

Scene empty_scene() {
  Scene scene;
  scene.materials = {{"any", Vec3::Constant(0.5)}};
  scene.object_names = {"scene"};
  return scene;
}

TEST(AirRegions, SeparateInsideFromOutsideOfRandomBoxes) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const double scale_m : {1e-3, 1.0, 1e4}) {
    Scene scene = empty_scene();
    struct Box {
      Mat3 box_from_world;
      Vec3 middle_m, half_m;
    };
    std::vector<Box> boxes;
    for (int b = 0; b < 20; ++b) {
      const Vec3 half_m = scale_m * Vec3(unit(random), unit(random), unit(random)).cwiseAbs() * 0.5;
      const Vec3 middle_m = scale_m * Vec3(unit(random), unit(random), unit(random));
      const Mat3 turn =
          Eigen::Quaterniond(unit(random), unit(random), unit(random), unit(random)).normalized().toRotationMatrix();
      const std::size_t first = scene.vertices_m.size();
      add_box(scene, -half_m, half_m);
      for (std::size_t v = first; v < scene.vertices_m.size(); ++v)
        scene.vertices_m[v] = (turn * scene.vertices_m[v].cast<double>() + middle_m).cast<float>();
      boxes.push_back({turn.transpose(), middle_m, half_m});
    }
    const AirRegions regions(scene);
    EXPECT_EQ(regions.closed_pieces(), 20u);
    std::map<std::vector<bool>, std::uint64_t> mark_of;
    int inside_some = 0;
    for (int i = 0; i < 20'000; ++i) {
      const Vec3 p = scale_m * 1.5 * Vec3(unit(random), unit(random), unit(random));
      std::vector<bool> in;
      bool near = false;
      for (const Box& b : boxes) {
        const Vec3 beyond = (b.box_from_world * (p - b.middle_m)).cwiseAbs() - b.half_m;
        in.push_back(beyond.maxCoeff() < 0);
        near |= std::abs(beyond.maxCoeff()) < 1e-5 * scale_m;
      }
      if (near) continue;
      const std::uint64_t mark = regions.mark(p);
      const auto [known, fresh] = mark_of.try_emplace(in, mark);
      ASSERT_EQ(known->second, mark) << "scale " << scale_m << " point " << p.transpose();
      inside_some += mark != 0;
      ASSERT_EQ(mark != 0, std::count(in.begin(), in.end(), true) > 0);
    }
    EXPECT_GT(inside_some, 500);
    std::set<std::uint64_t> different;
    for (const auto& [in, mark] : mark_of) different.insert(mark);
    EXPECT_EQ(different.size(), mark_of.size());
  }
}

TEST(AirRegions, IgnoreOpenSurfaces) {
  Scene scene = empty_scene();
  add_box(scene, {0, 0, 0}, {1, 1, 1});
  scene.triangles.pop_back();
  scene.material_of_triangle.pop_back();
  scene.object_of_triangle.pop_back();
  const AirRegions regions(scene);
  EXPECT_EQ(regions.closed_pieces(), 0u);
  EXPECT_EQ(regions.mark({0.5, 0.5, 0.5}), 0u);
}

TEST(AirRegions, AreCorrectOnLatticesAlongFacesEdgesAndCorners) {
  // Every vertical line through a point of the 0.5 m lattice meets edges or corners of these boxes.
  Scene scene = empty_scene();
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y) add_box(scene, {1.0 * x, 1.0 * y, 0.25}, {x + 1.0, y + 1.0, 0.75});
  const AirRegions regions(scene);
  for (int x = -1; x < 8; ++x)
    for (int y = -1; y < 8; ++y) {
      EXPECT_EQ(regions.mark({0.5 * x, 0.5 * y, 0.1}), 0u) << x << " " << y;
      EXPECT_EQ(regions.mark({0.5 * x, 0.5 * y, 0.9}), 0u) << x << " " << y;
    }
}

TEST(ReceiversAir, ExcludesSolidsAndSealedRoomsButNotRoomsJoinedByADoor) {
  for (const bool door : {false, true}) {
    const Scene scene = two_rooms(0.7, door);
    const RayScene rays(scene);
    auto receivers = receivers_in_two_rooms(6);
    receivers.resize(6);  // the first room
    const ReceiversAir air(scene, rays, receivers);
    EXPECT_TRUE(air.reaches({2, 2.5, 2}));
    EXPECT_FALSE(air.reaches({1.5, 1.5, 0.72})) << "in the table";
    EXPECT_FALSE(air.reaches({4.07, 0.5, 1})) << "in the wall";
    EXPECT_FALSE(air.reaches({-0.1, 1, 1})) << "in the outer wall";
    EXPECT_TRUE(air.reaches({3, 1, 2.5})) << "flush with the ceiling";
    EXPECT_TRUE(air.reaches({1.5, 1.5, 0.75})) << "lying on the table";
  }
  // A room as one closed surface: no light from inside gets outdoors.
  Scene shell = empty_scene();
  add_box(shell, {0, 0, 0}, {4, 3, 2.5});
  const RayScene rays(shell);
  const Receiver receiver{{2, 1, 0.8}, Vec3::UnitZ()};
  const ReceiversAir air(shell, rays, std::span(&receiver, 1));
  EXPECT_TRUE(air.reaches({1, 1, 2.4}));
  EXPECT_FALSE(air.reaches({1, 1, 2.6}));
  EXPECT_FALSE(air.reaches({-100, 1, 2.4}));
}

}  // namespace
}  // namespace luxrig
