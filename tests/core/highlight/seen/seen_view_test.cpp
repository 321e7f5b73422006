#include "core/highlight/seen/seen_view.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/core/highlight/seen/seen_fixture.h"

namespace luxrig {
namespace {

using namespace seen_fixture;

// A ball's disc is 92 % of the picture wide.
TEST(SeenView, BallFillsItsPicture) {
  const RayScene ball(uv_sphere(0.5, 128));
  for (const double distance_m : {0.7, 3.0, 100.0}) {
    const SeenView view = view_on(ball, ball, {0, -distance_m, 0});
    EXPECT_EQ(view.width_px, 96);
    EXPECT_EQ(view.height_px, 96);
    const double radius_px = 0.92 * 96 / 2;
    EXPECT_NEAR(static_cast<double>(view.object_samples), kPi * radius_px * radius_px, 120) << distance_m;
    EXPECT_EQ(view.samples.size(), view.object_samples);  // nothing is behind it
    for (const OrientedPoint& at : view.samples) {
      EXPECT_NEAR(at.position_world_m.norm(), 0.5, 1e-3);
      EXPECT_GT(at.normal.dot(Vec3(0, -distance_m, 0) - at.position_world_m), 0);
    }
  }
}

TEST(SeenView, WhatIsHiddenIsNotSeenAndWhatBordersIsKept) {
  const Scene ball = uv_sphere(0.5, 64);
  const Scene wall = parametric(1, 1, [](double u, double v) { return Vec3(8 * (u - 0.5), 1, 8 * (v - 0.5)); });
  // Its right half is behind a board.
  const Scene board = parametric(1, 1, [](double u, double v) { return Vec3(2 * u, -1, 4 * (v - 0.5)); });
  const RayScene object(ball), free(joined(ball, wall)), covered(joined(joined(ball, wall), board));
  const SeenView whole = view_on(free, object, {0, -100, 0}), half = view_on(covered, object, {0, -100, 0});
  EXPECT_NEAR(static_cast<double>(half.object_samples), 0.5 * static_cast<double>(whole.object_samples), 100);
  EXPECT_GT(whole.samples.size(), whole.object_samples + 200);  // a ring of the wall
  EXPECT_LT(whole.samples.size(), whole.object_samples + 700);
  for (std::size_t s = whole.object_samples; s < whole.samples.size(); ++s)
    EXPECT_NEAR(whole.samples[s].position_world_m.y(), 1, 1e-4);
  for (std::size_t s = 0; s < half.object_samples; ++s) EXPECT_LT(half.samples[s].position_world_m.x(), 0.02);
}

TEST(SeenView, RefusesWhatCannotBeSeen) {
  const Scene ball = uv_sphere(0.5, 16);
  const Scene board = parametric(1, 1, [](double u, double v) { return Vec3(8 * (u - 0.5), -1, 8 * (v - 0.5)); });
  const RayScene object(ball), covered(joined(ball, board)), nothing{Scene{}};
  EXPECT_FALSE(see_object(object, object, {0, std::numeric_limits<double>::quiet_NaN(), 0}, {}));
  EXPECT_FALSE(see_object(object, object, Vec3::Zero(), {}));
  EXPECT_FALSE(see_object(object, nothing, {0, -3, 0}, {}));
  const auto hidden = see_object(covered, object, {0, -3, 0}, {});
  ASSERT_FALSE(hidden);
  EXPECT_NE(hidden.error().detail.find("in sight"), std::string::npos);
}

TEST(SeenView, VisitorsWalkAroundTheObject) {
  const RayScene ball(transformed(uv_sphere(0.5, 16), 1, Mat3::Identity(), {4, 5, 1}));
  const std::vector<Vec3> eyes = eyes_around(ball, {4, 2, 1.5});
  ASSERT_EQ(eyes.size(), 3u);
  for (const Vec3& eye : eyes) {
    EXPECT_NEAR((eye - Vec3(4, 5, 1)).head<2>().norm(), 3, 1e-5);
    EXPECT_NEAR(eye.z(), 1.5, 1e-9);
  }
  EXPECT_NEAR((eyes[1] - eyes[2]).norm(), 2 * 3 * std::sin(rad_from_deg(40)), 1e-5);
}

}  // namespace
}  // namespace luxrig
