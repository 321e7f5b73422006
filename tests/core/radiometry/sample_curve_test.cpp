#include "core/radiometry/sample_curve.h"

#include <gtest/gtest.h>

#include <cmath>

namespace luxrig {
namespace {

TEST(SampleCurve, FollowsPublishedValuesOfSrgbAndBt709) {
  // IEC 61966-2-1: 188/255 is half the light; the segments meet at 0.04045. Rec. BT.709: light 0.018 is sample 0.081.
  const SampleCurve srgb = SampleCurve::srgb();
  EXPECT_NEAR(srgb.light(188 / 255.0), 0.5029, 1e-4);
  EXPECT_NEAR(srgb.light(0.04045), 0.0031308, 1e-6);
  EXPECT_NEAR(srgb.light(0.5), 0.21404, 1e-5);
  EXPECT_NEAR(srgb.light(1), 1, 1e-12);
  const SampleCurve bt709 = SampleCurve::bt709();
  EXPECT_NEAR(bt709.light(0.081), 0.018, 1e-4);  // the published constants are rounded: the two parts do not quite meet
  EXPECT_NEAR(bt709.light(0.5), 0.25959, 2e-5);
}

TEST(SampleCurve, IsZeroAtTheDarkLevelAndNegativeBelow) {
  const SampleCurve linear = SampleCurve::linear(0.05);
  EXPECT_NEAR(linear.light(0.05), 0, 1e-15);
  EXPECT_NEAR(linear.light(0.525), 0.5, 1e-12);
  EXPECT_LT(linear.light(0.04), 0);
  EXPECT_NEAR(SampleCurve::srgb(0.1).light(0.1 + 0.9 * 0.5), 0.21404, 1e-5);
}

TEST(SampleCurve, RoundTrips) {
  const SampleCurve curve = SampleCurve::power(2.2, 0.03);
  const auto again = sample_curve_from_csv(to_csv(curve));
  ASSERT_TRUE(again) << again.error().detail;
  for (double x = 0; x <= 1; x += 0.01) EXPECT_NEAR(again->light(x), curve.light(x), 1e-8) << x;
}

TEST(SampleCurve, RefusesInvalidResponses) {
  const auto refused = [](const char* text) {
    const auto curve = sample_curve_from_csv(text);
    return curve ? std::string() : curve.error().detail;
  };
  EXPECT_NE(refused("x,y\n0,0\n1,1\n").find("line 1"), std::string::npos);
  EXPECT_NE(refused("sample,light\n0,0\n1;1\n").find("line 3"), std::string::npos);
  EXPECT_NE(refused("sample,light\n0,0\n").find("two points"), std::string::npos);
  EXPECT_NE(refused("sample,light\n0,0\n0.5,0.7\n1,0.6\n").find("rise"), std::string::npos);
  EXPECT_NE(refused("sample,light\n0,0\n0,1\n"), "");
  EXPECT_NE(refused("sample,light\n0,nan\n1,1\n"), "");
  EXPECT_NE(refused("sample,light\n0,0.5\n1,0.5\n"), "");
  EXPECT_NE(refused("sample,light\n0,0\n1.5,1\n"), "");
  EXPECT_EQ(refused("sample,light\r\n0,0\r\n\r\n1,1\r\n"), "");
}

}  // namespace
}  // namespace luxrig
