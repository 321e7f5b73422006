#include "tools/bench/rooms/lit_room.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "core/transport/candidates/air_regions.h"

namespace luxrig {
namespace {

struct Expected {
  const char* name;
  LitRoom (*make)(std::uint64_t);
  std::size_t fewest_triangles, most_triangles, emitters, receivers;
  bool closed;
};
constexpr Expected kRooms[] = {
    {"box", [](std::uint64_t seed) { return make_box_room(seed); }, 100, 160, 2, 60, true},
    {"flat", [](std::uint64_t seed) { return make_eight_room_flat(seed); }, 570, 640, 10, 300, true},
    {"gallery", [](std::uint64_t seed) { return make_gallery_hall(seed); }, 37'000, 39'000, 12, 300, true},
    {"atrium", [](std::uint64_t seed) { return make_atrium(seed); }, 8'000, 11'000, 46, 300, false},
    {"office", [](std::uint64_t seed) { return make_open_plan_office(seed); }, 3'000, 3'200, 9, 300, true},
    {"sewers", [](std::uint64_t seed) { return make_sewers(seed); }, 20'000, 28'000, 11, 300, true},
    {"cloister", [](std::uint64_t seed) { return make_cloister(seed); }, 20'000, 26'000, 16, 300, false},
    {"museum", [](std::uint64_t seed) { return make_museum(seed); }, 50'000, 100'000, 18, 360, true},
    {"studio", [](std::uint64_t seed) { return make_studio(seed); }, 110'000, 170'000, 2, 300, true},
    {"colonnades", [](std::uint64_t seed) { return make_colonnades(seed); }, 45'000, 65'000, 22, 300, false},
};

void PrintTo(const Expected& expected, std::ostream* out) { *out << expected.name; }

class LitRooms : public testing::TestWithParam<Expected> {};
INSTANTIATE_TEST_SUITE_P(All, LitRooms, testing::ValuesIn(kRooms), [](const auto& of) { return of.param.name; });

TEST_P(LitRooms, HaveTheSizeTheyPromise) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const LitRoom room = GetParam().make(seed);
    EXPECT_EQ(room.name, GetParam().name);
    EXPECT_GE(room.scene.triangles.size(), GetParam().fewest_triangles);
    EXPECT_LE(room.scene.triangles.size(), GetParam().most_triangles);
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

// Receivers and lamps share one air, also where a seed is of another kind than those that were looked at.
TEST_P(LitRooms, HaveReceiversAndLampsInOneAirForAnySeed) {
  for (const std::uint64_t seed : {0ULL, ~0ULL, 1ULL << 63, 0x5555555555555555ULL}) {
    const LitRoom room = GetParam().make(seed);
    EXPECT_EQ(room.receivers.size(), GetParam().receivers);
    const AirRegions regions(room.scene);
    const std::uint64_t air = regions.mark(room.emitters.front().world_from_lamp.translation_m);
    for (const Receiver& r : room.receivers) ASSERT_EQ(regions.mark(r.position_world_m), air);
    for (const Emitter& e : room.emitters) {
      ASSERT_EQ(regions.mark(e.world_from_lamp.translation_m), air);
      EXPECT_TRUE(room.interior_m.contains(e.world_from_lamp.translation_m));
    }
    for (std::size_t a = 0; a < room.regions_m.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        EXPECT_LT(room.regions_m[a].intersection(room.regions_m[b]).sizes().minCoeff(), 1e-9);
  }
}

// Each edge of a closed surface is walked once in each direction: by place, since boxes need not share vertices.
TEST_P(LitRooms, AreBuiltOfClosedSolids) {
  const Scene scene = GetParam().make(1).scene;
  using Place = std::array<float, 3>;
  std::map<std::pair<Place, Place>, int> walked;
  const auto place = [&](std::uint32_t v) {
    const Vec3f& p = scene.vertices_m[v];
    return Place{p.x(), p.y(), p.z()};
  };
  for (const auto& t : scene.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Place a = place(t[k]), b = place(t[(k + 1) % 3]);
      ASSERT_NE(a, b);
      walked[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  for (const auto& [edge, count] : walked) ASSERT_EQ(count, 0);
}

/// How many solids the point is in: crossings of a ray, each with the sign of the side it comes from.
int solids_around(const Scene& scene, const Vec3& point_m) {
  const Vec3 towards = Vec3(0.3217, 0.5419, 0.7764).normalized();
  int count = 0;
  for (const auto& t : scene.triangles) {
    const Vec3 a = scene.vertex_world_m(t[0]) - point_m, b = scene.vertex_world_m(t[1]) - point_m,
               c = scene.vertex_world_m(t[2]) - point_m;
    const double u = towards.dot(c.cross(b)), v = towards.dot(a.cross(c)), w = towards.dot(b.cross(a));
    const bool leaving = u <= 0 && v <= 0 && w <= 0, entering = u >= 0 && v >= 0 && w >= 0;
    if (!leaving && !entering) continue;
    const Vec3 normal = (b - a).cross(c - a);
    if (normal.dot(a) * normal.dot(towards) <= 0) continue;  // behind the point, or in the ray's plane
    count += normal.dot(towards) > 0 ? 1 : -1;
  }
  return count;
}

TEST_P(LitRooms, HaveReceiversAndLampsInFreeSpace) {
  for (const std::uint64_t seed : {1, 2}) {
    const LitRoom room = GetParam().make(seed);
    // Brute force: of large rooms some receivers only. AirRegions judges all of them above.
    const std::size_t step = 1 + room.scene.triangles.size() / 20'000;
    for (std::size_t i = 0; i < room.receivers.size(); i += step) {
      const Receiver& r = room.receivers[i];
      EXPECT_NEAR(r.normal_world.norm(), 1, 1e-12);
      ASSERT_EQ(solids_around(room.scene, r.position_world_m), 0) << r.position_world_m.transpose();
    }
    for (const Emitter& e : room.emitters) ASSERT_EQ(solids_around(room.scene, e.world_from_lamp.translation_m), 0);
  }
  // The count itself: half a metre below the floor's top is in the floor's slab.
  const LitRoom room = GetParam().make(1);
  EXPECT_GT(solids_around(room.scene, {1.234, 1.111, -0.1}), 0);
}

TEST_P(LitRooms, LetNoRayOutWhenTheyAreClosed) {
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
