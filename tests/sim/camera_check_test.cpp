/// The camera check judges simulated sensors of known truth correctly.
#include "core/radiometry/camera_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/devices/video_sensor.h"

namespace luxrig {
namespace {

using sim::Encoding;
using sim::SensorTruth;

/// A smooth, still scene that spans two decades of light.
std::vector<double> scene_of(const SensorTruth& truth, double full_after_s = 0.02) {
  std::vector<double> scene;
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x)
      scene.push_back(truth.full_well_electrons / full_after_s * std::pow(10.0, -2 * x / 159.0) *
                      (1 + 0.2 * std::sin(0.3 * y)));
  return scene;
}

ExposureSeries series_of(const SensorTruth& truth, double shortest_s = 0.001, double longest_s = 0.5) {
  ExposureSeries series;
  series.full_scale_counts = truth.full_scale_counts;
  const std::vector<double> scene = scene_of(truth);
  std::uint64_t number = 0;
  double at_s = 0;
  for (const double exposure_s : exposures_between(shortest_s, longest_s, 10)) {
    ExposureStep step{exposure_s, {}};
    for (int f = 0; f < 5; ++f, at_s += exposure_s + 0.0333)
      step.frames.push_back(sim::expose(truth, scene, exposure_s, at_s, ++number));
    series.steps.push_back(std::move(step));
  }
  return series;
}

CameraCheck judged(const SensorTruth& truth, const SampleCurve& configured = SampleCurve::linear()) {
  const auto check = check_camera(series_of(truth), configured);
  EXPECT_TRUE(check) << (check ? "" : check.error().detail);
  return check ? *check : CameraCheck{};
}

bool says(const CameraCheck& check, const char* text) {
  for (const CameraFinding& finding : check.findings)
    if (finding.what.find(text) != std::string::npos || finding.mend.find(text) != std::string::npos) return true;
  return false;
}

/// Root mean square of ln(light by the curve / true light), over light from 1 to 99 % of full, at any scale.
double curve_error(const SampleCurve& curve, const SensorTruth& truth) {
  double sum = 0, squares = 0;
  int count = 0;
  for (double light = 0.01; light < 0.99; light *= 1.05, ++count) {
    const double off = std::log(curve.light(sim::sample_of(truth, light)) / light);
    sum += off;
    squares += off * off;
  }
  return std::sqrt(squares / count - sum / count * (sum / count));
}

TEST(CameraCheck, MeasuresDarkLevelFullWellAndNoiseOfALinearSensor) {
  SensorTruth truth;
  truth.dark_share = 0.02;
  const CameraCheck check = judged(truth, SampleCurve::linear(0.02));
  EXPECT_TRUE(check.linear);
  EXPECT_TRUE(check.good);
  EXPECT_LT(check.as_it_is.rms_residual, 0.001);
  EXPECT_NEAR(check.as_it_is.dark_share, 0.02, 0.0001);
  EXPECT_TRUE(check.saturates);
  EXPECT_NEAR(check.saturation, 1, 1e-9);
  ASSERT_TRUE(check.noise);
  const double truly = truth.full_well_electrons / (truth.full_scale_counts * (1 - truth.dark_share));
  EXPECT_NEAR(check.noise->electrons_per_count, truly, 0.03 * truly);
  EXPECT_NEAR(check.noise->full_electrons, 20000, 600);
  EXPECT_NEAR(check.noise->read_noise_electrons, 5, 0.5);
  EXPECT_TRUE(check.findings.empty()) << check.findings.front().what;
}

TEST(CameraCheck, AsksForAMissingDarkLevel) {
  SensorTruth truth;
  truth.dark_share = 0.03;
  const CameraCheck check = judged(truth);
  EXPECT_TRUE(check.linear);
  EXPECT_TRUE(says(check, "write dark_level = 0.03"));
}

TEST(CameraCheck, RecognisesALinearEightBitSensor) {
  SensorTruth truth;
  truth.full_scale_counts = 255;
  const CameraCheck check = judged(truth);
  EXPECT_TRUE(check.linear);
  EXPECT_LT(check.as_it_is.rms_residual, 0.002);
  EXPECT_NEAR(check.as_it_is.dark_share, 0, 0.0005);
  ASSERT_TRUE(check.noise);
  EXPECT_NEAR(check.noise->electrons_per_count, 20000 / 255.0, 0.05 * 20000 / 255.0);
  truth.full_well_electrons = 4e6;  // noise never reaches one count
  truth.read_noise_electrons = 50;
  EXPECT_FALSE(judged(truth).noise) << "told from rounding";
}

struct Coded {
  Encoding encoding;
  double gamma;
  const char* name;
  double exponent;  ///< 0 = the standard's name is enough
};

class CameraWithACurve : public ::testing::TestWithParam<Coded> {};

TEST_P(CameraWithACurve, IsReportedAndItsCurveIsRecovered) {
  const Coded& coded = GetParam();
  for (const double full_well : {20000.0, 2000.0}) {
    SensorTruth truth;
    truth.full_scale_counts = 255;
    truth.full_well_electrons = full_well;
    truth.encoding = coded.encoding;
    truth.gamma = coded.gamma;
    const CameraCheck check = judged(truth);
    EXPECT_FALSE(check.linear);
    EXPECT_FALSE(check.good);
    EXPECT_TRUE(check.usable);
    EXPECT_GT(check.as_it_is.rms_residual, 0.05);
    EXPECT_TRUE(says(check, "gamma"));
    EXPECT_STREQ(check.shape.name, coded.name);
    if (coded.exponent > 0) {
      EXPECT_NEAR(check.shape.exponent, coded.exponent, (full_well > 10000 ? 0.005 : 0.015) * coded.exponent);
    }
    ASSERT_TRUE(check.curve);
    EXPECT_LT(curve_error(*check.curve, truth), full_well > 10000 ? 0.003 : 0.012);
    EXPECT_LT(check.through_curve.rms_residual, 0.002);
    // The same camera is good with the curve in the rig file.
    const auto written = sample_curve_from_csv(to_csv(*check.curve));
    ASSERT_TRUE(written);
    EXPECT_TRUE(judged(truth, *written).good);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, CameraWithACurve,
    ::testing::Values(Coded{Encoding::srgb, 1, "srgb", 0}, Coded{Encoding::bt709, 1, "bt709", 0},
                      Coded{Encoding::power, 1.4, "power", 1.4}, Coded{Encoding::power, 1.8, "power", 1.8},
                      Coded{Encoding::power, 2.2, "power", 2.2}, Coded{Encoding::power, 2.6, "power", 2.6}),
    [](const auto& coded) {
      return std::string(coded.param.name) + std::to_string(static_cast<int>(10 * coded.param.gamma));
    });

TEST(CameraCheck, AcceptsTheCurveOfTheRigFile) {
  SensorTruth truth;
  truth.full_scale_counts = 255;
  truth.encoding = Encoding::srgb;
  const CameraCheck check = judged(truth, SampleCurve::srgb());
  EXPECT_FALSE(check.linear);
  EXPECT_TRUE(check.good);
  EXPECT_TRUE(check.findings.empty()) << check.findings.front().what;
  const CameraCheck wrong = judged(SensorTruth{}, SampleCurve::srgb());
  EXPECT_TRUE(wrong.linear);
  EXPECT_FALSE(wrong.good);
  EXPECT_TRUE(says(wrong, "write response = \"linear\""));
}

TEST(CameraCheck, DetectsASensorThatBendsNearFullScale) {
  SensorTruth truth;
  truth.bend = 0.1;
  const CameraCheck check = judged(truth);
  EXPECT_FALSE(check.linear);
  EXPECT_GT(check.as_it_is.rms_residual, 0.02);
  ASSERT_TRUE(check.curve);
  EXPECT_LT(curve_error(*check.curve, truth), 0.003);
}

TEST(CameraCheck, DetectsClipping) {
  SensorTruth truth;
  truth.clips_at = 0.8;
  const CameraCheck check = judged(truth);
  EXPECT_TRUE(check.linear);
  EXPECT_TRUE(check.saturates);
  EXPECT_NEAR(check.saturation, 0.8, 0.001);
  const auto dim = check_camera(series_of(SensorTruth{}, 0.0005, 0.004), SampleCurve::linear());
  ASSERT_TRUE(dim);
  EXPECT_FALSE(dim->saturates);
  EXPECT_TRUE(says(*dim, "full samples were not seen"));
  const auto bright = check_camera(series_of(SensorTruth{}, 0.1, 5), SampleCurve::linear());
  ASSERT_TRUE(bright);
  EXPECT_TRUE(says(*bright, "full at the shortest exposure"));
}

TEST(CameraCheck, DetectsFlickerAndIsNotMisledByIt) {
  SensorTruth truth;
  truth.flicker_depth = 0.2;
  const CameraCheck check = judged(truth);
  EXPECT_GT(check.flicker, 0.02);
  EXPECT_TRUE(says(check, "flickers"));
  EXPECT_TRUE(check.linear) << check.as_it_is.rms_residual;
  EXPECT_LT(judged(SensorTruth{}).flicker, 0.003);
}

TEST(CameraCheck, DetectsAutomaticExposure) {
  // The camera chooses its exposure so that every picture is equally bright.
  const SensorTruth truth;
  ExposureSeries series = series_of(truth);
  for (std::size_t s = 0; s < series.steps.size(); ++s)
    for (std::size_t f = 0; f < 5; ++f)
      series.steps[s].frames[f] = sim::expose(truth, scene_of(truth), 0.01, 0, 100 * s + f);
  const auto check = check_camera(series, SampleCurve::linear());
  ASSERT_TRUE(check);
  EXPECT_FALSE(check->usable);
  EXPECT_FALSE(check->good);
  EXPECT_TRUE(says(*check, "automatic exposure"));
}

TEST(CameraCheck, DetectsInaccurateExposures) {
  const SensorTruth truth;
  ExposureSeries series = series_of(truth);
  for (std::size_t f = 0; f < 5; ++f)
    series.steps[4].frames[f] = sim::expose(truth, scene_of(truth), 1.1 * series.steps[4].exposure_s, 0, 1000 + f);
  const auto check = check_camera(series, SampleCurve::linear());
  ASSERT_TRUE(check);
  EXPECT_TRUE(says(*check, "does not keep its exposure"));
}

TEST(CameraCheck, RefusesInvalidSeries) {
  EXPECT_FALSE(check_camera({}, SampleCurve::linear()));
  ExposureSeries series = series_of(SensorTruth{});
  std::swap(series.steps[0], series.steps[1]);
  EXPECT_FALSE(check_camera(series, SampleCurve::linear()));
  series = series_of(SensorTruth{});
  series.steps[0].frames[1].pop_back();
  EXPECT_FALSE(check_camera(series, SampleCurve::linear()));
  series = series_of(SensorTruth{});
  series.steps[0].frames[1][7] = NAN;
  EXPECT_FALSE(check_camera(series, SampleCurve::linear()));
  // A covered lens.
  for (ExposureStep& step : series.steps)
    for (auto& frame : step.frames) std::fill(frame.begin(), frame.end(), 0.01f);
  EXPECT_FALSE(check_camera(series, SampleCurve::linear()));
}

}  // namespace
}  // namespace luxrig
