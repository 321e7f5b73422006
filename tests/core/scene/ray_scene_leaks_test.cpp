/// Light must not leak through closed walls, nor may walls shade themselves, from 1 mm to 10 km and far from the
/// origin.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/scene/ray_scene.h"
#include "tests/random.h"

namespace luxrig {
namespace {

/// A closed box, turned and placed at random, from millimetres to ten kilometres.
struct Box {
  explicit Box(Random& random) {
    const double size_m = std::pow(10, random.between(-3, 4));
    half_m = size_m * Vec3(random.between(0.2, 1), random.between(0.2, 1), random.between(0.2, 1));
    if (random.below(3) > 0) turn = random.rotation();
    if (random.below(2) > 0) scene.origin_world_m = 1e7 * random.in_cube();
    // Up to ten sizes from the scene's origin, like one room of many.
    if (random.below(2) > 0) middle_m = 10 * size_m * random.in_cube();
    split = 1 + static_cast<int>(random.below(4));
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {-1, 1}) {
        const auto base = static_cast<std::uint32_t>(scene.vertices_m.size());
        for (int i = 0; i <= split; ++i)
          for (int j = 0; j <= split; ++j) {
            Vec3 at;
            at[axis] = side;
            at[(axis + 1) % 3] = 2.0 * i / split - 1;
            at[(axis + 2) % 3] = 2.0 * j / split - 1;
            scene.vertices_m.push_back((turn * half_m.cwiseProduct(at) + middle_m).cast<float>());
          }
        const auto row = static_cast<std::uint32_t>(split + 1);
        for (std::uint32_t i = 0; i + 1 < row; ++i)
          for (std::uint32_t j = 0; j + 1 < row; ++j) {
            const std::uint32_t v = base + i * row + j;
            scene.triangles.push_back({v, v + 1, v + row + 1});
            scene.triangles.push_back({v, v + row + 1, v + row});
          }
      }
    scene.materials.resize(1);
    scene.material_of_triangle.assign(scene.triangles.size(), 0);
    scene.object_of_triangle.assign(scene.triangles.size(), 0);
  }

  /// From the cube [-1, 1]³ to the world.
  [[nodiscard]] Vec3 place(const Vec3& at) const {
    return turn * half_m.cwiseProduct(at) + middle_m + scene.origin_world_m;
  }
  [[nodiscard]] double size_m() const { return half_m.minCoeff(); }

