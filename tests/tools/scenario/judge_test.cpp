// Expectations and rules judged on made-up instants, so that each verdict has one cause.
#include "tools/scenario/judge.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/rig/listed_problems.h"
#include "tests/tools/scenario/small_rig.h"
#include "tools/scenario/scenario_file.h"
#include "tools/scenario/show_rules.h"

namespace luxrig::scenario {
namespace {

constexpr double kTick_s = 0.02;

/// A show that a test makes up: everything dark and well until it says otherwise.
struct MadeUp {
  Rig rig = small_rig();
  ShowStatus status;
  Instant now;
  MadeUp() {
    status.points.resize(rig.points.size());
    now.status = &status;
    now.lux.assign(rig.points.size(), 0.0);
    now.lux_hours = now.lux;
    now.reading_lx.resize(rig.luxmeters.size());
    now.level.assign(rig.fixtures.size(), 0.0);
    now.joints.resize(rig.fixtures.size());
  }
};

class JudgeTest : public testing::Test {
 protected:
  MadeUp show;

  /// Verdict on one expectation. lux: of work-1 at each second.
  Judged verdict(const std::string& expectation, const std::vector<double>& lux,
                 const std::vector<std::pair<std::size_t, double>>& events = {}) {
    const std::string text =
        "[scenario]\nname = \"t\"\nlength_s = 1000\n[[event]]\nname = \"it\"\nat_s = 0\ndo = "
        "\"blackout\"\n[[expect]]\n" +
        expectation;
    const auto scenario = parse_scenario(text, "t.toml", show.rig);
    EXPECT_TRUE(scenario.has_value()) << (scenario ? "" : test::listed(scenario.error()));
    if (!scenario) return {};
    Judge judge(*scenario, show.rig);
    for (std::size_t s = 0; s < lux.size(); ++s) {
      for (const auto& [event, at_s] : events)
        if (at_s == static_cast<double>(s)) judge.happened(event, at_s);
      show.now.lux[0] = lux[s];
      judge.look(static_cast<double>(s), show.now);
    }
    return judge.end(static_cast<double>(lux.size())).front();
  }
};

/// In real time what happens is seen a moment late: the ends of a time are not judged, its middle is.
TEST_F(JudgeTest, WithSlackTheTimeOfWhatAlwaysHoldsIsShorterAndOfWhatIsReachedLonger) {
  const auto held = [&](const std::string& expectation, double at_s) {
    const auto scenario = parse_scenario(
        "[scenario]\nname = \"t\"\nlength_s = 1000\n[[event]]\nname = \"it\"\nat_s = 0\ndo = \"blackout\"\n[[expect]]\n"
        "after = \"it\"\nwithin_s = 4\n" +
            expectation,
        "t.toml", show.rig);
    EXPECT_TRUE(scenario.has_value());
    Judge judge(*scenario, show.rig, 0.25);
    judge.happened(0, 10);
    for (int tick = 500; tick < 800; ++tick) {
      const double now_s = tick * kTick_s;
      show.now.lux[0] = std::abs(now_s - at_s) < 0.05 ? 60 : 40;
      judge.look(now_s, show.now);
    }
    return judge.end(16).front().held;
  };
  EXPECT_TRUE(held("always = \"lux work-1 < 50\"\n", 10.1));
  EXPECT_FALSE(held("always = \"lux work-1 < 50\"\n", 10.4));
  EXPECT_FALSE(held("always = \"lux work-1 < 50\"\n", 13.6));
  EXPECT_TRUE(held("always = \"lux work-1 < 50\"\n", 13.9));
  EXPECT_TRUE(held("reached = \"lux work-1 > 50\"\n", 14.15));
  EXPECT_FALSE(held("reached = \"lux work-1 > 50\"\n", 14.5));
}

TEST_F(JudgeTest, AlwaysFailsAtTheFirstInstantThatIsOtherwise) {
  EXPECT_TRUE(verdict("always = \"lux work-1 <= 50\"", {10, 50, 20}).held);
  const Judged judged = verdict("always = \"lux work-1 <= 50\"", {10, 50.1, 60});
  EXPECT_FALSE(judged.held);
  EXPECT_EQ(judged.at_s, 1);
  EXPECT_EQ(judged.found, "lux of work-1 is 50.1 lx");
}

TEST_F(JudgeTest, NeverFailsForAnyOfTheNames) {
  EXPECT_TRUE(verdict("never = \"lux work-* > 50\"", {10, 50, 20}).held);
  EXPECT_FALSE(verdict("never = \"lux work-* > 50\"", {10, 51, 20}).held);
}

TEST_F(JudgeTest, ReachedNeedsOneInstantInItsTime) {
  EXPECT_TRUE(verdict("reached = \"lux work-1 > 50\"", {0, 60, 0}).held);
  EXPECT_FALSE(verdict("reached = \"lux work-1 > 50\"", {0, 0, 0}).held);
  EXPECT_TRUE(verdict("reached = \"lux work-1 > 50\"\nwithin_s = 2", {0, 0, 60}).held);
  const Judged late = verdict("reached = \"lux work-1 > 50\"\nwithin_s = 2", {0, 0, 0, 60});
  EXPECT_FALSE(late.held);
  EXPECT_EQ(late.found, "not within 2 s: lux of work-1 is 0 lx");
}

TEST_F(JudgeTest, AtEndLooksAtTheEndOfItsTimeOnly) {
  EXPECT_TRUE(verdict("at_end = \"lux work-1 > 50\"", {0, 0, 60}).held);
  EXPECT_FALSE(verdict("at_end = \"lux work-1 > 50\"", {60, 60, 0}).held);
  EXPECT_TRUE(verdict("at_end = \"lux work-1 > 50\"\nwithin_s = 1", {0, 60, 0}).held);
  EXPECT_FALSE(verdict("at_end = \"lux work-1 > 50\"\nwithin_s = 1", {60, 0, 60}).held);
}

TEST_F(JudgeTest, AFigureHoldsWithinItsTolerance) {
  for (const char* condition :
       {"lux work-1 between 45 and 50", "lux work-1 between 45 lx and 50 lx", "lux work-1 == 47.5 +- 2.5",
        "lux work-1 == 47.5 lx ± 2.5 lx", "lux work-1 == 47.5 +- 5.2632 %"}) {
    const std::string expectation = std::string("at_end = \"") + condition + "\"\n";
    for (const double lux : {45.01, 47.5, 49.99}) EXPECT_TRUE(verdict(expectation, {lux}).held) << condition << lux;
    for (const double lux : {44.9, 50.1}) EXPECT_FALSE(verdict(expectation, {lux}).held) << condition << lux;
  }
}

TEST_F(JudgeTest, ATimeBeginsWithItsEvent) {
  const std::string after = "always = \"lux work-1 <= 50\"\nafter = \"it\"\nfrom_s = 1\nwithin_s = 2";
  EXPECT_TRUE(verdict(after, {90, 90, 90, 10, 10, 10, 90}, {{0, 2}}).held);
  EXPECT_FALSE(verdict(after, {90, 90, 90, 90, 10, 10}, {{0, 2}}).held);
  const Judged never = verdict(after, {10, 10, 10});
  EXPECT_FALSE(never.held);
  EXPECT_EQ(never.found, "\"it\" never happened");
}

TEST_F(JudgeTest, ATimeThatNeverComesAndAValueThatIsNeverKnownAreNoSuccess) {
  EXPECT_EQ(verdict("always = \"lux work-1 <= 50\"\nfrom_s = 100", {1, 1}).found, "its time never came");
  EXPECT_EQ(verdict("always = \"reading meter-1 <= 50\"", {1, 1}).found, "its value was never known");
}

class RulesTest : public testing::Test {
 protected:
  MadeUp show;
  double at_s = 10;

