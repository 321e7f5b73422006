// A rig whose light is not known, learnt from readings: the light at another place then has to be that of the true rig.
#include "core/calibration/rig_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/photometry/intensity.h"
#include "tests/core/calibration/box_room.h"

namespace luxrig {
namespace {

using Eigen::VectorXd;

Session room_of(double reflectance, const Vec3& lamp_m) {
  Session session;
  session.scene.object_names = {"scene"};
  box_room::add_box(session.scene, {-2, -2, 0}, {2, 2, 3}, reflectance);
  Rig& rig = session.rig;
  rig.name = "room";
  rig.luminaires.resize(1);
  rig.luminaires[0].intensity = make_isotropic(1000);
  rig.fixtures.resize(1);
  rig.fixtures[0].name = "lamp";
  rig.fixtures[0].world_from_mount.translation_m = lamp_m;
  rig.points.resize(1);
  rig.points[0].name = "wall";
  rig.points[0].position_world_m = {1.98, 0.5, 1.0};
  rig.points[0].normal_world = {-1, 0, 0};
  rig.points[0].goal_lx = 100;
  rig.luxmeters.resize(2);
  rig.luxmeters[0].position_world_m = {0.3, 0, 0.02};
  rig.luxmeters[0].normal_world = {0, 0, 1};
  rig.luxmeters[1].position_world_m = {-1, 1, 1.5};
  rig.luxmeters[1].normal_world = {-1, 0, 0};  // sees a wall alone
  session.rays = std::make_unique<RayScene>(session.scene);
  return session;
}

ComputeOptions accurate() {
  ComputeOptions options;
  options.max_error = 0.002;
  return options;
}

// Reflected light grows faster than paint: as ρ / (1 - ρ). By its change at the stated paint alone, the paint would be found
// 0.026 too bright here.
TEST(RigLight, IsTracedAnewAtThePaintThatIsFound) {
  const Vec3 lamp_m(0.2, 0.1, 2.2);
  const Session stated = room_of(0.5, lamp_m), truth = room_of(0.5 * 1.15, lamp_m);
  const auto light = compute_transport(truth, accurate());
  ASSERT_TRUE(light);
  LightPriors priors = usual_priors(stated.rig);
  priors.log_output = priors.rest_share = 1e-3;
  priors.dimmer_exponent = 0;
  priors.position_m = priors.angle_rad = 1e-4;
  priors.log_meter.setConstant(1e-3);
  auto learnt = RigLight::of(stated, priors, accurate());
  ASSERT_TRUE(learnt);
  std::vector<LightReading> readings;
  for (std::size_t m = 0; m < 2; ++m) {
    LightReading reading;
    reading.receiver = 1 + m;
    reading.meter = m;
    reading.lux = light->lux_per_level(static_cast<Eigen::Index>(1 + m), 0);
    reading.standard_error_lx = 1e-3 * reading.lux;
    reading.level = VectorXd::Ones(1);
    readings.push_back(reading);
  }
  ASSERT_TRUE(learnt->learn(readings));
  EXPECT_NEAR(learnt->known().paint(0), 1.15, 0.01);
  EXPECT_NEAR(learnt->known().at(0, VectorXd::Ones(1)).lux / light->lux_per_level(0, 0), 1, 0.01);
  EXPECT_NEAR(learnt->stated_lux()(0, 0) / compute_transport(stated, accurate())->lux_per_level(0, 0), 1, 0.006)
      << "what the file states stays";
}

}  // namespace
}  // namespace luxrig
