/// A fixture blinks to show which one it is, within limits, and then returns to its former state.
#include "core/show/identify.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/show/show_controller.h"
#include "tests/core/output/at.h"

namespace luxrig {
namespace {

/// Two lamps (the second of two emitters) and a head over two metered points.
struct IdentifyShow {
  Rig rig;
  LightModel model;
  std::unique_ptr<ShowController> show;
  double now_s = 0;

  explicit IdentifyShow(bool limited = false) {
    rig.name = "small";
    rig.buses.resize(1);
    for (const char* name : {"left", "right/warm", "right/cold", "head"}) {
      rig.fixtures.emplace_back();
      rig.fixtures.back().name = name;
    }
    rig.fixtures[1].housing = rig.fixtures[2].housing = 1;
    rig.fixtures[1].max_level = 0.8;
    Fixture& head = rig.fixtures[3];
    head.moves = true;
    head.range = {-2, 2, -1, 1};
    head.joints = {1.99, 0.2};
    head.pan_speed_rad_s = head.tilt_speed_rad_s = 2;
    for (int p = 0; p < 2; ++p) {
      rig.points.emplace_back();
      rig.points.back().goal_lx = 40;
      rig.luxmeters.emplace_back();
      rig.luxmeters.back().point = rig.points.size() - 1;
    }
    if (limited) rig.points[0].max_lx = 50;
    rig.control.fade_s = 1;
    rig.control.settle_s = 0.2;
    model.point_lux_per_level = Eigen::MatrixXd{{100, 10, 10, 5}, {10, 50, 50, 5}};
    model.meter_lux_per_level = model.point_lux_per_level;
    show = std::make_unique<ShowController>(rig, model);
  }
  [[nodiscard]] std::vector<double> levels() const {
    std::vector<double> level(4);
    show->program().levels_at(at(now_s), level);
    return level;
  }
  [[nodiscard]] Joints head() const {
    std::vector<Joints> joints(4);
    show->program().joints_at(at(now_s), joints);
    return joints[3];
  }
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds * 20)); ++i) {
      now_s += 0.05;
      const std::vector<double> level = levels();
      const Eigen::VectorXd lux = model.point_lux_per_level * Eigen::Map<const Eigen::VectorXd>(level.data(), 4) * 0.9;
      for (std::size_t m = 0; m < 2; ++m) show->reading(at(now_s), {m, lux[static_cast<Eigen::Index>(m)], at(now_s)});
      show->step(at(now_s));
    }
  }
  [[nodiscard]] ShowStatus status() const { return show->status(at(now_s)); }
};

TEST(Identify, ALampBlinksInHalfSecondsAndReturnsToItsLevel) {
  IdentifyShow small;
  small.show->apply(at(0), std::vector<double>{0.3, 0.2, 0.2, 0});
  small.run(20);
  ASSERT_EQ(small.status().phase, Phase::holding);
  const std::vector<double> before = small.levels();
  ASSERT_TRUE(small.show->identify(at(small.now_s), 0, from_seconds(3)));
  const double start_s = small.now_s;
  small.run(0.25);  // to the middle of each half
  for (int half = 0; half < 6; ++half, small.run(0.5)) {
    EXPECT_NEAR(small.levels()[0], half % 2 == 0 ? 0.5 : 0.0, 1e-9) << half;
    EXPECT_TRUE(small.status().fixtures[0].identified);
    EXPECT_NE(small.status().detail.find("left shows which one it is"), std::string::npos) << small.status().detail;
    for (std::size_t f = 1; f < 4; ++f) EXPECT_EQ(small.levels()[f], before[f]) << f;
  }
  EXPECT_TRUE(small.status().desks.empty());
  EXPECT_TRUE(small.status().alarms.empty());
  small.run(0.4);
  ASSERT_NEAR(small.now_s, start_s + 3.65, 1e-6);
  EXPECT_EQ(small.levels(), before);
  EXPECT_FALSE(small.status().fixtures[0].identified);
  // Readings taken during the blinking teach nothing. Measuring continues.
  small.run(10);
  EXPECT_EQ(small.status().phase, Phase::holding);
  for (std::size_t f = 0; f < 4; ++f) EXPECT_NEAR(small.levels()[f], before[f], 0.01) << f;
}

