// One definition of met, missed and unknown.
#include "core/plan/verdict.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/plan/plan.h"

namespace luxrig {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

TEST(Verdict, IsMetOnlyWhenTheWholeIntervalLiesWithinTheTolerance) {
  EXPECT_EQ(verdict_of({200, 0}, 200, 10), Verdict::met);
  EXPECT_EQ(verdict_of({195, 5}, 200, 10), Verdict::met);
  EXPECT_EQ(verdict_of({205, 5}, 200, 10), Verdict::met);
  EXPECT_EQ(verdict_of({205, 6}, 200, 10), Verdict::unknown);
  EXPECT_EQ(verdict_of({200, 11}, 200, 10), Verdict::unknown);
}

TEST(Verdict, IsMissedOnlyWhenTheWholeIntervalLiesOutsideTheTolerance) {
  EXPECT_EQ(verdict_of({0, 0}, 200, 10), Verdict::missed);
  EXPECT_EQ(verdict_of({170, 15}, 200, 10), Verdict::missed);
  EXPECT_EQ(verdict_of({170, 27}, 200, 10), Verdict::unknown);
  EXPECT_EQ(verdict_of({411.7, 8}, 500, 50), Verdict::missed);
}

TEST(Verdict, IsUnknownForValuesThatAreNotNumbers) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(verdict_of({kNotANumber, 0}, 200, 10), Verdict::unknown);
  EXPECT_EQ(verdict_of({200, kNotANumber}, 200, 10), Verdict::unknown);
  EXPECT_EQ(verdict_of({200, infinity}, 200, 10), Verdict::unknown);
  EXPECT_EQ(verdict_of({infinity, infinity}, 200, 10), Verdict::unknown);
}

TEST(Verdict, OfAZeroGoalUsesTheLargestGoalBesideIt) {
  EXPECT_DOUBLE_EQ(tolerance_lx(0, 0.1, 300), 30);
  EXPECT_DOUBLE_EQ(tolerance_lx(50, 0.1, 300), 5);
  EXPECT_EQ(verdict_of({2, 1}, 0, tolerance_lx(0, 0.1, 300)), Verdict::met);
}

TEST(Verdict, IsRarelyWrongWhenTheStatedErrorIsCorrect) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  int met = 0, wrongly_met = 0, missed = 0, wrongly_missed = 0;
  for (int i = 0; i < 20000; ++i) {
    const double truth = 100 * (1 + 0.08 * normal(random)), error = 3;
    const Verdict verdict = verdict_of(estimate_of(truth + error * normal(random), error), 100, 10);
    const bool within = std::abs(truth - 100) <= 10;
    met += verdict == Verdict::met;
    wrongly_met += verdict == Verdict::met && !within;
    missed += verdict == Verdict::missed;
    wrongly_missed += verdict == Verdict::missed && within;
  }
  EXPECT_GT(met, 4000);
  EXPECT_GT(missed, 1000);
  EXPECT_LE(wrongly_met, met * 0.025);
  EXPECT_LE(wrongly_missed, missed * 0.025);
}

TEST(Verdict, OfAReadingCountsTheMetersTolerance) {
  EXPECT_NEAR(estimate_of_reading(200, 0, 0.05, 0).half_width_lx, 0.95 * 10, 1e-12);
  EXPECT_NEAR(estimate_of_reading(200, 0.005, 0, 0).half_width_lx, 1.96, 1e-12);
  // A meter with an error of 5 % cannot confirm a goal to 5 %.
  EXPECT_EQ(verdict_of(estimate_of_reading(200, 0.005, 0.05, 0.1), 200, 10), Verdict::met);
  EXPECT_EQ(verdict_of(estimate_of_reading(200, 0.005, 0.055, 0.1), 200, 10), Verdict::unknown);
}

TEST(Verdict, StatesTheShortfallAndWhatWouldSettleIt) {
  EXPECT_EQ(reason_of(Verdict::met, {200, 1}, 200, 10, "x", "y"), "");
  EXPECT_EQ(reason_of(Verdict::missed, {411.7, 1}, 500, 50, "", "y"), "17.7 % too dark");
  EXPECT_EQ(reason_of(Verdict::missed, {600, 1}, 500, 50, "spot-1 is off already", "y"),
            "20.0 % too bright: spot-1 is off already");
  EXPECT_EQ(reason_of(Verdict::unknown, {190, 27}, 200, 10, "", "a luxmeter here would settle it"),
            "190 lx known to ± 14 %, tolerance 5 %: a luxmeter here would settle it");
  EXPECT_EQ(reason_of(Verdict::unknown, {kNotANumber, 0}, 200, 10, "", ""), "not known");
}

