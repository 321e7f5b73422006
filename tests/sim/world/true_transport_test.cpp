// The simulated truth and the planner are two worlds with the same physics: without deviations they agree, for any
// luminaires.
#include <gtest/gtest.h>

#include "core/scene/ray_scene.h"
#include "core/tasks/rig_transport.h"
#include "core/tasks/scene_builder.h"
#include "tests/sim/tiny_rig.h"

namespace luxrig::sim {
namespace {

SceneObject slab(const std::string& name, const Vec3& size_m, const Vec3& at_m, const Vec3& reflectance_rgb) {
  SceneObject object;
  object.name = name;
  object.box_m = size_m;
  object.position_world_m = at_m;
  object.reflectance_rgb = reflectance_rgb;
  return object;
}

/// Floor and a red wall; a sphere, a lamp hung at a tilt, and a moving panel; under a weak sky.
Rig odd_rig() {
  Rig rig;
  rig.name = "odd";
  rig.scene.objects = {slab("floor", {8, 8, 0.1}, {0, 0, -0.1}, {0.4, 0.4, 0.4}),
                       slab("wall", {8, 0.1, 3}, {0, 2.5, 0}, {0.8, 0.2, 0.1})};
  rig.luminaires.resize(3);
  rig.luminaires[0].intensity = make_isotropic(2000);
  rig.luminaires[0].shape = {LuminousShape::Kind::sphere, Vec3(0.5, 0, 0)};
  rig.luminaires[0].colour_rgb = Vec3(2.2, 0.72, 0.25);
  rig.luminaires[1].intensity = make_lambertian(3000);
  rig.luminaires[1].tilt = LampTilt{3, {0, 90, 180}, {1.0, 0.6, 0.4}};
  rig.luminaires[2].intensity = make_lambertian(2500);
  rig.luminaires[2].shape = {LuminousShape::Kind::rectangle, Vec3(0.8, 0.5, 0)};
  rig.luminaires[2].colour_rgb = Vec3(0.6, 1.05, 1.684764542936288);
  rig.buses.resize(1);
  rig.fixtures.resize(3);
  for (std::size_t f = 0; f < 3; ++f) {
    rig.fixtures[f].luminaire = f;
    rig.fixtures[f].world_from_mount.translation_m = Vec3(1.5 * static_cast<double>(f) - 1.5, 0, 2.5);
  }
  rig.fixtures[1].joints = {0.4, rad_from_deg(50)};
  rig.fixtures[2].joints = {0.2, rad_from_deg(30)};
  rig.fixtures[2].moves = true;
  rig.fixtures[2].pan_speed_rad_s = rig.fixtures[2].tilt_speed_rad_s = 1;
  for (int i = 0; i < 5; ++i) {
    Point point;
    point.name = "p" + std::to_string(i);
    point.position_world_m = Vec3(0.8 * i - 1.7, 0.3 * i - 0.5, 0.001);
    rig.points.push_back(point);
  }
  rig.points[4].position_world_m = Vec3(0, 2.449, 1.2);
  rig.points[4].normal_world = -Vec3::UnitY();
  rig.daylight = Daylight{};
  rig.daylight->sky = Daylight::SkyKind::overcast;
  rig.daylight->horizontal_lx = 40;
  return rig;
}

TEST(TrueTransport, MatchesThePlannerPerLuminaireWithoutDeviations) {
  const Rig rig = odd_rig();
  const auto scene = build_scene(rig);
  ASSERT_TRUE(scene);
  const RayScene rays(*scene);
  const double max_error = 0.02;
  EvaluateOptions options;
  options.wanted_relative_error = max_error;
  options.seed = Deviations::none().seed;
  const auto plan = make_path_evaluator(rays)->evaluate(receivers_of(rig), all_emitters_of(rig), options);
  ASSERT_TRUE(plan);
  const Eigen::VectorXd daylight_lx = daylight_lux(rig, *plan);
  EXPECT_GT(daylight_lx.minCoeff(), 1);
  auto world = World::make(rig, Deviations::none(), max_error);
  ASSERT_TRUE(world) << world.error().detail;
  (*world)->set_aim_target(2, rig.fixtures[2].joints);
  for (std::size_t f = 0; f < 3; ++f) {
    for (std::size_t other = 0; other < 3; ++other) (*world)->set_drive(other, other == f ? 1 : 0);
    (*world)->advance((*world)->now() + std::chrono::seconds(5));
    for (std::size_t p = 0; p < rig.points.size(); ++p) {
      const auto row = static_cast<Eigen::Index>(p);
      const double planned_lx = plan->lux_per_level(row, static_cast<Eigen::Index>(f)) + daylight_lx[row];
      // Fixed lamps: the same samples. The head's direct part comes from a quadrature, here from rays.
      EXPECT_NEAR((*world)->points()[p].lux, planned_lx, (f == 2 ? 0.01 : 1e-9) * planned_lx) << f << " at " << p;
    }
  }
}

}  // namespace
}  // namespace luxrig::sim
