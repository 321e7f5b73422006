/// Parked heads: dark first, then turned. They stay so until the next apply.
#include <gtest/gtest.h>

#include <cmath>

#include "core/show/show_controller.h"
#include "tests/core/output/at.h"

namespace luxrig {
namespace {

/// Two heads, one with a parking position, and a lamp over a metered point with a goal.
struct ParkShow {
  Rig rig;
  LightModel model;
  std::unique_ptr<ShowController> show;
  double now_s = 0;

  ParkShow() {
    rig.name = "small";
    rig.buses.resize(1);
    for (const char* name : {"rests", "stays", "lamp"}) {
      rig.fixtures.emplace_back();
      rig.fixtures.back().name = name;
    }
    for (std::size_t f = 0; f < 2; ++f) {
      rig.fixtures[f].moves = true;
      rig.fixtures[f].range = {-2, 2, -1, 1};
      rig.fixtures[f].pan_speed_rad_s = rig.fixtures[f].tilt_speed_rad_s = 2;
      rig.fixtures[f].joints = {0.5, 0.5};
    }
    rig.fixtures[0].park = Joints{-1.5, 0.9};
    rig.points.emplace_back();
    rig.points.back().goal_lx = 50;
    rig.luxmeters.emplace_back();
    rig.luxmeters.back().point = 0;
    rig.control.fade_s = 1;
    rig.control.settle_s = 0.2;
    rig.safe.level = 0.2;
    rig.safe.fade_s = 1;
    model.point_lux_per_level = Eigen::MatrixXd{{60, 10, 50}};
    model.meter_lux_per_level = model.point_lux_per_level;
    show = std::make_unique<ShowController>(rig, model);
  }
  [[nodiscard]] std::vector<double> levels() const {
    std::vector<double> level(3);
    show->program().levels_at(at(now_s), level);
    return level;
  }
  [[nodiscard]] Joints head(std::size_t f) const {
    std::vector<Joints> joints(3);
    show->program().joints_at(at(now_s), joints);
    return joints[f];
  }
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds * 20)); ++i) {
      now_s += 0.05;
      const std::vector<double> level = levels();
      const bool rests = head(0) == *rig.fixtures[0].park;
      const double lux = 0.9 * ((rests ? 0 : 60 * level[0]) + 10 * level[1] + 50 * level[2]);
      show->reading(at(now_s), {0, lux, at(now_s)});
      show->step(at(now_s));
    }
  }
  [[nodiscard]] ShowStatus status() const { return show->status(at(now_s)); }
};

TEST(ShowPark, GoesDarkThenTurnsWhileTheRestContinues) {
  ParkShow small;
  small.show->apply(at(0), std::vector<double>{0.4, 0.3, 0.4});
  small.run(20);
  ASSERT_EQ(small.status().phase, Phase::holding);
  const std::vector<double> before = small.levels();
  ASSERT_TRUE(small.show->park(at(small.now_s), {}));
  EXPECT_TRUE(small.status().fixtures[0].parked);
  EXPECT_EQ(small.status().fixtures[0].waits_for, "the next plan");
  EXPECT_FALSE(small.status().fixtures[1].parked);
  EXPECT_EQ(small.status().fixtures[1].waits_for, "");
  double turned_at_s = -1;
  for (int i = 0; i < 60; ++i) {
    small.run(0.05);
    if (small.head(0) == Joints{-1.5, 0.9} && turned_at_s < 0) {
      turned_at_s = small.now_s;
      EXPECT_EQ(small.levels()[0], 0);
    }
    EXPECT_TRUE(turned_at_s >= 0 || small.head(0) == (Joints{0.5, 0.5}));
    EXPECT_GT(small.levels()[1], 0.05);
    EXPECT_GT(small.levels()[2], 0.05);
  }
  EXPECT_GT(turned_at_s, 0);
  EXPECT_TRUE(small.status().resting);
  // The show corrects with the other lights, and the parked head stays dark.
  small.run(30);
  EXPECT_EQ(small.levels()[0], 0);
  EXPECT_GT(small.levels()[2], before[2]);
  EXPECT_EQ(small.head(1), (Joints{0.5, 0.5}));
  EXPECT_FALSE(small.show->identify(at(small.now_s), 0, from_seconds(1)));
  // The next plan ends it.
  small.show->apply(at(small.now_s), std::vector<double>{0.4, 0.3, 0.4});
  small.run(8);
  EXPECT_EQ(small.head(0), (Joints{0.5, 0.5}));
  EXPECT_GT(small.levels()[0], 0.2);
  EXPECT_FALSE(small.status().fixtures[0].parked);
}

