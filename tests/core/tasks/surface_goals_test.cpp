// The place that a person points at, and the points of what is painted there.
#include "core/tasks/surface_goals.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/tasks/tasks_fixture.h"

namespace luxrig {
namespace {

using tasks_fixture::opened;
using tasks_fixture::room_text;

TEST(SurfaceGoals, APlaceIsOnTheSideOfTheWallThatTheRoomSees) {
  const Session room = opened(room_text());
  const auto bounds = room.rays->bounds_world_m();
  const Vec3 middle = bounds.center();
  // Each of the six walls, pointed at from a little inside and a little outside of it.
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      for (const double off_m : {-0.02, 0.02}) {
        Vec3 near = middle + Vec3(0.13, 0.21, 0.17);
        near[axis] = side < 0 ? bounds.min()[axis] : bounds.max()[axis];
        near[axis] += off_m;
        const auto place = place_on_surface(room, near, std::nullopt);
        ASSERT_TRUE(place) << place.error().detail;
        EXPECT_NEAR(place->position_world_m[axis], near[axis] - off_m, 1e-6);
        EXPECT_NEAR(place->normal_world[axis], -side, 1e-6) << "into the room";
        // From outside, the other side is meant.
        Vec3 outside = near;
        outside[axis] += 2 * side;
        const auto behind = place_on_surface(room, near, outside);
        ASSERT_TRUE(behind) << behind.error().detail;
        EXPECT_NEAR(behind->normal_world[axis], side, 1e-6);
      }
  EXPECT_FALSE(place_on_surface(room, bounds.max() + Vec3(9, 9, 9), std::nullopt)) << "nothing is there";
}

TEST(SurfaceGoals, ABucketOnTheFloorAsksForItsLuxAllOverIt) {
  const Session room = opened(room_text());
  const auto bounds = room.rays->bounds_world_m();
  const Vec3 near(bounds.center().x() + 0.3, bounds.center().y() + 0.4, bounds.min().z());
  const auto floor = place_on_surface(room, near, std::nullopt);
  ASSERT_TRUE(floor) << floor.error().detail;
  SurfaceGoalSpec goal;
  goal.name = "floor";
  goal.max_lx = 250;
  goal.weight = 3;
  goal.goal_tolerance = 0.2;
  const Stroke bucket{StrokeKind::bucket, {*floor}, 120};
  SurfacePainter painter(room);
  const auto painted = painter.paint(goal, {&bucket, 1});
  ASSERT_TRUE(painted) << painted.error().detail;
  EXPECT_EQ(painted->lux_range(), std::pair(120.0, 120.0));
  const double floor_m2 = bounds.sizes().x() * bounds.sizes().y();
  EXPECT_GT(painted->area_m2(), 0.7 * floor_m2);
  EXPECT_LT(painted->area_m2(), 1.05 * floor_m2);
  const std::vector<Point> points = points_of(goal, *painted);
  ASSERT_GT(points.size(), 3u);
  double weight = 0;
  for (const Point& point : points) {
    EXPECT_EQ(point.goal_lx, 120);
    EXPECT_EQ(point.max_lx, 250);
    EXPECT_EQ(point.goal_tolerance, 0.2);
    EXPECT_NEAR(point.position_world_m.z(), bounds.min().z(), 1e-6);
    EXPECT_NEAR(point.normal_world.z(), 1, 1e-6);
    weight += point.weight / static_cast<double>(points.size());
  }
  EXPECT_NEAR(weight, 3, 1e-6) << "shared out by area";
  // The eraser takes it away again.
  const std::vector<Stroke> erased{bucket, {StrokeKind::eraser, {*floor}}};
  const auto bare = painter.paint(goal, erased);
  ASSERT_TRUE(bare);
  EXPECT_FALSE(bare->lux_range());
  EXPECT_TRUE(points_of(goal, *bare).empty());
}

}  // namespace
}  // namespace luxrig
