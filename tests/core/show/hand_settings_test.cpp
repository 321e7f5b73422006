#include "core/show/hand_settings.h"

#include <gtest/gtest.h>

namespace luxrig {
namespace {

/// Two lamps and two points, with nothing set.
class HandSettingsTest : public ::testing::Test {
 protected:
  static Rig small_rig() {
    Rig rig;
    rig.fixtures.resize(2);
    rig.points.resize(2);
    rig.points[0].name = "table";
    rig.points[1].name = "wall";
    return rig;
  }
  static ByHand level(std::size_t fixture, double value) { return {ByHand::What::level, fixture, value}; }
  static ByHand goal(std::size_t point, double lux) { return {ByHand::What::goal, point, lux}; }
  void set(const ByHand& one) { hands.set(rig, std::span(&one, 1)); }
  bool take_plan(const std::vector<double>& levels, const Look& look = {}) {
    return hands.take_plan(Time{}, levels, look, std::vector<double>{1, 0.7});
  }

  static constexpr Time kEnd{std::chrono::seconds(10)};

  Rig rig = small_rig();
  HandSettings hands{rig};
};

TEST_F(HandSettingsTest, ReleaseCountsOnlyExistingSettings) {
  set(level(1, 0.4));
  set(goal(0, 150));
  EXPECT_EQ(hands.all().size(), 2u);
  const std::vector<std::size_t> both = {0, 1};
  EXPECT_EQ(hands.release(both, both), 2u);
  EXPECT_EQ(hands.release(both, both), 0u);
  EXPECT_TRUE(hands.all().empty());
}

TEST_F(HandSettingsTest, ASettingExpiresExactlyAtItsTime) {
  ByHand timed = level(0, 0.5);
  timed.until = kEnd;
  set(timed);
  set(goal(1, 80));
  EXPECT_TRUE(hands.over(kEnd - std::chrono::milliseconds(1)).empty());
  EXPECT_EQ(hands.over(kEnd).fixtures, (std::vector<std::size_t>{0}));
  EXPECT_TRUE(hands.over(kEnd).points.empty()) << "a setting without an end stays";
}

TEST_F(HandSettingsTest, APlanEndsOnlySettingsOfThePreviousPlan) {
  Look look;
  look.solved_levels = {std::nullopt, 0.9};
  EXPECT_FALSE(take_plan({0.2, 0.3}, look));
  ASSERT_TRUE(hands.level(1));
  EXPECT_EQ(hands.level(1)->value, 0.3);
  EXPECT_EQ(hands.levels_without(), (std::vector<double>{0.2, 0.7})) << "as solved, up to the fixture's maximum";

  set(level(0, 1));
  EXPECT_TRUE(take_plan({0.5, 0.6})) << "the lamp set by hand is to be solved around";
  ASSERT_TRUE(hands.level(0));
  EXPECT_EQ(hands.level(0)->value, 1);
  EXPECT_FALSE(hands.level(1)) << "it was of the plan before";
  EXPECT_EQ(hands.levels_without(), (std::vector<double>{0.5, 0.6}));

  hands.release(std::vector<std::size_t>{0}, {});
  EXPECT_FALSE(take_plan({0.1, 0.1}));
  set(goal(0, 120));
  EXPECT_TRUE(take_plan({0.1, 0.1})) << "so is a goal";
}

TEST_F(HandSettingsTest, GoalsFollowTheirPointByName) {
  set(goal(0, 120));
  set(goal(1, 60));
  std::vector<Point> after(3);
  after[0].name = "wall";
  after[1].name = "door";
  after[2].name = "Table";
  hands.exchange_points(rig.points, after);
  ASSERT_TRUE(hands.goal(0));
  EXPECT_EQ(hands.goal(0)->value, 60);
  EXPECT_EQ(hands.goal(0)->index, 0u);
  EXPECT_FALSE(hands.goal(1));
  EXPECT_FALSE(hands.goal(2));
}

}  // namespace
}  // namespace luxrig