TEST(ShowPark, ADeskNeitherLightsNorTurnsAParkedHead) {
  ParkShow small;
  ASSERT_EQ(small.show->add_desk({DeskMode::takeover, HandBack::at_once}, {"desk", {0, 2}}), 0u);
  small.show->apply(at(0), std::vector<double>{0.4, 0.3, 0.4});
  const DeskFrame frame{DeskPresence::present, {{0, 1.0, Joints{1, 0}}, {2, 1.0, std::nullopt}}, "desk"};
  small.show->desk(at(0), 0, frame);
  small.run(8);
  ASSERT_EQ(small.levels()[0], 1);
  ASSERT_EQ(small.head(0), (Joints{1, 0}));
  ASSERT_TRUE(small.show->park(at(small.now_s), std::vector<std::size_t>{0}));
  small.run(8);
  EXPECT_EQ(small.levels()[0], 0);
  EXPECT_EQ(small.head(0), (Joints{-1.5, 0.9}));
  EXPECT_EQ(small.levels()[2], 1);
}

TEST(ShowPark, IsRefusedWithoutAParkPosition) {
  ParkShow small;
  const auto refused = small.show->park(at(0), std::vector<std::size_t>{1});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().detail, "stays has no place to rest: give it park_pan_deg and park_tilt_deg");
  EXPECT_FALSE(small.show->park(at(0), std::vector<std::size_t>{2}));
  small.rig.fixtures[0].park.reset();
  ShowController without(small.rig, small.model);
  EXPECT_FALSE(without.park(at(0), {}));
}

TEST(ShowPark, HeadsTurnInTheDarkBeforeAnyPlan) {
  ParkShow small;
  ASSERT_TRUE(small.show->park(at(0), {}));
  small.run(6);
  EXPECT_EQ(small.head(0), (Joints{-1.5, 0.9}));
  EXPECT_EQ(small.levels(), std::vector<double>(3, 0.0));
}

TEST(ShowPark, WorksRightAfterAPlanAsAfterARestart) {
  ParkShow small;
  small.show->apply(at(0), std::vector<double>{0.4, 0.3, 0.4});
  ASSERT_TRUE(small.show->park(at(0), {}));  // no step between the two
  for (int i = 0; i < 200; ++i) {
    small.run(0.05);
    ASSERT_EQ(small.levels()[0], 0);
  }
  EXPECT_EQ(small.head(0), (Joints{-1.5, 0.9}));
  EXPECT_GT(small.levels()[2], 0.1);
}

TEST(ShowPark, TheSafeLookLeavesParkedHeadsDark) {
  ParkShow small;
  small.show->apply(at(0), std::vector<double>{0.4, 0.3, 0.4});
  small.run(8);
  ASSERT_TRUE(small.show->park(at(small.now_s), {}));
  small.run(6);
  small.show->go_safe(at(small.now_s));
  small.run(3);
  EXPECT_EQ(small.levels()[0], 0);
  EXPECT_NEAR(small.levels()[2], 0.2, 1e-9);
  EXPECT_FALSE(small.show->park(at(small.now_s), {}));
}

TEST(ShowPark, ANewPlanWinsAndAFailureWaits) {
  ParkShow small;
  small.show->apply(at(0), std::vector<double>{0.4, 0.3, 0.4});
  small.run(8);
  ASSERT_TRUE(small.show->park(at(small.now_s), {}));
  small.run(0.3);  // on its way to dark
  small.show->apply(at(small.now_s), std::vector<double>{0.5, 0.3, 0.4});
  small.run(6);
  EXPECT_GT(small.levels()[0], 0.3);
  EXPECT_EQ(small.head(0), (Joints{0.5, 0.5}));
  const std::vector<Health> dead = {{"", Life::faulted, "", {}, {}}}, well = {{"", Life::active, "", {}, {}}};
  small.show->health(at(small.now_s), dead);
  small.run(1.5);
  ASSERT_EQ(small.status().phase, Phase::frozen);
  ASSERT_TRUE(small.show->park(at(small.now_s), {}));
  small.run(0.5);
  EXPECT_GT(small.levels()[0], 0.3);
  small.show->health(at(small.now_s), well);
  small.run(6);
  EXPECT_EQ(small.levels()[0], 0);
  EXPECT_EQ(small.head(0), (Joints{-1.5, 0.9}));
}

}  // namespace
}  // namespace luxrig
