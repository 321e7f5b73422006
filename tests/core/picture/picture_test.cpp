#include "core/picture/picture.h"

#include <gtest/gtest.h>

#include <random>

#include "core/photometry/sky/sky.h"
#include "tests/core/picture/picture_fixture.h"
#include "tests/core/transport/lamp_pose.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig {
namespace {

using namespace picture_fixture;

TEST(Picture, StopsAtTheWantedNoiseAndReportsIt) {
  const RayScene rays(make_cube(2, 0.6));
  int passes_before = 0;
  for (const double wanted : {0.2, 0.05, 0.02}) {
    PictureOptions options;
    options.wanted_relative_error = wanted;
    options.max_passes = 1000;
    const auto picture =
        render_picture(rays, kPictureBulb, std::vector{1.0}, looking({-0.7, -0.6, 0.4}, {0, 0, -1}), options);
    ASSERT_TRUE(picture.has_value());
    EXPECT_LE(picture->relative_error, wanted);
    EXPECT_GE(picture->passes, passes_before);
    passes_before = picture->passes;
  }
  EXPECT_GT(passes_before, 4);
}

TEST(Picture, CanBeEndedByTheCallerAfterAnyPass) {
  const RayScene rays(make_cube(2, 0.6));
  PictureOptions options;
  options.wanted_relative_error = 0;
  int calls = 0;
  options.after_pass = [&](double done, double) {
    EXPECT_GE(done, 0);
    EXPECT_LE(done, 1);
    return ++calls < 3;
  };
  const auto picture =
      render_picture(rays, kPictureBulb, std::vector{1.0}, looking({-0.7, -0.6, 0.4}, {0, 0, -1}), options);
  ASSERT_TRUE(picture.has_value());
  EXPECT_EQ(picture->passes, 3);
}

// A mirror-like floor shows the lit wall behind it: its luminance varies although its illuminance hardly does.
TEST(Picture, AGlossyFloorReflectsTheRoom) {
  Scene cube = make_cube(2, 0.5);
  const auto contrast = [&](double specular) {
    cube.materials[0].specular_reflectance = specular;
    cube.materials[0].roughness = 0.2;
    const RayScene rays(cube);
    PictureOptions options;
    options.max_passes = 16;
    const auto picture =
        render_picture(rays, kPictureBulb, std::vector{1.0}, looking({-0.7, -0.6, 0.4}, {0.3, 0.2, -1}), options);
    float ratio = 0;
    for (std::size_t i = 0; i < picture->illuminance_lx.size(); ++i)
      ratio = std::max(ratio, picture->luminance_cd_m2[i].y() / picture->illuminance_lx[i]);
    return ratio * static_cast<float>(kPi) / 0.5f;
  };
  EXPECT_NEAR(contrast(0), 1, 1e-3) << "matt: luminance is ρE/π everywhere";
  EXPECT_GT(contrast(0.3), 1.3);
}

TEST(Picture, HasNoIlluminanceWhereNothingIsSeen) {
  const RayScene rays{Scene{}};
  const auto picture = render_picture(rays, kPictureBulb, std::vector{1.0}, looking({0, 0, 0}, {1, 0, 0}), {});
  ASSERT_TRUE(picture.has_value());
  for (const float lx : picture->illuminance_lx) EXPECT_LT(lx, 0);
}

TEST(Picture, ShowsTheSkyWhereNothingIsHit) {
  Emitter sky;
  sky.sky = make_uniform_sky(1000);
  const RayScene nothing{Scene{}};
  const auto picture =
      render_picture(nothing, std::vector{sky}, std::vector{0.5}, looking({0, 0, 0}, {1, 0, 0.001}), {});
  ASSERT_TRUE(picture.has_value());
  // A uniform sky of 1000 lx has 1000/π cd/m²; half of that at level 0.5. The lower rows look below the horizon.
  EXPECT_NEAR(picture->luminance_cd_m2[2 * 33 + 16].y(), 500 / kPi, 0.01);
  EXPECT_EQ(picture->luminance_cd_m2[19 * 33 + 16].y(), 0);
  EXPECT_LT(picture->illuminance_lx[2 * 33 + 16], 0);
}

TEST(Picture, RefusesImpossibleCamerasAndLevels) {
  const RayScene rays{Scene{}};
  const auto cause_of = [&](const Camera& camera, const std::vector<double>& levels) {
    const auto picture = render_picture(rays, kPictureBulb, levels, camera, {});
    return picture ? Cause::system : picture.error().cause;
  };
  Camera camera = looking({0, 0, 0}, {1, 0, 0});
  EXPECT_EQ(cause_of(camera, {}), Cause::invalid);
  EXPECT_EQ(cause_of(camera, {-1}), Cause::invalid);
  EXPECT_EQ(cause_of(looking({1, 2, 3}, {1, 2, 3}), {1}), Cause::invalid);
  camera.vertical_fov_rad = 4;
  EXPECT_EQ(cause_of(camera, {1}), Cause::invalid);
  camera = looking({0, 0, 0}, {1, 0, 0});
  camera.width_px = 0;
  EXPECT_EQ(cause_of(camera, {1}), Cause::invalid);
}

TEST(Picture, StopsWhenAsked) {
  const RayScene rays(make_cube(2, 0.6));
  std::stop_source stop;
  stop.request_stop();
  PictureOptions options;
  options.watch.stop = stop.get_token();
  const auto picture =
      render_picture(rays, kPictureBulb, std::vector{1.0}, looking({-0.7, -0.6, 0.4}, {0, 0, -1}), options);
  ASSERT_FALSE(picture.has_value());
  EXPECT_EQ(picture.error().cause, Cause::cancelled);
}

TEST(PlanView, DrawsWallsDarkAndOpenFloorLightInTheirPlaces) {
  Scene cube = make_cube(4, 0.5);
  cube.origin_world_m = {100, -50, 7};
  const RayScene rays(cube);
  const PlanView view = render_plan_view(rays, 104);
  ASSERT_EQ(view.shade.size(), static_cast<std::size_t>(view.width_px * view.height_px));
  const auto at = [&](double x_m, double y_m) {
    const auto x = static_cast<int>((x_m - view.left_x_world_m) / view.metres_per_px);
    const auto y = static_cast<int>((view.top_y_world_m - y_m) / view.metres_per_px);
    return view.shade.at(static_cast<std::size_t>(y * view.width_px + x));
  };
  EXPECT_GT(at(100, -50), 0.9);
  EXPECT_LT(at(98.02, -50), 0.3);
  EXPECT_LT(at(100.7, -48.02), 0.3);
  EXPECT_GT(at(100, -50), at(98.15, -50.1)) << "corners are shaded";
}

TEST(PlanView, OfAnEmptySceneIsAWhitePixel) {
  const RayScene rays{Scene{}};
  EXPECT_EQ(render_plan_view(rays, 500).shade, std::vector{1.0f});
}

TEST(Picture, PixelOfIsTheInverseOfRayDirection) {
  Camera camera = looking({1, -2, 0.5}, {0.2, 0.3, 0.9});
  camera.vertical_fov_rad = 0.6;
  for (const double x_px : {0.5, 16.5, 30.0})
    for (const double y_px : {0.5, 10.5, 20.0})
      for (const double far_m : {0.3, 5.0}) {
        const auto place = pixel_of(camera, camera.eye_world_m + far_m * ray_direction(camera, x_px, y_px));
        ASSERT_TRUE(place);
        EXPECT_NEAR(place->x_px, x_px, 1e-9);
        EXPECT_NEAR(place->y_px, y_px, 1e-9);
      }
  // The picture is 2 tan(fov / 2) times the distance high.
  const Vec3 middle_m = camera.eye_world_m + 3 * (camera.target_world_m - camera.eye_world_m).normalized();
  EXPECT_NEAR(pixel_of(camera, middle_m)->px_per_m, camera.height_px / (6 * std::tan(0.3)), 1e-9);
  EXPECT_FALSE(pixel_of(camera, camera.eye_world_m - (camera.target_world_m - camera.eye_world_m))) << "behind";
  EXPECT_FALSE(pixel_of(camera, camera.eye_world_m));
  EXPECT_FALSE(pixel_of(camera, camera.eye_world_m + ray_direction(camera, 34, 10)));
}

TEST(Picture, PixelOfIsTheInverseOfRayDirectionOfAnyLens) {
  std::mt19937_64 random(7);
  const auto drawn = [&](double from, double to) { return std::uniform_real_distribution(from, to)(random); };
  for (int k = 0; k < 300; ++k) {
    Camera camera = looking({drawn(-1, 1), drawn(-1, 1), drawn(-1, 1)}, {drawn(-3, 3), drawn(-3, 3), drawn(1.5, 3)});
    camera.vertical_fov_rad = drawn(0.2, 1.5);
    camera.roll_rad = drawn(-kPi, kPi);
    camera.distortion = drawn(-0.2, 0.05);
    const double x_px = drawn(0.01, camera.width_px - 0.01), y_px = drawn(0.01, camera.height_px - 0.01);
    const auto place = pixel_of(camera, camera.eye_world_m + drawn(0.1, 9) * ray_direction(camera, x_px, y_px));
    ASSERT_TRUE(place) << k;
    EXPECT_NEAR(place->x_px, x_px, 1e-7) << k;
    EXPECT_NEAR(place->y_px, y_px, 1e-7) << k;
  }
}

TEST(Picture, ARolledCamerasRightSideGoesDownAndABarrelDrawsCornersIn) {
  Camera camera = looking({0, 0, 0}, {3, 0, 0});
  camera.width_px = camera.height_px = 100;
  camera.vertical_fov_rad = kPi / 2;
  const double before_px = pixel_of(camera, {2, 1, 1})->x_px;  // to the left: 25 px from the middle
  EXPECT_NEAR(before_px, 25, 1e-9);
  camera.roll_rad = kPi / 2;  // what was to the left is below
  EXPECT_NEAR(pixel_of(camera, {2, 1, 0})->x_px, 50, 1e-9);
  EXPECT_NEAR(pixel_of(camera, {2, 1, 0})->y_px, 75, 1e-9);
  camera.roll_rad = 0;
  camera.distortion = -0.1;
  // r = s / (1 - 0.1 s²) with r = ½: s = 2r / (1 + √(1 + 0.4 r²)).
  EXPECT_NEAR(pixel_of(camera, {2, 1, 0})->x_px, 50 - 50 * (1 / (1 + std::sqrt(1.1))), 1e-9);
}

}  // namespace
}  // namespace luxrig
