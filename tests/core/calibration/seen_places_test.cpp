#include "core/calibration/seen_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/core/calibration/box_room.h"

namespace luxrig {
namespace {

using namespace box_room;

Picture even_picture(const Camera& camera, float cd_m2) {
  Picture picture;
  picture.width_px = camera.width_px;
  picture.height_px = camera.height_px;
  picture.luminance_cd_m2.assign(static_cast<std::size_t>(camera.width_px * camera.height_px), Vec3f::Constant(cd_m2));
  return picture;
}

std::vector<std::optional<SeenPlace>> all_of(const std::vector<SeenPlace>& places) {
  return {places.begin(), places.end()};
}

TEST(SeenPlaces, AreWhereTheCameraShowsThemAndPointsOnSurfacesComeFirst) {
  const RayScene rays(room_with_boxes());
  const Camera camera = stated_camera();
  Point on_wall, in_air, behind;
  on_wall.position_world_m = {0.9, 2.935, 1.3};  // 5 mm before a picture
  on_wall.normal_world = {0, -1, 0};
  in_air.position_world_m = {0, 0, 1.5};
  in_air.normal_world = {0, 0, 1};
  behind.position_world_m = {0, -2.99, 1.5};
  behind.normal_world = {0, 1, 0};
  const std::vector points{in_air, on_wall, behind};
  const auto places = seen_places(rays, camera, points, 40);
  ASSERT_GT(places.size(), 30u);
  EXPECT_EQ(places.front().position_world_m, on_wall.position_world_m);
  EXPECT_DOUBLE_EQ(places.front().reflectance, 0.35);
  for (const SeenPlace& place : places) {
    const auto at = pixel_of(camera, place.position_world_m);
    ASSERT_TRUE(at);
    EXPECT_NEAR(at->x_px, place.x_px, 1e-3);
    EXPECT_NEAR(at->y_px, place.y_px, 1e-3);
    EXPECT_GT(place.normal_world.dot(camera.eye_world_m - place.position_world_m), 0);
  }
  EXPECT_TRUE(seen_places(rays, camera, {}, 0).empty());
}

TEST(SeenPlaces, ByAnotherCameraAreTheSamePlacesElsewhereInThePicture) {
  const RayScene rays(room_with_boxes());
  const auto places = seen_places(rays, stated_camera(), {}, 60);
  Camera turned = stated_camera();
  turned.target_world_m += Vec3(0.15, 0, 0.05);
  turned.distortion = 0.01;
  const auto by = places_by(rays, turned, places);
  ASSERT_EQ(by.size(), places.size());
  std::size_t seen = 0;
  for (std::size_t k = 0; k < by.size(); ++k) {
    if (!by[k]) continue;
    ++seen;
    EXPECT_EQ(by[k]->position_world_m, places[k].position_world_m);
    EXPECT_NEAR(by[k]->x_px, pixel_of(turned, places[k].position_world_m)->x_px, 1e-9);
  }
  EXPECT_GT(seen, places.size() * 3 / 4);
  Camera away = stated_camera();
  away.target_world_m = away.eye_world_m - Vec3(0, 1, 0);
  for (const auto& place : places_by(rays, away, places)) EXPECT_FALSE(place);
}

TEST(SeenPlaces, OfAnEvenPictureHaveItsLightAndNoStrayLight) {
  const RayScene rays(room_with_boxes());
  const Camera camera = stated_camera();
  const auto places = seen_places(rays, camera, {}, 30);
  const auto light = seen_light(even_picture(camera, 70), even_picture(camera, 20), all_of(places));
  for (std::size_t k = 0; k < places.size(); ++k) {
    EXPECT_NEAR(light[k]->lux, 50 * kPi / places[k].reflectance, 1e-3);
    EXPECT_NEAR(light[k]->standard_error_lx, 0, 1e-3);
    EXPECT_NEAR(light[k]->veil_lx, 0, 1e-3);
    EXPECT_NEAR(light[k]->halo_lx, 0, 1e-3);
  }
}

// A place is a square of 5 px whose middle may lie anywhere: of a picture that brightens evenly to the right, it shows
// the light at its middle, and the noise of its pixels.
TEST(SeenPlaces, CountPixelsByHowMuchOfThemTheyCover) {
  const RayScene rays(room_with_boxes());
  const Camera camera = stated_camera();
  SeenPlace place = seen_places(rays, camera, {}, 20).front();
  Picture slope = even_picture(camera, 0);
  for (std::size_t i = 0; i < slope.luminance_cd_m2.size(); ++i)
    slope.luminance_cd_m2[i].setConstant(static_cast<float>(i % static_cast<std::size_t>(camera.width_px)) + 0.5f);
  for (const double x_px : {100.0, 100.3, 100.5, 100.9}) {
    place.x_px = x_px;
    place.y_px = 60.7;
    const std::vector<std::optional<SeenPlace>> one{place};
    const auto light = seen_light(slope, even_picture(camera, 0), one);
    EXPECT_NEAR(light[0]->lux, x_px * kPi / place.reflectance, 0.03 * kPi / place.reflectance) << x_px;
  }
}

}  // namespace
}  // namespace luxrig
