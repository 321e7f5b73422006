#include "core/highlight/picture/object_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/core/highlight/shapes.h"
#include "tests/random.h"

namespace luxrig {
namespace {

Camera random_camera(Random& random) {
  Camera camera;
  camera.eye_world_m = 5 * random.in_cube();
  camera.target_world_m = camera.eye_world_m + random.between(0.1, 10) * random.direction();
  camera.vertical_fov_rad = random.between(0.1, 2.5);
  camera.width_px = 100 + static_cast<int>(random.below(900));
  camera.height_px = 100 + static_cast<int>(random.below(900));
  return camera;
}

TEST(ObjectView, PlaceInPictureIsTheInverseOfRayDirection) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    Camera camera = random_camera(random);
    if (i == 0) camera.target_world_m = camera.eye_world_m - Vec3::UnitZ();  // straight down
    const double x = random.between(-50, camera.width_px + 50.0), y = random.between(-50, camera.height_px + 50.0);
    const Vec3 ray = ray_direction(camera, x, y);
    const double far_m = random.log_between(0.01, 1000);
    const auto place = place_in_picture(camera, camera.eye_world_m + far_m * ray);
    ASSERT_TRUE(place.has_value());
    EXPECT_NEAR(place->x_px, x, 1e-6);
    EXPECT_NEAR(place->y_px, y, 1e-6);
    const Vec3 ahead = (camera.target_world_m - camera.eye_world_m).normalized();
    EXPECT_NEAR(place->ahead_m, far_m * ray.dot(ahead), 1e-9 * far_m);
    EXPECT_FALSE(place_in_picture(camera, camera.eye_world_m - far_m * ray).has_value()) << "behind the eye";
  }
}

TEST(ObjectView, ACameraThatShowsFillsTheRequestedShareOfTheFrame) {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    std::vector<Vec3> points;
    const Vec3 middle = 100 * random.in_cube(), size(random.log_between(0.01, 10), random.log_between(0.01, 10), 1);
    for (int p = 0; p < 30; ++p) points.push_back(middle + random.in_cube().cwiseProduct(size));
    const double fill = random.between(0.2, 1);
    const Camera camera = camera_that_shows(points, random.direction(), fill, random.between(0.2, 1.5), 640, 400);
    double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
    for (const Vec3& point : points) {
      const auto place = place_in_picture(camera, point);
      ASSERT_TRUE(place.has_value());
      left = std::min(left, place->x_px / 640), right = std::max(right, place->x_px / 640);
      top = std::min(top, place->y_px / 400), bottom = std::max(bottom, place->y_px / 400);
    }
    const double wide = right - left, high = bottom - top;
    EXPECT_NEAR(std::max(wide, high), fill, 1e-7);
    EXPECT_NEAR(wide > high ? (left + right) / 2 : (top + bottom) / 2, 0.5, 1e-7);
    // The shorter side keeps the requested margin, too.
    for (const double edge : {left, 1 - right, top, 1 - bottom}) EXPECT_GE(edge, (1 - fill) / 2 - 1e-7);
  }
}

TEST(ObjectView, OnePointIsSeenFromAMetre) {
  const std::vector<Vec3> point = {Vec3(3, 4, 5)};
  const Camera camera = camera_that_shows(point, Vec3::UnitX(), 0.7, 1, 64, 64);
  EXPECT_LT((camera.eye_world_m - Vec3(4, 4, 5)).norm(), 1e-9);
  EXPECT_LT((camera.target_world_m - point[0]).norm(), 1e-9);
}

/// A square plate across x, `half` to each side, seen from both sides.
Scene plate_across_x(double x_m, double half_m) {
  return parametric(1, 1, [=](double u, double v) { return Vec3(x_m, half_m * (2 * u - 1), half_m * (2 * v - 1)); });
}

TEST(ObjectView, TheCameraThatSeesLooksFromTheRequestedSide) {
  const std::vector<Vec3> shown = {Vec3(-0.1, -0.1, -0.1), Vec3(0.1, 0.1, 0.1)};
  const RayScene nothing{Scene{}};
  for (const Vec3& side : {Vec3(Vec3::UnitX()), Vec3(-Vec3::UnitY()), Vec3(0.6, -0.8, 0)}) {
    const std::vector<Sight> wanted = {{0.1 * side, side, 1}};
    const auto view = camera_that_sees(nothing, shown, wanted, 0.8, 0.6, 100, 100);
    EXPECT_GT(view.camera.eye_world_m.normalized().dot(side), 0.97);
    EXPECT_GT(view.seen, 0.97);
    EXPECT_GT(view.near_m, 0);
    for (const Vec3& point : shown) EXPECT_LT(view.near_m, (point - view.camera.eye_world_m).norm());
  }
}

TEST(ObjectView, TheCameraThatSeesAvoidsObstacles) {
  const std::vector<Vec3> shown = {Vec3(-1, -1, -1), Vec3(1, 1, 1)};
  const std::vector<Sight> wanted = {{Vec3(0, 0, 0)}};
  // A shown plate hides the middle from half of the sides. Walls nearer than anything shown do not, as they are left
  // out.
  const RayScene plate(plate_across_x(0.5, 0.9));
  const auto past = camera_that_sees(plate, shown, wanted, 0.9, 0.6, 100, 100);
  EXPECT_DOUBLE_EQ(past.seen, 1);
  EXPECT_FALSE(plate.occluded(wanted[0].position_world_m, Vec3::Zero(), past.camera.eye_world_m));
  const RayScene walls(uv_sphere(2.2, 24));
  const auto cut = camera_that_sees(walls, shown, wanted, 0.9, 0.6, 100, 100);
  EXPECT_DOUBLE_EQ(cut.seen, 1);
  EXPECT_TRUE(walls.occluded(wanted[0].position_world_m, Vec3::Zero(), cut.camera.eye_world_m));
}

}  // namespace
}  // namespace luxrig