TEST(AimByHand, TurnsAndLightsAHeadUntilItsTimeIsOverOrItIsReleased) {
  IdentifyShow small;
  small.show->apply(at(0), std::vector<double>{0.3, 0.2, 0.2, 0});
  small.run(20);
  const std::vector<double> before = small.levels();
  const Joints looked = small.head();
  for (const bool released : {false, true}) {
    ASSERT_TRUE(small.show->aim(at(small.now_s), 3, {0.5, -0.3, 0}, 0, from_seconds(10)));
    small.run(1);
    ASSERT_TRUE(small.show->aim(at(small.now_s), 3, {0.5, -0.3, 0}, 0.7, from_seconds(5)));
    small.run(0.1);
    EXPECT_EQ(small.head(), (Joints{0.5, -0.3, 0}));
    EXPECT_NEAR(small.levels()[3], 0.7, 1e-9);
    for (std::size_t f = 0; f < 3; ++f) EXPECT_EQ(small.levels()[f], before[f]) << f;
    EXPECT_TRUE(small.status().fixtures[3].aimed_by_hand);
    EXPECT_FALSE(small.status().fixtures[3].identified);
    EXPECT_NE(small.status().detail.find("head is aimed by hand"), std::string::npos) << small.status().detail;
    if (released) EXPECT_EQ(small.show->release(at(small.now_s), std::vector<std::size_t>{3}, {}), 1u);
    small.run(released ? 1 : 6);
    EXPECT_EQ(small.head(), looked);
    EXPECT_EQ(small.levels(), before);
    EXPECT_FALSE(small.status().fixtures[3].aimed_by_hand);
  }
}

TEST(AimByHand, IsRefusedWhereItsLightOrItsWayIsNotKnown) {
  for (const bool limited : {false, true}) {
    IdentifyShow small(limited);
    const auto refused = [&](std::size_t fixture, const Joints& joints, double level, double seconds) {
      return !small.show->aim(at(small.now_s), fixture, joints, level, from_seconds(seconds));
    };
    EXPECT_TRUE(refused(3, {0.5, 0.1, 0}, 0.5, 5)) << "nothing is lit yet";
    small.show->apply(at(0), std::vector<double>{0.3, 0.2, 0.2, 0});
    small.run(5);
    EXPECT_EQ(refused(3, {0.5, 0.1, 0}, 0.5, 5), limited);
    EXPECT_TRUE(refused(3, {2.5, 0.1, 0}, 0.5, 5));
    EXPECT_TRUE(refused(3, {NAN, 0.1, 0}, 0.5, 5));
    EXPECT_TRUE(refused(3, {0.5, 0.1, 0}, 1.5, 5));
    EXPECT_TRUE(refused(3, {0.5, 0.1, 0}, 0.5, 0));
    EXPECT_TRUE(refused(0, {0.5, 0.1, 0}, 0.5, 5)) << "not a head";
    small.show->blackout(at(small.now_s), true);
    EXPECT_TRUE(refused(3, {0.5, 0.1, 0}, 0.5, 5));
  }
}

TEST(Identify, ABrightLampGoesDarkFirst) {
  IdentifyShow small;
  small.show->apply(at(0), std::vector<double>{0.9, 0, 0, 0});
  small.now_s = 5;  // before meters are heard
  small.show->step(at(5));
  const double lit = small.levels()[0];
  ASSERT_GT(lit, 0.5);
  ASSERT_TRUE(small.show->identify(at(5), 0, from_seconds(2)));
  EXPECT_EQ(small.levels()[0], 0.0);
  small.now_s = 5.75;
  small.show->step(at(5.75));
  EXPECT_NEAR(small.levels()[0], lit, 1e-9);
}

TEST(Identify, EmittersOfAHousingBlinkTogetherWithinTheirOwnLimits) {
  IdentifyShow small;
  small.show->apply(at(0), std::vector<double>{0.1, 0.7, 0.1, 0});
  small.now_s = 5;  // before meters are heard
  small.show->step(at(5));
  ASSERT_TRUE(small.show->identify(at(small.now_s), 2, from_seconds(2)));
  double warm = 0, cold = 0;
  for (int i = 0; i < 30; ++i, small.now_s += 0.05) {
    small.show->step(at(small.now_s));
    const auto level = small.levels();
    EXPECT_EQ(level[1] > 0, level[2] > 0);
    warm = std::max(warm, level[1]);
    cold = std::max(cold, level[2]);
  }
  EXPECT_GT(warm, 0.5);
  EXPECT_LE(warm, 0.8);
  EXPECT_NEAR(cold, 0.5, 1e-9);
}

