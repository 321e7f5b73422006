/// The camera check by dimmer levels judges simulated sensors and dimmers of known truth correctly.
#include "core/radiometry/level_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/devices/dimmer.h"
#include "sim/devices/video_sensor.h"

namespace luxrig {
namespace {

using sim::Encoding;
using sim::SensorTruth;

struct LitScene {
  SensorTruth sensor;
  double dimmer_exponent = 1;  ///< exponent between the stated curve (linear) and the true one
  double decades = 2;          ///< range of light over the picture
  double other_light = 0;      ///< share of the dimmer's light at full
  SampleCurve configured = SampleCurve::linear();
};

constexpr double kHeldExposure_s = 0.02;

LevelStep step_of(const LitScene& lit, double level, std::uint64_t& number) {
  sim::Dimmer dimmer({DimmerCurve::linear, lit.dimmer_exponent});
  dimmer.set_drive(level);
  std::vector<double> scene;
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) {
      const double place = std::pow(10.0, -lit.decades * x / 159.0) * (1 + 0.1 * std::sin(0.3 * y));
      // Other light comes from the other side.
      const double other = lit.other_light * std::pow(10.0, -lit.decades * (159 - x) / 159.0);
      scene.push_back(0.9 * lit.sensor.full_well_electrons / kHeldExposure_s *
                      (place * dimmer.settled_level() + other));
    }
  LevelStep step{level, {}};
  for (int f = 0; f < 5; ++f) {
    auto frame = sim::expose(lit.sensor, scene, kHeldExposure_s, static_cast<double>(number), number + 1);
    ++number;
    for (float& sample : frame) sample = static_cast<float>(lit.configured.light(static_cast<double>(sample)));
    step.frames.push_back(std::move(frame));
  }
  return step;
}

LevelSeries series_by_levels(const LitScene& lit) {
  LevelSeries series;
  series.full_scale_counts = lit.sensor.full_scale_counts;
  std::uint64_t number = 0;
  series.dark = step_of(lit, 0, number);
  for (const double level : {0.05, 0.1, 0.18, 0.3, 0.42, 0.58, 0.7, 0.85, 1.0})
    series.steps.push_back(step_of(lit, level, number));
  return series;
}

LevelCheck judged_by_levels(const LitScene& lit) {
  const auto check = check_by_levels(series_by_levels(lit));
  EXPECT_TRUE(check) << (check ? "" : check.error().detail);
  return check ? *check : LevelCheck{};
}

bool told(const LevelCheck& check, const char* text) {
  for (const CameraFinding& finding : check.findings)
    if (finding.what.find(text) != std::string::npos || finding.mend.find(text) != std::string::npos) return true;
  return false;
}

TEST(LevelCheck, RecognisesALinearCameraWithALinearDimmer) {
  LitScene lit;
  lit.sensor.dark_share = 0.02;
  lit.configured = SampleCurve::linear(0.02);
  const LevelCheck check = judged_by_levels(lit);
  EXPECT_TRUE(check.camera_told);
  EXPECT_LT(check.camera_rms, 0.002);
  EXPECT_LT(check.line_rms, 0.003);
  EXPECT_NEAR(check.exponent, 1, 0.003);
  EXPECT_TRUE(check.good);
  EXPECT_TRUE(check.findings.empty()) << check.findings.front().what;
}

TEST(LevelCheck, SeparatesTheDimmersCurveFromALinearCamera) {
  for (const double exponent : {0.93, 1.08, 2.0}) {
    LitScene lit;
    lit.dimmer_exponent = exponent;
    const LevelCheck check = judged_by_levels(lit);
    EXPECT_TRUE(check.camera_linear) << check.camera_rms;
    EXPECT_FALSE(check.good);
    EXPECT_NEAR(check.exponent, exponent, 0.005 * exponent);
    EXPECT_LT(std::abs(check.exponent - exponent), 4 * check.exponent_error + 0.003 * exponent);
    EXPECT_TRUE(told(check, "levels alone cannot tell apart"));
    for (const SeenLevel& seen : check.seen)
      EXPECT_NEAR(seen.light, std::pow(seen.level, exponent), 0.01 * std::pow(seen.level, exponent) + 0.0005);
  }
}

TEST(LevelCheck, RecognisesACurvedCameraForAnyDimmer) {
  for (const double exponent : {1.0, 0.9, 2.0}) {
    LitScene srgb;
    srgb.sensor.encoding = Encoding::bt709;
    srgb.dimmer_exponent = exponent;
    const LevelCheck check = judged_by_levels(srgb);
    EXPECT_TRUE(check.camera_told);
    EXPECT_FALSE(check.camera_linear) << check.camera_rms;
    EXPECT_TRUE(told(check, "do not grow in proportion"));
    LitScene bent;
    bent.sensor.bend = 0.15;
    bent.dimmer_exponent = exponent;
    EXPECT_FALSE(judged_by_levels(bent).camera_linear);
  }
}

TEST(LevelCheck, ReportsThatCameraAndDimmerPowersAreIndistinguishable) {
  LitScene camera;
  camera.sensor.encoding = Encoding::power;
  camera.sensor.gamma = 2;  // samples are the square root of light
  LitScene dimmer;
  dimmer.dimmer_exponent = 0.5;
  for (const LitScene& lit : {camera, dimmer}) {
    const LevelCheck check = judged_by_levels(lit);
    EXPECT_FALSE(check.good);
    // A curve that is steep in the dark turns noise cut off at 0 into a level.
    EXPECT_NEAR(check.exponent, 0.5, 0.03);
    EXPECT_TRUE(told(check, "levels alone cannot tell apart"));
    EXPECT_TRUE(told(check, "check the camera by exposures"));
  }
}

TEST(LevelCheck, IsNotMisledByAmbientLight) {
  LitScene lit;
  lit.other_light = 0.3;
  lit.sensor.full_well_electrons = 40000;
  lit.dimmer_exponent = 1.08;
  const LevelCheck check = judged_by_levels(lit);
  EXPECT_TRUE(check.camera_linear) << check.camera_rms;
  EXPECT_NEAR(check.exponent, 1.08, 0.006);
  EXPECT_NEAR(check.other_light, 0.3 / 1.3, 0.03);
}

TEST(LevelCheck, ReportsAnUnsuitableScene) {
  LitScene flat;
  flat.decades = 0.1;
  const LevelCheck check = judged_by_levels(flat);
  EXPECT_FALSE(check.camera_told);
  EXPECT_FALSE(check.good);
  EXPECT_TRUE(told(check, "cannot be told from one of the dimmer"));
  EXPECT_NEAR(check.exponent, 1, 0.003);
}

TEST(LevelCheck, RefusesUninformativeSeries) {
  LevelSeries series = series_by_levels({});
  LevelSeries undark = series;
  undark.dark.frames.clear();
  EXPECT_NE(check_by_levels(undark).error().detail.find("level 0"), std::string::npos);
  LevelSeries falling = series;
  std::swap(falling.steps[1], falling.steps[2]);
  EXPECT_EQ(check_by_levels(falling).error().cause, Cause::invalid);
  LevelSeries above = series;
  above.steps.back().level = 1.5;
  EXPECT_EQ(check_by_levels(above).error().cause, Cause::invalid);
  LevelSeries sizes = series;
  sizes.steps[3].frames[1].pop_back();
  EXPECT_EQ(check_by_levels(sizes).error().cause, Cause::invalid);
  LevelSeries black = series;
  for (LevelStep& step : black.steps)
    for (auto& frame : step.frames) std::fill(frame.begin(), frame.end(), 0.0f);
  EXPECT_EQ(check_by_levels(black).error().cause, Cause::invalid);
}

}  // namespace
}  // namespace luxrig