  ShowRules rules{show.rig};

  void look(int ticks = 1) {
    for (int k = 0; k < ticks; ++k) {
      at_s += kTick_s;
      rules.look(at_s, show.now, std::vector<bool>(show.rig.buses.size(), true));
    }
  }
  /// What is said about broken rules, in lines.
  std::string broken() {
    std::string text;
    for (const Judged& rule : rules.end())
      if (!rule.held) text += rule.expected + ": " + rule.found + "\n";
    return text;
  }
};

TEST_F(RulesTest, AQuietShowBreaksNone) {
  look(100);
  EXPECT_EQ(broken(), "");
}

TEST_F(RulesTest, LightAboveALimitBreaksTheFirst) {
  look();
  show.now.lux[1] = 51;  // within the meter's 4 %
  look();
  EXPECT_EQ(broken(), "");
  show.now.lux[1] = 53;
  look();
  EXPECT_EQ(broken(), "no output exceeds a limit: work-2 gets 53.0 lx, its limit is 50 lx\n");
}

TEST_F(RulesTest, ALevelAboveTheHighestBreaksTheFirst) {
  show.rig.fixtures[3].max_level = 0.4;
  show.now.level[3] = 0.41;
  look();
  EXPECT_EQ(broken(), "no output exceeds a limit: spot-4 is sent level 0.410, its highest is 0.400\n");
}

TEST_F(RulesTest, AJumpBreaksTheSecondUnlessSomebodyMadeIt) {
  look();
  show.now.level[0] = 0.045;  // the fastest fade takes 0.8 s
  look();
  EXPECT_EQ(broken(), "");
  rules.disturbed(at_s);
  show.now.level[0] = 0.9;
  look();
  EXPECT_EQ(broken(), "");
  look(60);
  show.now.level[0] = 0.8;
  look();
  EXPECT_EQ(broken(), "light does not jump unless somebody makes it: spot-1 jumps from level 0.900 to 0.800\n");
}

TEST_F(RulesTest, ABusThatIsNotServedBreaksTheThird) {
  look(3);
  at_s += 0.4;
  look();
  EXPECT_NE(broken().find("the output cycle never waits: nothing was sent on bus \"track\" for 0.42 s"),
            std::string::npos);
}

TEST_F(RulesTest, AForgottenBlackoutAndAForgottenHandBreakTheFourth) {
  show.status.blackout = true;
  ByHand held;
  held.index = 2;
  held.value = 0.5;
  show.status.by_hand = {held};
  rules.daemon_gone(at_s, show.status);
  ShowStatus after = show.status;
  rules.daemon_back(at_s + 1, after);
  EXPECT_EQ(broken(), "");
  rules.daemon_gone(at_s + 2, show.status);
  after.by_hand.clear();
  rules.daemon_back(at_s + 3, after);
  EXPECT_EQ(
      broken(),
      "what was acknowledged survives a restart: spot-3 at level 0.5 is no longer held by hand after a restart\n");
}

// Its last status does not tell of it yet.
TEST_F(RulesTest, ABlackoutInTheDaemonsLastTickSurvives) {
  rules.blackout(at_s, true);
  rules.daemon_gone(at_s, show.status);
  ShowStatus after = show.status;
  after.blackout = true;
  rules.daemon_back(at_s + 1, after);
  EXPECT_EQ(broken(), "");
  rules.blackout(at_s + 2, true);
  rules.daemon_gone(at_s + 2, show.status);
  rules.daemon_back(at_s + 3, show.status);
  EXPECT_EQ(broken(), "what was acknowledged survives a restart: the blackout is gone after a restart\n");
}

// A fast head may have arrived before anybody looks again.
TEST_F(RulesTest, AHeadAtRestDoesNotTurnWithTheBlackout) {
  show.now.joints[0] = {1, 0.5, 0};
  look(100);
  rules.blackout(at_s, true);
  show.now.joints[0] = {};
  look(10);
  EXPECT_NE(broken().find("turns by 57"), std::string::npos) << broken();
}

TEST_F(RulesTest, AHeadOnItsWayMayArriveInTheDark) {
  for (int k = 0; k < 100; ++k) {
    show.now.joints[0].pan_rad = 0.01 * k;
    look();
  }
  rules.blackout(at_s, true);
  show.now.joints[0].pan_rad = 1.2;
  look(100);
  EXPECT_EQ(broken(), "");
}

// Only the point where it hangs is excused.
TEST_F(RulesTest, AMeterThatLiesExcusesNoLimitElsewhere) {
  const std::size_t point = *show.rig.luxmeters[0].point;
  ASSERT_NE(show.rig.luxmeters[1].point, point);
  show.rig.points[point].max_lx = 50;
  ShowRules limited(show.rig);
  limited.meter_lies(1, 0, true);
  limited.meter_lies(2, 0, false);
  limited.meter_lies(20, 1, true);
  show.now.lux[point] = 90;
  limited.look(21, show.now, {});
  const auto judged = limited.end();
  EXPECT_FALSE(judged[0].held) << "its own meter has been right for a long time";
}

// A limit that nobody measures is kept by what meters elsewhere teach: as far as these can be wrong and be believed.
TEST_F(RulesTest, WhereNobodyMeasuresALimitIsAsGoodAsMetersElsewhere) {
  show.rig.luxmeters.resize(1);
  const std::size_t other = *show.rig.luxmeters[0].point == 0 ? 1 : 0;
  show.rig.points[other].max_lx = 50;
  ShowRules honest(show.rig), lied(show.rig), beyond(show.rig);
  for (ShowRules* one : {&lied, &beyond}) one->meter_lies(1, 0, true);
  show.now.lux[other] = 55;
  for (ShowRules* one : {&honest, &lied}) one->look(5, show.now, {});
  show.now.lux[other] = 500;
  beyond.look(5, show.now, {});
  EXPECT_FALSE(honest.end()[0].held);
  EXPECT_TRUE(lied.end()[0].held);
  EXPECT_FALSE(beyond.end()[0].held);
}

// What a wrong meter drove up stays while no lamp answers, and is corrected after that.
TEST_F(RulesTest, WhileABusIsDeadALieIsNotCorrected) {
  const std::size_t point = *show.rig.luxmeters[0].point;
  show.rig.points[point].max_lx = 50;
  show.now.lux[point] = 60;
  ShowRules limited(show.rig), free(show.rig);
  for (ShowRules* one : {&limited, &free}) one->meter_lies(1, 0, true);
  limited.lamps_are_stuck(5, true);
  for (ShowRules* one : {&limited, &free}) one->meter_lies(20, 0, false);
  for (ShowRules* one : {&limited, &free}) one->look(40, show.now, {});
  EXPECT_FALSE(free.end()[0].held);
  EXPECT_TRUE(limited.end()[0].held);
  limited.lamps_are_stuck(50, false);
  limited.look(64, show.now, {});
  EXPECT_TRUE(limited.end()[0].held) << "a sample corrects it";
  limited.look(66, show.now, {});
  EXPECT_FALSE(limited.end()[0].held);
}

// What a meter that fails in a blackout must not exceed is the light before it, not the dark.
TEST_F(RulesTest, AMeterThatFailsInTheDarkIsMeasuredByTheLightBefore) {
  const std::size_t point = *show.rig.luxmeters[0].point;
  ShowRules lit(show.rig), never_lit(show.rig);
  show.now.lux[point] = 700;
  lit.look(1, show.now, {});
  for (ShowRules* one : {&lit, &never_lit}) {
    show.now.lux[point] = 0;
    one->blackout(2, true);
    one->look(3, show.now, {});
    one->meter_lies(3, 0, true);
    one->look(4, show.now, {});
    one->blackout(5, false);
    show.now.lux[point] = 1000;
    one->look(40, show.now, {});
  }
  EXPECT_TRUE(lit.end()[4].held);
  EXPECT_FALSE(never_lit.end()[4].held);
}

// Nobody knows when a hold until a time of day ends once the clock is set. Until then it is a hold.
TEST_F(RulesTest, AHoldWhoseEndTheClockMovedIsStillAHold) {
  const std::size_t point = *show.rig.luxmeters[0].point;
  ShowRules held(show.rig), free(show.rig);
  held.held_by_hand(1, 0, 0.9, 5.0);
  held.clock_stepped();
  show.now.lux[point] = 100;
  for (ShowRules* one : {&held, &free}) one->meter_lies(2, 0, true);
  ByHand level;
  level.value = 0.9;
  free.look(3, show.now, {});
  show.status.by_hand = {level};
  held.look(3, show.now, {});
  show.now.lux[point] = 1000;
  held.look(40, show.now, {});
  show.status.by_hand.clear();
  free.look(40, show.now, {});
  EXPECT_FALSE(free.end()[4].held);
  EXPECT_TRUE(held.end()[4].held);
}

// What a wrong meter drove up is corrected by the next sample, and there is none while meters are mute.
TEST_F(RulesTest, WhileMetersAreMuteALieIsNotCorrected) {
  const std::size_t point = *show.rig.luxmeters[0].point;
  show.rig.points[point].max_lx = 50;
  show.now.lux[point] = 60;
  ShowRules mute(show.rig), heard(show.rig);
  for (ShowRules* one : {&mute, &heard}) one->meter_lies(1, 0, true);
  for (ShowRules* one : {&mute, &heard}) one->meter_lies(5, 0, false);
  mute.meter_is_mute(5.4, true);
  for (ShowRules* one : {&mute, &heard}) one->look(21, show.now, {});
  EXPECT_TRUE(mute.end()[0].held);
  EXPECT_FALSE(heard.end()[0].held);
}

// A goal is lowered, and the lamp does not hear it.
TEST_F(RulesTest, ADeafLampIsNoMetersDoing) {
  const std::size_t point = *show.rig.luxmeters[0].point;
  ShowRules deaf(show.rig), hears(show.rig);
  for (ShowRules* one : {&deaf, &hears}) {
    show.now.lux[point] = 10;
    one->meter_lies(1, 0, true);
    one->look(2, show.now, {});
    show.now.lux[point] = 1000;
  }
  deaf.fixture_is_deaf(3, true);
  for (ShowRules* one : {&deaf, &hears}) one->look(40, show.now, {});
  EXPECT_TRUE(deaf.end()[4].held);
  EXPECT_FALSE(hears.end()[4].held);
}

// A goal is lowered below what other lamps give there.
TEST_F(RulesTest, ALoweredGoalIsNoMetersDoing) {
  const std::size_t point = *show.rig.luxmeters[0].point;
  ShowRules lowered(show.rig), low(show.rig);
  show.now.lux[point] = 10;
  for (ShowRules* one : {&lowered, &low}) one->meter_lies(1, 0, true);
  show.status.points[point].goal_lx = 10;
  low.look(2, show.now, {});
  show.status.points[point].goal_lx = 700;
  lowered.look(2, show.now, {});
  show.status.points[point].goal_lx = 10;
  show.now.lux[point] = 500;
  for (ShowRules* one : {&lowered, &low}) one->look(40, show.now, {});
  EXPECT_TRUE(lowered.end()[4].held);
  EXPECT_FALSE(low.end()[4].held);
}

// Lamps that came back brighter than they were known to be, and then hear nothing.
TEST_F(RulesTest, WhileABusIsDeadADeafLampsLessonStays) {
  const std::size_t point = *show.rig.luxmeters[0].point;
  show.rig.points[point].max_lx = 50;
  show.now.lux[point] = 60;
  ShowRules dead(show.rig), hears(show.rig);
  for (ShowRules* one : {&dead, &hears}) one->fixture_is_deaf(1, true);
  for (ShowRules* one : {&dead, &hears}) one->fixture_is_deaf(20, false);
  dead.lamps_are_stuck(22, true);
  for (ShowRules* one : {&dead, &hears}) one->look(40, show.now, {});
  EXPECT_TRUE(dead.end()[0].held);
  EXPECT_FALSE(hears.end()[0].held);
}

// A lamp that a wrong meter drove up is bypassed, and comes back as it was.
TEST_F(RulesTest, ABypassedLampIsNotCorrected) {
  const std::size_t point = *show.rig.luxmeters[0].point;
  show.rig.points[point].max_lx = 50;
  ShowRules limited(show.rig);
  limited.meter_lies(1, 0, true);
  limited.bypassed(10, {show.rig.fixtures[0].name}, true);
  limited.meter_lies(20, 0, false);
  limited.bypassed(50, {show.rig.fixtures[0].name}, false);
  show.now.lux[point] = 60;
  limited.look(52, show.now, {});
  EXPECT_TRUE(limited.end()[0].held);
  limited.look(66, show.now, {});
  EXPECT_FALSE(limited.end()[0].held);
}

// What a deaf lamp taught is corrected by the next sample, and there is none while meters are mute.
TEST_F(RulesTest, WhileMetersAreMuteADeafLampsLessonStays) {
  const std::size_t point = *show.rig.luxmeters[0].point;
  show.rig.points[point].max_lx = 50;
  show.now.lux[point] = 55;
  ShowRules limited(show.rig), late(show.rig);
  for (ShowRules* one : {&limited, &late}) one->fixture_is_deaf(1, true);
  for (ShowRules* one : {&limited, &late}) one->fixture_is_deaf(14, false);
  limited.meter_is_mute(11, true);
  late.meter_is_mute(30, true);
  limited.look(40, show.now, {});
  late.look(40, show.now, {});
  EXPECT_TRUE(limited.end()[0].held);
  EXPECT_FALSE(late.end()[0].held) << "there was time for a sample";
  limited.meter_is_mute(50, false);
  limited.look(66, show.now, {});
  EXPECT_FALSE(limited.end()[0].held);
}

TEST_F(RulesTest, LightDrivenUpByAWrongMeterBreaksTheFifth) {
  show.rig.points[4].goal_lx = 100;
  show.status.points[4].goal_lx = 100;
  show.now.lux[4] = 100;
  rules.meter_lies(at_s, 4, true);
  look();
  show.now.lux[4] = 275;  // allowed: 100 / (0.6 · 0.75) · 1.25 + 1
  look();
  EXPECT_EQ(broken(), "");
  show.now.lux[4] = 285;
  look();
  EXPECT_NE(broken().find("a wrong meter cannot drive the light up: place-1 gets 285.0 lx"), std::string::npos);
}

TEST_F(RulesTest, AGoalCalledMetThatIsNotBreaksTheSixth) {
  show.status.phase = Phase::holding;
  show.status.points[5].goal_lx = 100;
  show.status.points[5].verdict = Verdict::met;
  show.now.lux[5] = 75;
  look(100);
  EXPECT_EQ(broken(), "") << "for two seconds it may be late";
  look(100);
  EXPECT_NE(broken().find("nothing is called met that is not: place-2 is called met"), std::string::npos);
}

TEST_F(RulesTest, LightInABlackoutAndAHeadThatTurnsBreakTheSeventh) {
  rules.blackout(at_s, true);
  show.status.blackout = true;
  look(100);
  EXPECT_EQ(broken(), "");
  show.now.joints[4].pan_rad = 0.1;
  look();
  EXPECT_NE(broken().find("spot-5 turns by 5.7° in a blackout"), std::string::npos);
}

TEST_F(RulesTest, ALampLitInABlackoutBreaksTheSeventh) {
  rules.blackout(at_s, true);
  show.now.level[0] = 0.01;
  look(4);
  EXPECT_EQ(broken(), "") << "it takes a moment";
  look(4);
  EXPECT_NE(broken().find("spot-1 is sent level 0.010 in a blackout"), std::string::npos);
}

TEST_F(RulesTest, AForgottenHandBreaksTheEighth) {
  ByHand held;
  held.index = 2;
  held.value = 0.5;
  show.status.by_hand = {held};
  rules.held_by_hand(at_s, 2, 0.5, std::nullopt);
  look(100);
  EXPECT_EQ(broken(), "");
  show.status.by_hand.clear();
  look();
  EXPECT_NE(broken().find("spot-3 was set to level 0.5 by hand, and is no longer held"), std::string::npos);
}

TEST_F(RulesTest, AnUnsafeEndBreaksTheLast) {
  rules.ended_in_order(at_s, std::vector<double>(show.rig.fixtures.size(), show.rig.safe.level));
  EXPECT_EQ(broken(), "");
  rules.ended_in_order(at_s, std::vector<double>(show.rig.fixtures.size(), show.rig.safe.level + 0.1));
  EXPECT_NE(broken().find("a daemon that ends in order leaves the safe look: spot-1 is left at level 0.200"),
            std::string::npos);
}

}  // namespace
}  // namespace luxrig::scenario