TEST(Identify, AHeadNodsAwayFromItsTravelStopAndReturns) {
  IdentifyShow small;
  small.show->apply(at(0), std::vector<double>{0.3, 0.2, 0.2, 0.1});
  small.run(20);
  ASSERT_TRUE(small.show->identify(at(small.now_s), 3, from_seconds(2)));
  bool nodded = false, back = false;
  const double end_s = small.now_s + 2;
  for (; small.now_s < end_s; small.now_s += 0.05) {
    small.show->step(at(small.now_s));
    const Joints at_rad = small.head();
    EXPECT_GT(small.levels()[3], 0.49);
    nodded = nodded || std::abs(at_rad.pan_rad - (1.99 - 0.0872664626)) < 1e-6;
    back = back || (nodded && at_rad.pan_rad == 1.99);
    EXPECT_LE(at_rad.pan_rad, 2);
  }
  EXPECT_TRUE(nodded);
  EXPECT_TRUE(back);
  small.run(2);
  EXPECT_EQ(small.head().pan_rad, 1.99);
  EXPECT_EQ(small.head().tilt_rad, 0.2);
}

TEST(Identify, KeepsLimitsAndTurnsNoHeadAtLimitedPoints) {
  IdentifyShow small(true);
  small.show->apply(at(0), std::vector<double>{0.3, 0.2, 0.2, 0.1});
  small.run(20);
  double brightest_lx = 0;
  for (const std::size_t fixture : {std::size_t{0}, std::size_t{3}, std::size_t{1}}) {
    ASSERT_TRUE(small.show->identify(at(small.now_s), fixture, from_seconds(2)));
    for (double end_s = small.now_s + 3; small.now_s < end_s; small.now_s += 0.05) {
      small.show->step(at(small.now_s));
      const auto level = small.levels();
      const double lux = small.model.point_lux_per_level.row(0) * Eigen::Map<const Eigen::VectorXd>(level.data(), 4);
      ASSERT_LE(lux, 50);
      brightest_lx = std::max(brightest_lx, lux);
      ASSERT_EQ(small.head().pan_rad, 1.99);
    }
  }
  EXPECT_GT(brightest_lx, 20);
}

TEST(Identify, ARepeatedRequestExtendsIt) {
  IdentifyShow small;
  small.show->apply(at(0), std::vector<double>{0.3, 0.2, 0.2, 0});
  small.run(5);
  const double start_s = small.now_s;
  ASSERT_TRUE(small.show->identify(at(start_s), 0, from_seconds(1)));
  small.now_s = start_s + 0.75;
  small.show->step(at(small.now_s));
  ASSERT_TRUE(small.show->identify(at(small.now_s), 0, from_seconds(2)));
  EXPECT_EQ(small.levels()[0], 0);
  small.now_s = start_s + 2.2;
  small.show->step(at(small.now_s));
  EXPECT_TRUE(small.status().fixtures[0].identified);
  small.now_s = start_s + 2.8;
  small.show->step(at(small.now_s));
  EXPECT_FALSE(small.status().fixtures[0].identified);
}

TEST(Identify, IsRefusedWhereItWouldHaveNoEffect) {
  IdentifyShow small;
  EXPECT_FALSE(small.show->identify(at(0), 0, from_seconds(1)));  // nothing applied
  EXPECT_EQ(small.show->program().revision, IdentifyShow().show->program().revision);
  small.show->apply(at(0), std::vector<double>{0.3, 0, 0, 0});
  EXPECT_FALSE(small.show->identify(at(1), 0, Duration{}));
  small.show->blackout(at(1), true);
  EXPECT_FALSE(small.show->identify(at(1), 0, from_seconds(1)));
  small.show->blackout(at(2), false);
  ASSERT_TRUE(small.show->identify(at(2), 0, from_seconds(9)));
  small.show->blackout(at(3), true);  // blackout wins
  small.now_s = 3.2;
  small.show->step(at(3.2));
  EXPECT_EQ(small.levels(), std::vector<double>(4, 0.0));
}

}  // namespace
}  // namespace luxrig
