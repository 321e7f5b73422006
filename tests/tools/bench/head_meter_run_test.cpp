#include "tools/bench/heads/head_meter_run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/core/calibration/box_room.h"

namespace luxrig {
namespace {

constexpr double kBeam_rad = rad_from_deg(7);
const BeamFall kFall{kBeam_rad, 2 * std::log(3.0) / (kBeam_rad * kBeam_rad)};

/// A Gaussian beam whose maximum and play are known.
std::vector<PeakSample> samples_of(const Joints& middle, const Joints& half_play, const Joints& centre, double noise,
                                   std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<PeakSample> samples;
  const double k = 2 * std::log(3.0) / (kBeam_rad * kBeam_rad), share = std::abs(std::sin(centre.tilt_rad));
  const Approach sides[] = {{1, 1}, {-1, -1}};
  for (int i = 0; i < 8; ++i) {
    const Approach from = sides[i % 2];
    const Joints sent{centre.pan_rad + kBeam_rad * std::cos(kPi * i / 4) / share,
                      centre.tilt_rad + kBeam_rad * std::sin(kPi * i / 4), 0};
    // The lamp lags by half of the play.
    const auto beam = [](double pan_rad, double tilt_rad) {
      return world_from_lamp({}, {pan_rad, tilt_rad, 0}).direction(-Vec3::UnitZ());
    };
    const Vec3 shines =
        beam(sent.pan_rad - from.pan * half_play.pan_rad, sent.tilt_rad - from.tilt * half_play.tilt_rad);
    const double off_rad = std::acos(std::min(1.0, shines.dot(beam(middle.pan_rad, middle.tilt_rad))));
    samples.push_back({sent, from, 900 * std::exp(-k / 2 * off_rad * off_rad + noise * normal(random))});
  }
  return samples;
}

TEST(LightPeak, OfAGaussianIsItsMiddleAndItsPlay) {
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int k = 0; k < 100; ++k) {
    const Joints centre{2 * unit(random), 0.4 + 0.5 * std::abs(unit(random)), 0};
    const double share = std::sin(centre.tilt_rad);
    const Joints middle{centre.pan_rad + 0.1 * kBeam_rad * unit(random) / share,
                        centre.tilt_rad + 0.1 * kBeam_rad * unit(random), 0};
    const Joints half_play{0.005, 0.005, 0};
    const auto peak = light_peak(samples_of(middle, half_play, centre, 0, random), centre, kFall, 1e-4, 0.0105);
    ASSERT_TRUE(peak);
    EXPECT_NEAR((peak->middle.pan_rad - middle.pan_rad) * share, 0, rad_from_deg(0.05));
    EXPECT_NEAR(peak->middle.tilt_rad, middle.tilt_rad, rad_from_deg(0.05));
    EXPECT_NEAR(peak->half_play.tilt_rad, 0.005, rad_from_deg(0.05));
  }
}

TEST(LightPeak, IsWithinItsErrorUnderNoise) {
  std::mt19937_64 random(22);
  int within = 0;
  constexpr int kRuns = 300;
  for (int k = 0; k < kRuns; ++k) {
    const Joints centre{0.3, 0.7, 0};
    const Joints middle{0.32, 0.71, 0};
    const auto peak =
        light_peak(samples_of(middle, {0.006, 0.004, 0}, centre, 0.03, random), centre, kFall, 0.03, 0.0105);
    ASSERT_TRUE(peak);
    const double off =
        std::hypot((peak->middle.pan_rad - middle.pan_rad) * std::sin(0.7), peak->middle.tilt_rad - middle.tilt_rad);
    within += off < 2.486 * peak->standard_error_rad;
    EXPECT_LT(peak->standard_error_rad, rad_from_deg(0.3));
  }
  EXPECT_GT(within, 0.9 * kRuns);
}

TEST(LightPeak, IsNoneWithoutLight) {
  std::vector<PeakSample> dark(8);
  EXPECT_FALSE(light_peak(dark, {0, 0.5, 0}, {kBeam_rad, 900}, 0.02, 0.01));
  EXPECT_FALSE(light_peak({}, {0, 0.5, 0}, {kBeam_rad, 900}, 0.02, 0.01));
}

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
