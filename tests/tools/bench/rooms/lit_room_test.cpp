#include "tools/bench/rooms/lit_room.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "tests/tools/bench/rooms/lit_room_fixture.h"

namespace luxrig {
namespace {

using namespace lit_room_fixture;

INSTANTIATE_TEST_SUITE_P(All, LitRooms, testing::ValuesIn(kRooms), [](const auto& of) { return of.param.name; });

TEST_P(LitRooms, HaveTheirStatedSize) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const LitRoom room = GetParam().make(seed);
    EXPECT_EQ(room.name, GetParam().name);
    EXPECT_GE(room.scene.triangles.size(), GetParam().fewest_triangles);
    EXPECT_LE(room.scene.triangles.size(), GetParam().max_triangles);
    EXPECT_EQ(room.emitters.size(), GetParam().emitters);
    EXPECT_EQ(room.receivers.size(), GetParam().receivers);
    EXPECT_EQ(room.scene.material_of_triangle.size(), room.scene.triangles.size());
    EXPECT_EQ(room.scene.object_of_triangle.size(), room.scene.triangles.size());
  }
}

TEST_P(LitRooms, AreTheSameForOneSeedAndDifferForTwo) {
  const LitRoom a = GetParam().make(5), b = GetParam().make(5), c = GetParam().make(6);
  EXPECT_EQ(a.scene.vertices_m, b.scene.vertices_m);
  EXPECT_EQ(a.scene.triangles, b.scene.triangles);
  bool other_lamp = false, other_receiver = false;
  for (std::size_t e = 0; e < a.emitters.size(); ++e) {
    EXPECT_EQ(a.emitters[e].world_from_lamp.translation_m, b.emitters[e].world_from_lamp.translation_m);
    EXPECT_EQ(a.emitters[e].intensity->flux_lm(), b.emitters[e].intensity->flux_lm());
    other_lamp |= a.emitters[e].world_from_lamp.translation_m != c.emitters[e].world_from_lamp.translation_m ||
                  a.emitters[e].intensity->flux_lm() != c.emitters[e].intensity->flux_lm();
  }
  for (std::size_t r = 0; r < a.receivers.size(); ++r) {
    EXPECT_EQ(a.receivers[r].position_world_m, b.receivers[r].position_world_m);
    other_receiver |= a.receivers[r].position_world_m != c.receivers[r].position_world_m;
  }
  EXPECT_TRUE(other_lamp);
  EXPECT_TRUE(other_receiver);
}

// Each edge of a closed surface appears once in each direction. Edges are compared by position, as boxes need not share
// vertices.
TEST_P(LitRooms, AreBuiltOfClosedSolids) {
  const Scene scene = GetParam().make(1).scene;
  using Corner = std::array<float, 3>;
  std::map<std::pair<Corner, Corner>, int> walked;
  const auto place = [&](std::uint32_t v) {
    const Vec3f& p = scene.vertices_m[v];
    return Corner{p.x(), p.y(), p.z()};
  };
  for (const auto& t : scene.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Corner a = place(t[k]), b = place(t[(k + 1) % 3]);
      ASSERT_NE(a, b);
      walked[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  for (const auto& [edge, count] : walked) ASSERT_EQ(count, 0);
}

TEST_P(LitRooms, LetNoRayOutWhenClosed) {
  const LitRoom room = GetParam().make(1);
  const RayScene rays(room.scene);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  std::size_t escaped = 0, cast = 0;
  const auto look_around = [&](const Vec3& from_m) {
    for (int i = 0; i < 400; ++i, ++cast) {
      const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
      if (!rays.nearest(from_m, direction, Vec3::Zero())) ++escaped;
    }
  };
  for (const Receiver& r : room.receivers) look_around(r.position_world_m);
  for (const Emitter& e : room.emitters) look_around(e.world_from_lamp.translation_m);
  if (GetParam().closed) {
    EXPECT_EQ(escaped, 0u);
  } else {
    EXPECT_GT(escaped, cast / 500);
    EXPECT_LT(escaped, cast / 4);
  }
}

TEST_P(LitRooms, LightEveryReceiver) {
  const LitRoom room = GetParam().make(1);
  const RayScene rays(room.scene);
  EvaluateOptions options;
  options.wanted_relative_error = 0.2;
  options.max_rays = 3'000'000;
  const auto matrix = make_path_evaluator(rays)->evaluate(room.receivers, room.emitters, options);
  ASSERT_TRUE(matrix.has_value());
  const Eigen::VectorXd lux = matrix->lux_per_level.rowwise().sum();
  EXPECT_GT(lux.minCoeff(), 0.005 * lux.mean());
  EXPECT_GT((matrix->direct_lux_per_level.rowwise().sum().array() > 0).count(), room.receivers.size() / 4);
}

TEST_P(LitRooms, HaveReflectancesOfRealRoomsAndSomeStrongColours) {
  const Scene scene = GetParam().make(1).scene;
  int saturated = 0;
  for (const Material& m : scene.materials) {
    EXPECT_GT(m.reflectance_rgb.minCoeff(), 0.0) << m.name;
    EXPECT_LT(m.reflectance_rgb.maxCoeff(), 0.9) << m.name;
    saturated += m.reflectance_rgb.maxCoeff() > 4 * m.reflectance_rgb.minCoeff();
  }
  EXPECT_GE(saturated, 1);
}

}  // namespace
}  // namespace luxrig
