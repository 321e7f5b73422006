#include "tools/bench/cache/light_view.h"

#include <gtest/gtest.h>

#include "core/transport/direct/direct_light.h"
#include "tests/core/transport/lamp_pose.h"
#include "tests/tools/bench/cache/cache_rooms.h"

namespace luxrig {
namespace {

double flux_lm(const LightView& view) {
  double sum = 0;
  for (const LightViewHit& hit : view.hits) sum += hit.flux_lm;
  return sum;
}

TEST(LightView, AllFluxOfALampFallsOnTheWallsOfAClosedRoom) {
  const Scene cube = make_cube(2, 0.5);
  const RayScene rays(cube);
  Emitter area = bulb_at({0.1, 0.2, -0.3});
  area.shape = {LuminousShape::Kind::sphere, {0.2, 0, 0}};
  for (const Emitter& emitter :
       {bulb_at({0.1, 0.2, -0.3}), area,
        Emitter{make_spot(800, rad_from_deg(20), rad_from_deg(40)), lamp_at({0, 0, 0.9}, {0.3, 0.2, -1})}}) {
    const LightView view = light_view(rays, emitter, SobolSequence(7), 4096);
    EXPECT_EQ(view.hits.size(), view.rays);
    EXPECT_NEAR(flux_lm(view), emitter.intensity->flux_lm(), 0.005 * emitter.intensity->flux_lm());
  }
}

TEST(LightView, FluxOnEachFaceFollowsTheDistanceLaw) {
  const Scene cube = make_cube(2, 0.5);
  const RayScene rays(cube);
  const Emitter emitter = bulb_at({0.3, -0.2, 0.5});
  const LightView view = light_view(rays, emitter, SobolSequence(8), 1 << 15);
  const auto walls = cube_wall_grid(2, 20);
  std::vector<Receiver> receivers;
  for (const WallPoint& p : walls) receivers.push_back({p.position_m, p.normal});
  const EmitterSampler lamps(std::span(&emitter, 1));
  const auto direct = direct_light(rays, receivers, lamps, 1, 1, {});
  ASSERT_TRUE(direct.has_value());
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      double expected_lm = 0, hit_lm = 0;
      for (std::size_t i = 0; i < walls.size(); ++i)
        if (walls[i].normal[axis] == -side)
          expected_lm += direct->lux_per_level(static_cast<Eigen::Index>(i), 0) * 0.01;
      for (const LightViewHit& hit : view.hits)
        if (hit.normal_world[axis] * side < -0.5) hit_lm += hit.flux_lm;
      EXPECT_NEAR(hit_lm, expected_lm, 0.01 * expected_lm);
    }
}

TEST(LightView, ALampFlushWithTheCeilingLightsOnlyTheRoom) {
  const Scene cube = make_cube(2, 0.5);
  const RayScene rays(cube);
  const Emitter emitter{make_spot(800, rad_from_deg(60), rad_from_deg(89)), lamp_at({0.2, 0.1, 1}, {0.2, 0.1, -1})};
  const LightView view = light_view(rays, emitter, SobolSequence(9), 1024);
  EXPECT_NEAR(flux_lm(view), 800, 8);
  for (const LightViewHit& hit : view.hits) EXPECT_LT(hit.position_world_m.z(), 1 - 1e-6);
}

TEST(LightView, HasNoHitsInOpenAir) {
  const RayScene nothing{Scene{}};
  EXPECT_TRUE(light_view(nothing, bulb_at(Vec3::Zero()), SobolSequence(1), 64).hits.empty());
}

/// A uniform sky: 1 cd/m² above the horizon.
class EvenSky final : public SkyLuminance {
 public:
  double luminance_cd_m2(const Vec3& d) const override { return d.z() > 0 ? 1 : 0; }
  double horizontal_illuminance_lx() const override { return kPi; }
  DirectionSample sample(double u, double v) const override {
    const double r = std::sqrt(1 - u * u);
    return {{r * std::cos(2 * kPi * v), r * std::sin(2 * kPi * v), u}, 1 / (2 * kPi)};
  }
  double density_per_sr(const Vec3& d) const override { return d.z() > 0 ? 1 / (2 * kPi) : 0; }
};

TEST(LightView, ASkyLightsAPlaneWithItsHorizontalIlluminance) {
  Scene plane;
  plane.vertices_m = {{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {0, 2, 0}};
  plane.triangles = {{0, 1, 2}, {0, 2, 3}};
  plane.material_of_triangle = {0, 0};
  plane.materials.resize(1);
  const RayScene rays(plane);
  Emitter emitter = bulb_at(Vec3::Zero());
  emitter.sky = std::make_shared<EvenSky>();
  EXPECT_NEAR(flux_lm(light_view(rays, emitter, SobolSequence(3), 1 << 15)), 6 * kPi, 0.01 * 6 * kPi);
}

}  // namespace
}  // namespace luxrig
