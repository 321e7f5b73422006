#include "core/calibration/light_peak.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/rig/frames.h"
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

TEST(LightPeak, OfAFarMeterIsItsMiddleThoughTheWallBehindItThrowsLightBack) {
  std::mt19937_64 random(23);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int k = 0; k < 50; ++k) {
    const Joints centre{0.3, 1.1, 0}, middle{0.3 + 0.01 * unit(random), 1.1 + 0.01 * unit(random), 0};
    std::vector<PeakSample> samples = samples_of(middle, {0.005, 0.005, 0}, centre, 0.01, random);
    // More of it where the beam is higher; and not quite as much as was traced.
    const double share = 1 + 0.25 * unit(random);
    double without = 0;
    for (PeakSample& sample : samples) {
      sample.reflected = 0.12 + 0.9 * (sample.sent.tilt_rad - centre.tilt_rad);
      sample.lux += 900 * share * sample.reflected;
      without = std::max(without, sample.reflected);
    }
    ASSERT_GT(without, 0.2);
    const auto peak = light_peak(samples, centre, kFall, 0.01, 0.0105);
    ASSERT_TRUE(peak);
    EXPECT_LT(std::abs(peak->middle.tilt_rad - middle.tilt_rad), 3 * peak->standard_error_rad);
    EXPECT_LT(std::abs(peak->middle.tilt_rad - middle.tilt_rad), rad_from_deg(0.4));
    for (PeakSample& sample : samples) sample.reflected = 0;
    const auto misled = light_peak(samples, centre, kFall, 0.01, 0.0105);
    ASSERT_TRUE(misled);
    EXPECT_GT(std::abs(misled->middle.tilt_rad - middle.tilt_rad), std::abs(peak->middle.tilt_rad - middle.tilt_rad));
  }
}

TEST(LightPeak, WhatAWallThrowsBackIsAsInClosedForm) {
  // A narrow beam straight down on a floor; the meter hangs beside it and looks at the lit place.
  Scene scene;
  scene.object_names = {"scene"};
  box_room::add_box(scene, {-20, -20, 0}, {20, 20, 30}, 0.5);
  const RayScene rays(scene);
  const Intensity beam = make_spot(1000, rad_from_deg(2), rad_from_deg(3));
  const Pose down{Mat3::Identity(), Vec3(0, 0, 3)};
  const Vec3 at_m(2, 0, 2), to_m = at_m;
  const HeadMeter meter{at_m, -at_m.normalized()};
  const double leaves = at_m.normalized().z();
  const Vec3 straight_m = at_m - down.translation_m;
  const double peak_lx =
      beam->max_intensity_cd() * -straight_m.normalized().dot(meter.normal_world) / straight_m.squaredNorm();
  ASSERT_GT(peak_lx, 0);
  EXPECT_NEAR(reflected_over_peak(rays, meter, *beam, down) * peak_lx, 1000 * 0.5 / kPi * leaves / to_m.squaredNorm(),
              3);
}

}  // namespace
}  // namespace luxrig
