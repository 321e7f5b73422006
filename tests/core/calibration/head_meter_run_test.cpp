#include "core/calibration/head_meter_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/core/calibration/box_room.h"

namespace luxrig {
namespace {

Scene empty_hall() {
  Scene scene;
  scene.object_names = {"scene"};
  box_room::add_box(scene, {0, 0, 0}, {9, 8, 4}, 0.5);
  return scene;
}

struct MeteredHall {
  RayScene rays{empty_hall()};
  Intensity beam = make_spot(3000, rad_from_deg(12), rad_from_deg(20));
  HeadSetup setup;
  std::vector<HeadMeter> meters;

  explicit MeteredHall(std::size_t count) {
    setup.stated.translation_m = Vec3(4.4, 4.1, 3.7);
    setup.pan_speed_rad_s = setup.tilt_speed_rad_s = kPi;
    setup.beam_radius_rad = rad_from_deg(8);
    for (const Vec3& at : {Vec3(1.5, 1.5, 0.9), Vec3(7.5, 2, 0.9), Vec3(4, 7, 0.9), Vec3(7, 6.5, 0.9)})
      if (meters.size() < count) meters.push_back({at, Vec3::UnitZ(), 0.02});
  }
  HeadResult run(const HeadPose& truth, std::uint64_t seed, bool stuck = false) const {
    HeadMeterRun run(meters, *beam, rays, setup);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    Joints at;
    while (!run.next().empty()) {
      std::vector<std::vector<double>> read;
      for (const HeadMeterRun::Step& step : run.next()) {
        const Approach from{step.joints.pan_rad >= at.pan_rad ? 1 : -1, step.joints.tilt_rad >= at.tilt_rad ? 1 : -1};
        if (!stuck) at = step.joints;
        std::vector<double> lux;
        for (const HeadMeter& meter : meters) {
          const Vec3 to_m = meter.position_world_m - truth.pivot_world_m();
          const Vec3 along = truth.beam_world(at, from);
          const double angle = std::atan2(along.cross(to_m).norm(), along.dot(to_m));
          const double direct = step.lit ? beam->intensity_cd(Vec3(std::sin(angle), 0, -std::cos(angle))) *
                                               -to_m.normalized().dot(meter.normal_world) / to_m.squaredNorm()
                                         : 0;
          lux.push_back((20 + direct) * (1 + 0.02 * normal(random)));
        }
        if (step.read) read.push_back(lux);
      }
      run.take(read);
      EXPECT_LT(run.aims(), 250);
    }
    return run.result();
  }
};

HeadPose askew_head(const Pose& stated, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  HeadPose truth{stated, false, HeadPose::as_stated()};
  for (int k = 0; k < 3; ++k) truth.parameters[kHeadOffset + k] = 0.05 * normal(random);
  for (int k = 0; k < 3; ++k) truth.parameters[kHeadTurn + k] = rad_from_deg(1.67) * normal(random);
  for (int k = 0; k < 2; ++k) truth.parameters[kHeadAskew + k] = rad_from_deg(1) * normal(random);
  truth.parameters[kHeadPanPlay] = truth.parameters[kHeadTiltPlay] = rad_from_deg(1);
  return truth;
}

TEST(HeadByMeters, IsFoundByFourMeters) {
  const MeteredHall hall(4);
  std::mt19937_64 random(23);
  int found = 0;
  for (std::uint64_t k = 0; k < 4; ++k) {
    const HeadPose truth = askew_head(hall.setup.stated, random);
    const HeadResult result = hall.run(truth, k);
    if (result.refused) continue;
    ++found;
    EXPECT_EQ(result.fit.kind, HeadKind{});
    double squares = 0;
    int aims = 0;
    for (double pan = -3; pan < 3; pan += 0.7)
      for (const double tilt : {0.4, 0.7, 1.0}) {
        squares +=
            (result.fit.pose.beam_world({pan, tilt, 0}, {}) - truth.beam_world({pan, tilt, 0}, {})).squaredNorm();
        ++aims;
      }
    EXPECT_LT(std::sqrt(squares / aims), rad_from_deg(0.5)) << k;
  }
  EXPECT_GE(found, 3);
}

TEST(HeadByMeters, IsRefusedByTwoAndIfItDoesNotTurn) {
  std::mt19937_64 random(24);
  const MeteredHall two(2);
  const HeadPose truth = askew_head(two.setup.stated, random);
  EXPECT_TRUE(two.run(truth, 1).refused);
  EXPECT_TRUE(MeteredHall(0).run(truth, 1).refused);
  EXPECT_TRUE(MeteredHall(4).run(truth, 1, true).refused);
}

}  // namespace
}  // namespace luxrig
