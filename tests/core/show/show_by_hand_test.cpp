// Levels set by hand during the show stay, within limits. The rest is solved around them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/show/show_controller.h"
#include "tests/core/output/at.h"

namespace luxrig {
namespace {

ByHand level_by_hand(std::size_t fixture, double level) { return {ByHand::What::level, fixture, level}; }
ByHand goal_by_hand(std::size_t point, double lux) { return {ByHand::What::goal, point, lux}; }

/// Two spots, each over one point, and a wash that lights both: 100 lx per level below a spot, 10 from the other, 50 of
/// the wash. Both points have a goal of 40 lx, the left one a limit of 50.
struct HandShow {
  Rig rig;
  LightModel model;
  Eigen::Vector3d gain{0.9, 0.95, 1.0};  ///< the truth
  std::unique_ptr<ShowController> show;
  double now_s = 0;

  explicit HandShow(bool metered = true) {
    rig.name = "small";
    rig.buses.resize(2);
    rig.buses[0].name = "lights";
    rig.buses[1].name = "meters";
    for (const char* name : {"left", "right", "wash"}) {
      rig.fixtures.emplace_back();
      rig.fixtures.back().name = name;
    }
    for (const char* name : {"below left", "below right"}) {
      rig.points.emplace_back();
      rig.points.back().name = name;
      rig.points.back().goal_lx = 40;
      if (!metered) continue;
      rig.luxmeters.emplace_back();
      rig.luxmeters.back().name = std::string("meter ") + name;
      rig.luxmeters.back().point = rig.points.size() - 1;
      rig.luxmeters.back().bus = 1;
    }
    rig.points[0].max_lx = 50;
    rig.control.fade_s = 1;
    rig.control.settle_s = 0.2;
    rig.safe.hold_s = 2;
    model.point_lux_per_level = Eigen::MatrixXd{{100, 10, 50}, {10, 100, 50}};
    if (metered) model.meter_lux_per_level = model.point_lux_per_level;
    show = std::make_unique<ShowController>(rig, model);
  }
  [[nodiscard]] Time now() const { return at(now_s); }
  [[nodiscard]] ShowStatus status() const { return show->status(now()); }
  [[nodiscard]] std::vector<double> levels() const {
    std::vector<double> level(3);
    show->program().levels_at(now(), level);
    return level;
  }
  [[nodiscard]] Eigen::Vector2d lux() const {
    const std::vector<double> level = levels();
    return model.point_lux_per_level * Eigen::Vector3d(gain[0] * level[0], gain[1] * level[1], gain[2] * level[2]);
  }
  void run(double seconds) {
    const int steps = static_cast<int>(std::lround(seconds * 20));
    for (int i = 0; i < steps; ++i) {
      now_s += 0.05;
      const Eigen::Vector2d there = lux();
      for (std::size_t m = 0; m < rig.luxmeters.size(); ++m)
        show->reading(now(), {m, there[static_cast<Eigen::Index>(m)], now()});
      show->step(now());
    }
  }
  /// Like a plan solved for these levels, some of which were then changed by hand.
  [[nodiscard]] Look look(std::vector<std::optional<double>> goals,
                          std::vector<std::optional<double>> solved = {}) const {
    Look look;
    for (const Fixture& fixture : rig.fixtures) look.joints.push_back(fixture.joints);
    look.goal_lx = std::move(goals);
    look.solved_levels = std::move(solved);
    return look;
  }
};

Look with_levels(Look look, std::vector<double> levels) {
  look.levels = std::move(levels);
  return look;
}

TEST(ByHand, LevelsSetByHandInAPlanStayThroughCorrections) {
  HandShow show;
  show.show->apply(
      show.now(),
      with_levels(show.look({40, 40}, {std::optional(0.33), std::optional(0.33), std::nullopt}), {0.05, 0.05, 0.1}),
      show.model);
  show.run(40);
  EXPECT_EQ(show.status().phase, Phase::holding);
  EXPECT_NEAR(show.levels()[0], 0.05, 1e-9);
  EXPECT_NEAR(show.levels()[1], 0.05, 1e-9);
  EXPECT_NEAR(show.lux()[1], 40, 1.2) << "the wash, which nobody holds, makes up for them";
  const ShowStatus status = show.status();
  ASSERT_EQ(status.by_hand.size(), 2u);
  EXPECT_TRUE(status.by_hand[0].of_plan);
  EXPECT_EQ(status.by_hand[0].why, "");
  // The next plan ends it.
  show.show->apply(show.now(), with_levels(show.look({40, 40}), {0.33, 0.33, 0.0}), show.model);
  show.run(20);
  EXPECT_TRUE(show.status().by_hand.empty());
  EXPECT_GT(show.levels()[0], 0.1);
}

TEST(ByHand, CorrectionsAimAtTheGoalsOfThePlanNotOfTheRigFile) {
  HandShow show;
  Look look = show.look({20, std::nullopt});
  show.show->apply(show.now(), with_levels(look, {0.17, 0.3, 0.0}), show.model);
  show.run(40);
  EXPECT_NEAR(show.lux()[0], 20, 0.6);
  EXPECT_NEAR(show.levels()[1], 0.3, 0.03) << "a point without a goal pulls at nothing";
  EXPECT_FALSE(show.status().points[1].goal_lx);
  // A plan solved for a lower limit keeps it. The next plan without one returns to the rig's limit.
  look = show.look({40, 40});
  look.max_lx = {30, std::nullopt};
  show.show->apply(show.now(), with_levels(look, {0.4, 0.4, 0.0}), show.model);
  for (int i = 0; i < 40; ++i) {
    show.run(1);
    EXPECT_LE(show.lux()[0], 30) << i;
  }
  look.max_lx.clear();
  show.show->apply(show.now(), with_levels(look, {0.4, 0.4, 0.0}), show.model);
  show.run(40);
  EXPECT_NEAR(show.lux()[0], 40, 1.2);
}

TEST(ByHand, ALevelIsHeldUntilReleasedEvenAcrossPlans) {
  HandShow show;
  show.show->apply(show.now(), std::vector<double>{0.36, 0.36, 0.0});
  show.run(20);
  const std::vector<double> before = show.levels();
  ByHand held = level_by_hand(0, 0.05);
  held.since = show.now();
  ASSERT_TRUE(show.show->hold(show.now(), std::vector{held}));
  show.run(1.1);
  EXPECT_NEAR(show.levels()[0], 0.05, 1e-9) << "it fades there at once";
  show.run(40);
  EXPECT_NEAR(show.levels()[0], 0.05, 1e-9);
  EXPECT_NEAR(show.lux()[1], 40, 1.2) << "the rest is corrected on";
  EXPECT_GT(show.levels()[2], 2 * before[2]) << "the wash makes up for it";
  ASSERT_EQ(show.status().by_hand.size(), 1u);
  EXPECT_EQ(show.status().by_hand[0].since, at(20));
  show.show->apply(show.now(), std::vector<double>{0.36, 0.36, 0.0});
  show.run(20);
  EXPECT_NEAR(show.levels()[0], 0.05, 1e-9) << "a plan does not end it";
  EXPECT_EQ(show.show->release(show.now(), std::vector<std::size_t>{0}, {}), 1u);
  show.run(40);
  EXPECT_TRUE(show.status().by_hand.empty());
  EXPECT_NEAR(show.lux()[0], 40, 1.2);
  EXPECT_NEAR(show.levels()[0], before[0], 0.2 * before[0]) << "the rest goes back, too";
  EXPECT_LE(show.levels()[2], before[2]);
}

// Somebody may be changing its lamp.
TEST(ByHand, TheSafeLookLightsNoLampAboveWhatAPersonHoldsItAt) {
  HandShow show;
  show.rig.safe.level = 0.2;
  show.show = std::make_unique<ShowController>(show.rig, show.model);
  show.show->apply(show.now(), std::vector<double>{0.36, 0.36, 0.0});
  show.run(20);
  ASSERT_TRUE(show.show->hold(show.now(), std::vector{level_by_hand(0, 0), level_by_hand(2, 0.3)}));
  show.run(5);
  show.show->go_safe(show.now());
  show.run(20);
  EXPECT_EQ(show.status().phase, Phase::safe);
  EXPECT_EQ(show.levels()[0], 0);
  EXPECT_EQ(show.show->safe_look(show.now())[0], 0) << "nor does the guardian";
  EXPECT_NEAR(show.levels()[1], 0.2, 1e-9);
  EXPECT_NEAR(show.levels()[2], 0.2, 1e-9) << "what is held higher goes to the safe look";
}

TEST(ByHand, OpenLoopTheModelSolvesTheRestAndAReleaseRestoresLevels) {
  HandShow show(false);
  show.show->apply(show.now(), std::vector<double>{0.3, 0.36, 0.0});
  show.run(5);
  ASSERT_TRUE(show.show->hold(show.now(), std::vector{goal_by_hand(1, 20)}));
  show.run(5);
  EXPECT_NEAR((show.model.point_lux_per_level.row(1) *
               Eigen::Vector3d(show.levels()[0], show.levels()[1], show.levels()[2]))(0),
              20, 0.5);
  EXPECT_EQ(show.status().points[1].goal_lx, 20);
  EXPECT_EQ(show.show->release(show.now(), {}, std::vector<std::size_t>{1}), 1u);
  show.run(5);
  EXPECT_NEAR((show.model.point_lux_per_level.row(1) *
               Eigen::Vector3d(show.levels()[0], show.levels()[1], show.levels()[2]))(0),
              40, 1);
}

TEST(ByHand, FadesAsSlowlyAsAsked) {
  for (const double fade_s : {0.2, 5.0}) {
    HandShow show;
    show.show->apply(show.now(), std::vector<double>{0.36, 0.36, 0.0});
    show.run(10);
    const double before = show.levels()[1];
    ASSERT_TRUE(show.show->hold(show.now(), std::vector{level_by_hand(1, 0.9)}, {{}, fade_s, false}));
    show.run(fade_s / 2);
    EXPECT_GT(show.levels()[1], before + 0.1) << fade_s;
    EXPECT_LT(show.levels()[1], 0.8) << fade_s;
    show.run(fade_s / 2 + 0.05);
    EXPECT_NEAR(show.levels()[1], 0.9, 1e-9) << fade_s;
    // Going back is a look of the rig again.
    show.show->release(show.now(), std::vector<std::size_t>{1}, {});
    show.run(0.3);
    EXPECT_GT(show.levels()[1], before + 0.1) << fade_s;
  }
}

TEST(ByHand, ExpiresByItselfAfterItsTime) {
  HandShow show;
  show.show->apply(show.now(), std::vector<double>{0.36, 0.36, 0.0});
  show.run(10);
  ByHand held = level_by_hand(1, 0.9);
  held.until = at(25);
  ASSERT_TRUE(show.show->hold(show.now(), std::vector{held}));
  show.run(14.9);
  EXPECT_NEAR(show.levels()[1], 0.9, 1e-9);
  show.run(15);
  EXPECT_TRUE(show.status().by_hand.empty());
  EXPECT_NEAR(show.lux()[1], 40, 1.2);
}

TEST(ByHand, ALimitOverridesALevelAndAGoalAndReportsIt) {
  HandShow show;
  show.show->apply(show.now(), std::vector<double>{0.36, 0.36, 0.0});
  show.run(20);
  ASSERT_TRUE(show.show->hold(show.now(), std::vector{level_by_hand(0, 1.0)}));
  for (int i = 0; i < 60; ++i) {
    show.run(0.5);
    EXPECT_LE(show.lux()[0], 50) << i;
  }
  EXPECT_GT(show.lux()[0], 44) << "as much of it as the limit leaves";
  ASSERT_EQ(show.status().by_hand.size(), 1u);
  EXPECT_NE(show.status().by_hand[0].why.find("the limit of point \"below left\" (50 lx) wins"), std::string::npos)
      << show.status().by_hand[0].why;
  show.show->release(show.now(), std::vector<std::size_t>{0}, {});
  ASSERT_TRUE(show.show->hold(show.now(), std::vector{goal_by_hand(0, 80)}));
  for (int i = 0; i < 60; ++i) {
    show.run(0.5);
    EXPECT_LE(show.lux()[0], 50) << i;
  }
  EXPECT_EQ(show.status().by_hand[0].why, "its limit of 50 lx wins");
}

TEST(ByHand, MaxLevelWinsAndInvalidRequestsAreRefusedWhole) {
  HandShow show;
  show.rig.fixtures[1].max_level = 0.4;
  show.rig.fixtures[2].switched = true;
  show.show = std::make_unique<ShowController>(show.rig, show.model);
  show.show->apply(show.now(), std::vector<double>{0.36, 0.36, 0.0});
  show.run(5);
  ASSERT_TRUE(show.show->hold(show.now(), std::vector{level_by_hand(1, 0.9)}));
  show.run(5);
  EXPECT_NEAR(show.levels()[1], 0.4, 1e-9);
  EXPECT_EQ(show.status().by_hand[0].why, "the most it may have is 0.4 (max_level)");
  const auto refused = show.show->hold(show.now(), std::vector{level_by_hand(0, 0.1), level_by_hand(2, 0.5)});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().detail.find("wash: it is on or off: give 0 or 1"), std::string::npos);
  EXPECT_EQ(show.status().by_hand.size(), 1u) << "nothing of it was taken";
  EXPECT_FALSE(show.show->hold(show.now(), std::vector{level_by_hand(0, 1.1)}));
  EXPECT_FALSE(show.show->hold(show.now(), std::vector{goal_by_hand(0, -1)}));
  EXPECT_FALSE(show.show->hold(show.now(), std::vector{goal_by_hand(0, std::nan(""))}));
}

TEST(ByHand, BlackoutAndTheSafeLookOverrideItAndItReturnsAfterwards) {
  HandShow show;
  show.show->apply(show.now(), std::vector<double>{0.36, 0.36, 0.0});
  show.run(10);
  show.show->blackout(show.now(), true);
  ASSERT_TRUE(show.show->hold(show.now(), std::vector{level_by_hand(0, 0.2)}));
  show.run(2);
  EXPECT_EQ(show.levels(), (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(show.status().by_hand[0].why, "blackout");
  show.show->blackout(show.now(), false);
  show.run(10);
  EXPECT_NEAR(show.levels()[0], 0.2, 1e-9);
  // A bus is lost: the light is held, then goes to the safe look. When the bus is back, so is the held light.
  Health lost;
  lost.device = "lights";
  lost.life = Life::faulted;
  show.show->health(show.now(), std::vector{lost});
  show.run(10);
  EXPECT_EQ(show.status().phase, Phase::safe);
  EXPECT_NEAR(show.levels()[0], show.rig.safe.level, 1e-6);
  EXPECT_EQ(show.status().by_hand[0].why, "safe look");
  lost.life = Life::active;
  show.show->health(show.now(), std::vector{lost});
  show.run(20);
  EXPECT_NEAR(show.levels()[0], 0.2, 1e-9);
}

TEST(ByHand, IsKeptForTheFirstPlan) {
  HandShow show;
  ASSERT_TRUE(show.show->hold(show.now(), std::vector{level_by_hand(0, 0.1), goal_by_hand(1, 30)}));
  show.run(2);
  EXPECT_EQ(show.levels(), (std::vector<double>{0, 0, 0}));
  show.show->apply(show.now(), with_levels(show.look({std::nullopt, 40}), {0.36, 0.36, 0.0}), show.model);
  show.run(20);
  EXPECT_NEAR(show.levels()[0], 0.1, 1e-9);
  EXPECT_NEAR(show.lux()[1], 30, 1);
}

TEST(ByHand, EmittersOfAHousingKeepTheirSharesWhenTheHousingIsSet) {
  HandShow show;
  show.rig.points[0].max_lx.reset();
  show.rig.fixtures[0].name = "par/red";
  show.rig.fixtures[1].name = "par/green";
  for (const std::size_t f : {0, 1}) show.rig.fixtures[f].housing = 0;
  show.show = std::make_unique<ShowController>(show.rig, show.model);
  show.show->apply(show.now(), with_levels(show.look({std::nullopt, std::nullopt}), {0.2, 0.1, 0.3}), show.model);
  show.run(5);
  ByHand housing = level_by_hand(0, 0.3);
  housing.whole_housing = true;
  ASSERT_TRUE(show.show->hold(show.now(), std::vector{housing}));
  show.run(5);
  EXPECT_NEAR(show.levels()[0], 0.3, 1e-9);
  EXPECT_NEAR(show.levels()[1], 0.15, 1e-9);
  EXPECT_NEAR(show.levels()[2], 0.3, 1e-6) << "no goal, so nothing makes up for it";
}

}  // namespace
}  // namespace luxrig