  Vec3 half_m, middle_m = Vec3::Zero();
  Mat3 turn = Mat3::Identity();
  int split = 1;
  Scene scene;
};

/// In the cube: on a face, a grid line of its triangles, an edge, or in a corner; with the face's inward normal.
struct OnWall {
  OnWall(Random& random, const Box& box, bool also_edges) {
    at = random.in_cube();
    const auto axis = static_cast<int>(random.below(3));
    const double side = random.below(2) == 0 ? -1 : 1;
    for (int k = 0; k < 3; ++k) {
      const auto kind = random.below(6);
      if (kind == 0)
        at[k] = 2.0 * static_cast<double>(random.below(static_cast<std::size_t>(box.split) + 1)) / box.split - 1;
      if (kind == 1) at[k] = std::copysign(1 - std::pow(10, random.between(-6, -1)), at[k]);
    }
    at[axis] = side;
    if (!also_edges) {
      for (int k = 0; k < 3; ++k)
        if (k != axis) at[k] *= 0.9999;
    }
    normal_world = box.turn * (-side * Vec3::Unit(axis));
  }
  Vec3 at, normal_world;
};

TEST(RayLeaks, ALampOutsideAClosedBoxReachesNoPointInside) {
  Random random(1);
  int configurations = 0, leaks = 0, leaks_many = 0, at_edges = 0;
  for (int b = 0; b < 300; ++b) {
    const Box box(random);
    const RayScene rays(box.scene);
    for (int i = 0; i < 60; ++i) {
      const bool in_the_air = i % 3 == 0;
      const OnWall wall(random, box, false);
      const Vec3 from_at = in_the_air ? Vec3(0.99 * random.in_cube()) : wall.at;
      const Vec3 from = box.place(from_at), normal = in_the_air ? Vec3(Vec3::Zero()) : wall.normal_world;
      // The way out leads through a face, a grid line, an edge or a corner; the lamp is just behind it or far off.
      const OnWall exit(random, box, true);
      const double beyond = std::pow(10, random.between(-2, 3));
      const Vec3 to = box.place(exit.at + beyond * (exit.at - from_at));
      const Vec3 past_m = ((exit.at + beyond * (exit.at - from_at)).cwiseAbs() - Vec3::Ones()).cwiseProduct(box.half_m);
      // Within 2 e of a wall's plane a lamp counts as on that wall, which then lets its light pass.
      if (past_m.maxCoeff() < 0 || past_m.cwiseAbs().minCoeff() < 4 * rays.surface_error_m(to)) continue;
      // Lamps behind the surface or in its plane are not tested.
      if (!in_the_air && normal.dot(to - from) < 8 * rays.surface_error_m(to)) continue;
      ++configurations;
      const bool at_edge = (exit.at.cwiseAbs().array() == 1).count() > 1;
      (at_edge ? at_edges : leaks) += !rays.occluded(from, normal, to);
      const std::array<Vec3, 4> targets = {to, to, to, to};
      std::array<std::uint8_t, 4> occluded{};
      rays.occluded_many(from, normal, targets, occluded);
      (at_edge ? at_edges : leaks_many) += occluded != std::array<std::uint8_t, 4>{1, 1, 1, 1};
    }
  }
  EXPECT_GE(configurations, 10'000);
  // None with g++'s order of draws; one in some 170,000 with clang's, which also passes within rounding of an edge.
  EXPECT_LE(leaks, 1) << "of " << configurations;
  EXPECT_LE(leaks_many, 1);
  // Aimed exactly at the edge between two walls, one ray in 16,000 slips through Embree's robust mode (11 of 170,000).
  EXPECT_LE(at_edges, configurations / 2000);
}

TEST(RayLeaks, ALampOutsideReachesNoPointExactlyOnAnEdge) {
  Random random(2);
  int configurations = 0, leaks = 0;
  for (int b = 0; b < 300; ++b) {
    const Box box(random);
    const RayScene rays(box.scene);
    for (int i = 0; i < 100; ++i) {
      OnWall wall(random, box, true);
      const auto axis = static_cast<int>(random.below(3));
      if (std::abs(wall.at[axis]) == 1) continue;
      // Two walls meet there. Exactly at the corner of three, a ray may slip out by the third.
      wall.at *= 0.999;
      for (int k = 0; k < 3; ++k)
        if (std::abs(wall.normal_world.dot(box.turn.col(k))) > 0.5 || k == axis)
          wall.at[k] = std::copysign(1, wall.at[k]);
      const Vec3 from = box.place(wall.at);
      // Out through the other wall, not grazing it: grazing, the point lies in both walls and has no inside.
      const Vec3 way = random.in_cube().normalized();
      if (way[axis] * wall.at[axis] < 0.3 || (box.turn * way).dot(wall.normal_world) < 0.01) continue;
      ++configurations;
      leaks += !rays.occluded(from, wall.normal_world, from + box.turn * way * box.size_m() * random.between(0.1, 10));
    }
  }
  EXPECT_GE(configurations, 1'000);
  EXPECT_EQ(leaks, 0);
}

TEST(RayLeaks, ALampInAnEmptyBoxReachesEveryPointOfItsWalls) {
  Random random(3);
  int configurations = 0, shaded = 0, shaded_many = 0, grazing = 0;
  for (int b = 0; b < 300; ++b) {
    const Box box(random);
    const RayScene rays(box.scene);
    for (int i = 0; i < 60; ++i) {
      const OnWall wall(random, box, false), lamp(random, box, true);
      const Vec3 from = box.place(wall.at);
      // In the air, flush with another wall, in an edge or corner, or so close to the wall itself that light grazes it.
      Vec3 to_at = i % 3 == 0 ? Vec3(0.999 * random.in_cube()) : lamp.at;
      if (i % 3 == 2) {
        int own = 0;
        wall.at.cwiseAbs().maxCoeff(&own);
        to_at[own] = wall.at[own] * (1 - std::pow(10, random.between(-5, -1)));
      }
      const Vec3 to = box.place(to_at);
      const double height_m = wall.normal_world.dot(to - from);
      if (height_m < 8 * rays.surface_error_m(to)) continue;  // in the wall's plane, to rounding
      ++configurations;
      grazing += height_m < 0.01 * (to - from).norm();
      shaded += rays.occluded(from, wall.normal_world, to);
      const std::array<Vec3, 4> targets = {to, to, to, to};
      std::array<std::uint8_t, 4> occluded{};
      rays.occluded_many(from, wall.normal_world, targets, occluded);
      shaded_many += occluded != std::array<std::uint8_t, 4>{0, 0, 0, 0};
    }
  }
  EXPECT_GE(configurations, 10'000);
  EXPECT_GT(grazing, 500);
  EXPECT_EQ(shaded, 0);
  EXPECT_EQ(shaded_many, 0);
}

TEST(RayLeaks, ASheetCloseToALampOrAReceiverBlocksItsLight) {
  // A sheet 4 e or more before the lamp, or 8 e off the receiver's surface, at any slant. When shadow rays just stopped
  // short, a third of a millimetre was overlooked.
  Random random(4);
  for (int i = 0; i < 600; ++i) {
    const double size_m = std::pow(10, random.between(-3, 4));
    const Mat3 turn = random.rotation();
    Scene scene;
    scene.origin_world_m = i % 2 ? Vec3(1e6 * random.in_cube()) : Vec3(Vec3::Zero());
    const auto quad = [&](const Vec3& middle, double half) {
      const auto base = static_cast<std::uint32_t>(scene.vertices_m.size());
      for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
        scene.vertices_m.push_back((turn * (middle + half * Vec3(x, y, 0))).cast<float>());
      scene.triangles.push_back({base, base + 1, base + 2});
      scene.triangles.push_back({base, base + 2, base + 3});
    };
    quad(Vec3::Zero(), 2 * size_m);        // the floor
    quad(Vec3(0, 0, size_m), 2 * size_m);  // the ceiling, with the lamp flush in it
    const double error_m = 0x1p-24 * (4 * 3 + 16 * 4 * std::sqrt(2)) * size_m + 0x1p-50 * 1e6;
    const bool at_lamp = i % 3 != 0;
    const double off_m = (at_lamp ? 4 : 8) * error_m * random.between(1, 3);
    quad(Vec3(0, 0, at_lamp ? size_m - off_m : off_m), 1.5 * size_m);
    scene.materials.resize(1);
    scene.material_of_triangle.assign(scene.triangles.size(), 0);
    scene.object_of_triangle.assign(scene.triangles.size(), 0);
    const RayScene rays(scene);
    const Vec3 from(size_m * random.between(-1, 1), size_m * random.between(-1, 1), 0);
    const Vec3 lamp(size_m * random.between(-1, 1), size_m * random.between(-1, 1), size_m);
    const auto world = [&](const Vec3& p) { return Vec3(turn * p + scene.origin_world_m); };
    EXPECT_TRUE(rays.occluded(world(from), turn * Vec3::UnitZ(), world(lamp))) << i << " " << size_m;
    // The ceiling does not stop slanting light that passes the sheet's edge.
    const Vec3 aside(1.9 * size_m, 0, size_m);
    EXPECT_FALSE(rays.occluded(world({1.9 * size_m, 1.6 * size_m, 0}), turn * Vec3::UnitZ(), world(aside))) << i;
  }
}

TEST(RayLeaks, SingleAndBatchedRaysGiveTheSameAnswers) {
  Random random(5);
  int compared = 0, stopped = 0;
  for (int b = 0; b < 200; ++b) {
    Scene scene;
    for (std::uint32_t i = 0; i < 60; ++i) {
      const Vec3 middle = random.in_cube();
      for (int k = 0; k < 3; ++k) scene.vertices_m.push_back((middle + 0.3 * random.in_cube()).cast<float>());
      scene.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    scene.materials.resize(1);
    scene.material_of_triangle.assign(scene.triangles.size(), 0);
    scene.object_of_triangle.assign(scene.triangles.size(), 0);
    const RayScene rays(scene);
    const Vec3 from = random.in_cube(), normal = b % 2 ? random.in_cube().normalized() : Vec3(Vec3::Zero());
    const Vec3 towards = random.in_cube();
    std::vector<Vec3> targets;  // close together, or anywhere; more than one batch
    for (int i = 0; i < 150; ++i) targets.push_back(b % 3 ? Vec3(towards + 0.1 * random.in_cube()) : random.in_cube());
    targets[7] = from;
    std::vector<std::uint8_t> occluded(targets.size(), 9);
    rays.occluded_many(from, normal, targets, occluded);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      EXPECT_EQ(occluded[i], rays.occluded(from, normal, targets[i]) ? 1 : 0) << b << " " << i;
      stopped += occluded[i];
      ++compared;
    }
  }
  EXPECT_GT(stopped, compared / 10);
  EXPECT_LT(stopped, compared * 9 / 10);
}

TEST(RayLeaks, NoLightPassesAWallOfFifteenCentimetres) {
  Random random(6);
  int configurations = 0, leaks = 0;
  for (int b = 0; b < 200; ++b) {
    const Vec3 at = b % 2 ? Vec3(1e7 * random.in_cube()) : Vec3(Vec3::Zero());
    Scene scene;
    scene.origin_world_m = at;
    const auto box = [&](const Vec3& low, const Vec3& high) {
      const auto base = static_cast<std::uint32_t>(scene.vertices_m.size());
      for (int i = 0; i < 8; ++i)
        scene.vertices_m.push_back(
            Vec3(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z()).cast<float>());
      for (const auto& f : {std::array<std::uint32_t, 4>{0, 1, 3, 2},
                            {4, 5, 7, 6},
                            {0, 1, 5, 4},
                            {2, 3, 7, 6},
                            {0, 2, 6, 4},
                            {1, 3, 7, 5}}) {
        scene.triangles.push_back({base + f[0], base + f[1], base + f[2]});
        scene.triangles.push_back({base + f[0], base + f[2], base + f[3]});
      }
    };
    box({0, 0, 0}, {4, 3, 2.7});
    box({4.15, 0, 0}, {8, 3, 2.7});
    scene.materials.resize(1);
    scene.material_of_triangle.assign(scene.triangles.size(), 0);
    scene.object_of_triangle.assign(scene.triangles.size(), 0);
    const RayScene rays(scene);
    for (int i = 0; i < 200; ++i) {
      // Lamps on the wall itself, in its corners, or in the room; points likewise on the other side.
      const auto side = [&](double wall_x, double other_x, int kind) {
        Vec3 p(kind == 0 ? wall_x : random.between(std::min(wall_x, other_x), std::max(wall_x, other_x)),
               random.between(0, 3), random.between(0, 2.7));
        if (kind == 1) p = {wall_x, random.between(0.001, 2.999), random.below(2) ? 2.7 : 0.0};
        if (kind == 2) p.z() = 0;
        return p;
      };
      const Vec3 lamp = at + side(4, 0, i % 4), point = at + side(4.15, 8, (i / 4) % 4);
      // On the floor, also in its corner with the wall; or in the air, facing the wall.
      const int kind = (i / 4) % 4;
      if (kind == 0 || (kind == 1 && point.z() > at.z())) continue;
      const Vec3 normal = kind == 3 ? Vec3(-Vec3::UnitX()) : Vec3(Vec3::UnitZ());
      if (normal.dot(lamp - point) < 8 * rays.surface_error_m(lamp)) continue;
      ++configurations;
      leaks += !rays.occluded(point, normal, lamp);
    }
  }
  EXPECT_GE(configurations, 5'000);
  EXPECT_EQ(leaks, 0);
}

}  // namespace
}  // namespace luxrig
