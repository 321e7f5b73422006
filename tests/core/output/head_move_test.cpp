// The closed form of a head's move, against the trapezoid that it describes: integrated, and checked against its
// limits.
#include "core/output/head_move.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/random.h"

namespace luxrig {
namespace {

/// Position of an axis t seconds after the start of the quickest move from rest to rest over `way` within its limits.
double way_at(double t, double way, const AxisLimits& limits) {
  const double peak = std::min(limits.speed, std::sqrt(way * limits.acceleration));
  const double ramp_s = peak / limits.acceleration, total_s = way / peak + ramp_s;
  if (t >= total_s) return way;
  if (t < ramp_s) return limits.acceleration * t * t / 2;
  if (t > total_s - ramp_s) return way - limits.acceleration * (total_s - t) * (total_s - t) / 2;
  return peak * (t - ramp_s / 2);
}

TEST(Trapezoid, MatchesTheClosedForm) {
  EXPECT_DOUBLE_EQ(trapezoid_s(100, 50, 25), 4);  // 2 s up and 2 s down, no time at full speed
  EXPECT_DOUBLE_EQ(trapezoid_s(200, 50, 25), 6);  // two more at full speed
  EXPECT_DOUBLE_EQ(trapezoid_s(25, 50, 25), 2);   // reaches half of the speed
  EXPECT_DOUBLE_EQ(trapezoid_s(0, 50, 25), 0);
}

TEST(HeadMove, BothAxesArriveTogetherOnAStraightLineWithinTheirLimits) {
  Random random(7);
  for (int i = 0; i < 2000; ++i) {
    const double pan_way = 540 * random.between(0, 1), tilt_way = i % 10 == 0 ? 0 : 270 * random.between(0, 1) + 1e-3;
    const AxisLimits pan{1 + 400 * random.between(0, 1), 1 + 2000 * random.between(0, 1)};
    const AxisLimits tilt{1 + 400 * random.between(0, 1), 1 + 2000 * random.between(0, 1)};
    const HeadMove move = head_move(i % 2 ? pan_way : -pan_way, tilt_way, pan, tilt);
    // Limits.
    const auto least = [](double way, const AxisLimits& own) {
      return std::min(own.speed, std::sqrt(way * own.acceleration));
    };
    EXPECT_LE(least(pan_way, move.pan), pan.speed * (1 + 1e-9));
    EXPECT_LE(least(tilt_way, move.tilt), tilt.speed * (1 + 1e-9));
    EXPECT_LE(move.pan.acceleration, pan.acceleration * (1 + 1e-9));
    EXPECT_LE(move.tilt.acceleration, tilt.acceleration * (1 + 1e-9));
    // Arrival.
    EXPECT_NEAR(trapezoid_s(pan_way, move.pan.speed, move.pan.acceleration), move.seconds, 1e-9 * move.seconds);
    if (tilt_way > 0) {
      EXPECT_NEAR(trapezoid_s(tilt_way, move.tilt.speed, move.tilt.acceleration), move.seconds, 1e-9 * move.seconds);
    }
    // No axis alone is slower. The limits of one of them bind.
    EXPECT_GE(move.seconds, trapezoid_s(pan_way, pan.speed, pan.acceleration) * (1 - 1e-9));
    EXPECT_GE(move.seconds, trapezoid_s(tilt_way, tilt.speed, tilt.acceleration) * (1 - 1e-9));
    EXPECT_TRUE(std::abs(move.pan.acceleration / pan.acceleration - 1) < 1e-9 ||
                std::abs(move.tilt.acceleration / tilt.acceleration - 1) < 1e-9);
    // The line.
    for (int step = 1; step < 8; ++step) {
      const double t = move.seconds * step / 8;
      const double pan_share = way_at(t, pan_way, move.pan) / pan_way;
      if (tilt_way > 0) {
        EXPECT_NEAR(pan_share, way_at(t, tilt_way, move.tilt) / tilt_way, 1e-9);
      }
    }
  }
}

TEST(HeadMove, AnAxisThatStaysTakesNoTime) {
  const HeadMove move = head_move(0, 0, {10, 10}, {10, 10});
  EXPECT_EQ(move.seconds, 0);
  EXPECT_EQ(move.pan.speed, 0);
  EXPECT_EQ(head_move(90, 0, {10, 10}, {1, 1}).seconds, trapezoid_s(90, 10, 10)) << "the slow axis has no say";
}

}  // namespace
}  // namespace luxrig
