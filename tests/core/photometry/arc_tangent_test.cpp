#include "core/photometry/shapes/arc_tangent.h"

#include <gtest/gtest.h>

#include <random>

namespace luxrig {
namespace {

TEST(ArcTangent, MatchesTheLibraryToRounding) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::uniform_real_distribution<double> decade(-12, 12);
  double worst = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const double y = std::abs(unit(random)) * std::pow(10, i % 2 ? decade(random) : 0);
    const double x = unit(random);
    worst = std::max(worst, std::abs(angle_rad(y, x) - std::atan2(y, x)));
  }
  EXPECT_LT(worst, 1e-15);
}

TEST(ArcTangent, IsExactOnTheAxesAndKeepsSmallAngles) {
  EXPECT_EQ(angle_rad(0, 0), 0);
  EXPECT_EQ(angle_rad(0, 1), 0);
  EXPECT_EQ(angle_rad(0, -1), kPi);
  EXPECT_EQ(angle_rad(3, 0), 0.5 * kPi);
  for (const double small : {1e-3, 1e-9, 1e-100, 1e-290}) {
    EXPECT_NEAR(angle_rad(small, 1) / std::atan2(small, 1), 1, 1e-15);
    EXPECT_NEAR(angle_rad(small, small), 0.25 * kPi, 1e-15);
  }
}

}  // namespace
}  // namespace luxrig