TEST(Verdict, CountsAreWordedPlainly) {
  EXPECT_EQ(text_of(VerdictCounts{}), "no goals");
  EXPECT_EQ(text_of({1, 0, 0}), "the goal is met");
  EXPECT_EQ(text_of({6, 0, 0}), "all 6 goals met");
  EXPECT_EQ(text_of({6, 0, 34}), "no goal missed: 6 of 40 met, 34 unknown");
  EXPECT_EQ(text_of({3, 1, 2}), "1 of 6 goals missed, 2 unknown");
}

PlannedPoint planned(const std::string& name, std::optional<double> goal_lux, double lux, double standard_error_lux) {
  PlannedPoint point;
  point.name = name;
  point.goal_lux = goal_lux;
  point.lux = lux;
  point.standard_error_lux = standard_error_lux;
  return point;
}

TEST(PlanVerdicts, AGoalKeptOutOfReachIsMissedWithItsReason) {
  Plan plan;
  plan.points = {planned("a", 200, 199, 1), planned("b", 500, 411.7, 1), planned("c", 200, 205, 20),
                 planned("d", {}, 77, 1)};
  plan.points[1].why = "all lamps that reach it are at 100 %";
  judge(plan, 0.1);
  EXPECT_EQ(plan.points[0].verdict, Verdict::met);
  EXPECT_EQ(plan.points[1].verdict, Verdict::missed);
  EXPECT_EQ(plan.points[1].reason, "17.7 % too dark: all lamps that reach it are at 100 %");
  EXPECT_EQ(plan.points[2].verdict, Verdict::unknown);
  EXPECT_EQ(plan.points[3].verdict, std::nullopt);
  EXPECT_EQ(goals_of(plan).missed, 1);
  EXPECT_FALSE(nothing_missed(plan));
  plan.points.erase(plan.points.begin() + 1);
  EXPECT_TRUE(nothing_missed(plan));
  plan.limits = {{"a", 100, 120, false}};
  EXPECT_FALSE(nothing_missed(plan));
}

TEST(PlanVerdicts, APointsOwnToleranceCountsInPlaceOfTheRigs) {
  Plan plan;
  plan.points = {planned("edge", 100, 118, 1), planned("middle", 100, 106, 1), planned("dark", 0, 4, 0.1)};
  plan.points[0].goal_tolerance = 0.25;
  plan.points[1].goal_tolerance = 0.03;
  plan.points[2].goal_tolerance = 0.05;  // of the largest goal beside it
  judge(plan, 0.1);
  EXPECT_EQ(plan.points[0].verdict, Verdict::met) << plan.points[0].reason;
  EXPECT_EQ(plan.points[1].verdict, Verdict::missed);
  EXPECT_EQ(plan.points[2].verdict, Verdict::met) << plan.points[2].reason;
  for (PlannedPoint& point : plan.points) point.goal_tolerance.reset();
  judge(plan, 0.1);
  EXPECT_EQ(plan.points[0].verdict, Verdict::missed);
  EXPECT_EQ(plan.points[1].verdict, Verdict::met) << plan.points[1].reason;
}

TEST(Verdict, SaysItsTolerances) {
  EXPECT_EQ(tolerance_text({0.1, 0.1}), "within 10 %");
  EXPECT_EQ(tolerance_text({0.025, 0.25}), "within 2.5 to 25 %");
  Rig rig;
  EXPECT_EQ(rig.goal_tolerances(), std::pair(0.1, 0.1));
  rig.points.resize(3);
  rig.points[0].goal_lx = rig.points[1].goal_lx = 100;
  rig.points[1].goal_tolerance = 0.25;
  rig.points[2].goal_tolerance = 0.5;  // without a goal, it says nothing
  EXPECT_EQ(rig.goal_tolerances(), std::pair(0.1, 0.25));
}

TEST(PlanVerdicts, AGoalInAnotherColourIsMissed) {
  Plan plan;
  plan.points = {planned("a", 200, 200, 0.1)};
  plan.points[0].goal_xy = Chromaticity(0.44, 0.40);
  plan.points[0].xy = Chromaticity(0.442, 0.401);
  judge(plan, 0.1);
  EXPECT_EQ(plan.points[0].verdict, Verdict::met) << plan.points[0].reason;
  plan.points[0].xy = Chromaticity(0.31, 0.33);
  judge(plan, 0.1);
  EXPECT_EQ(plan.points[0].verdict, Verdict::missed);
}

}  // namespace
}  // namespace luxrig
