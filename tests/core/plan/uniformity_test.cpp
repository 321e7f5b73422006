// Uniformity of painted surfaces against sums by hand.
#include "core/plan/uniformity.h"

#include <gtest/gtest.h>

namespace luxrig {
namespace {

Rig rig_with(double wanted) {
  Rig rig;
  rig.surface_goals.resize(2);
  rig.surface_goals[0].name = "plain";
  rig.surface_goals[1].name = "desk";
  rig.surface_goals[1].uniformity = wanted;
  rig.points.resize(4);
  rig.points[0].surface_goal = 0;
  for (const std::size_t i : {1u, 2u}) rig.points[i].surface_goal = 1;
  rig.points[1].weight = 3;  // it stands for three times the area
  return rig;
}

TEST(Uniformity, IsTheLowestOverTheMeanByArea) {
  const std::vector<LuxEstimate> light = {{1, 0}, {400, 0}, {200, 0}, {5, 0}};
  const auto all = uniformities(rig_with(0.5), light);
  ASSERT_EQ(all.size(), 1u) << "of goals that ask for it";
  EXPECT_EQ(all[0].surface_goal, "desk");
  EXPECT_NEAR(all[0].share, 200 / 350.0, 1e-12);
  EXPECT_NEAR(all[0].low, all[0].share, 1e-12);
  EXPECT_NEAR(all[0].high, all[0].share, 1e-12);
  EXPECT_EQ(all[0].verdict, Verdict::met);
  EXPECT_EQ(uniformities(rig_with(0.6), light)[0].verdict, Verdict::missed);
}

TEST(Uniformity, IsUnknownWhereTheIntervalsLeaveItOpen) {
  const std::vector<LuxEstimate> light = {{1, 0}, {400, 40}, {200, 20}, {5, 0}};
  const auto one = uniformities(rig_with(0.55), light)[0];
  EXPECT_NEAR(one.low, 180 / 385.0, 1e-12);
  EXPECT_NEAR(one.high, 220 / 315.0, 1e-12);
  EXPECT_EQ(one.verdict, Verdict::unknown);
  EXPECT_EQ(uniformities(rig_with(0.4), light)[0].verdict, Verdict::met);
  EXPECT_EQ(uniformities(rig_with(0.7), light)[0].verdict, Verdict::missed);
  EXPECT_EQ(text_of(one), "desk: uniformity 0.57 (0.47 to 0.70), wanted 0.55: unknown");
}

TEST(Uniformity, OfDarkOrUnknownLightSaysNothingItDoesNotKnow) {
  const std::vector<LuxEstimate> dark(4);
  EXPECT_TRUE(uniformities(rig_with(0.5), dark).empty());
  const double inf = std::numeric_limits<double>::infinity();
  const std::vector<LuxEstimate> unknown = {{1, 0}, {400, inf}, {200, 20}, {5, 0}};
  const auto one = uniformities(rig_with(0.5), unknown)[0];
  EXPECT_EQ(one.verdict, Verdict::unknown);
  EXPECT_EQ(one.low, 0);
  EXPECT_EQ(one.high, 1);
}

}  // namespace
}  // namespace luxrig
