#include "core/rig/point_goals.h"

#include <gtest/gtest.h>

#include <cmath>

namespace luxrig {
namespace {

Point point(std::optional<double> goal_lx, std::optional<Vec3> goal_rgb, std::optional<double> max_lx, double weight) {
  Point one;
  one.goal_lx = goal_lx;
  one.goal_rgb = goal_rgb;
  one.max_lx = max_lx;
  one.weight = weight;
  return one;
}

const Vec3 kWarm(1.4, 0.9, 0.5);

TEST(PointGoals, HaveARowPerPointAndMarkMissingGoals) {
  const std::vector<Point> points = {point(300, {}, {}, 2), point({}, {}, 50, 1), point(0, {}, 0, 1),
                                     point(5, {}, {}, 0)};
  const PointGoals goals = point_goals(points, false);
  EXPECT_EQ(goals.goal_lx[0], 300);
  EXPECT_TRUE(std::isnan(goals.goal_lx[1]));
  EXPECT_EQ(goals.max_lx[1], 50);
  EXPECT_EQ(goals.weight, Eigen::Vector4d(2, 1, 1, 0));
  EXPECT_EQ(goals.rgb.size(), 0);
  EXPECT_TRUE(goals.asks(0));
  EXPECT_FALSE(goals.asks(1));
  EXPECT_TRUE(goals.asks(2)) << "darkness is a goal";
  EXPECT_FALSE(goals.asks(3)) << "a weight of 0 asks nothing";
  EXPECT_FALSE(goals.limits(0));
  EXPECT_TRUE(goals.limits(1));
  EXPECT_TRUE(goals.limits(2)) << "darkness is a limit";
}

TEST(PointGoals, WithColoursCountOnlyPointsWithAColour) {
  const std::vector<Point> points = {point(300, kWarm, {}, 1), point(200, {}, 400, 1), point({}, kWarm, {}, 1)};
  const PointGoals goals = point_goals(points, true);
  ASSERT_EQ(goals.rgb.rows(), 3);
  EXPECT_EQ(goals.rgb.row(0), kWarm.transpose());
  EXPECT_EQ(goals.rgb.row(1), Eigen::RowVector3d::Ones());
  EXPECT_TRUE(goals.asks(0));
  EXPECT_FALSE(goals.asks(1));
  EXPECT_FALSE(goals.asks(2));
  EXPECT_TRUE(goals.limits(1)) << "its limit holds all the same";
  EXPECT_TRUE(point_goals(points, false).asks(1)) << "in lux alone it counts";
}

TEST(PointGoals, OfNoPointsAreEmpty) {
  EXPECT_EQ(point_goals({}, true).goal_lx.size(), 0);
  EXPECT_EQ(point_goals({}, true).rgb.rows(), 0);
}

}  // namespace
}  // namespace luxrig
