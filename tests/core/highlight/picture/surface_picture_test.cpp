#include "core/highlight/picture/surface_picture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/highlight/picture/object_view.h"
#include "tests/core/highlight/picture/surface_picture_fixture.h"
#include "tests/core/highlight/shapes.h"

namespace luxrig {
namespace {

using namespace surface_picture_fixture;

/// A plate in the plane y = 0, seen from y = -2 along +Y: x to the right, z up, 100 px a metre in the plane.
Scene plate_across_y(double left_m, double right_m) {
  return parametric(1, 1, [=](double u, double v) { return Vec3(left_m + u * (right_m - left_m), 0, 2 * v - 1); });
}

const Vec3f& pixel(const ColourPicture& picture, double x_m, double z_m) {
  const auto x = static_cast<std::size_t>(100 + 100 * x_m), y = static_cast<std::size_t>(80 - 100 * z_m);
  return picture.rgb[y * 200 + x];
}

/// Area of this colour, in pixels.
double red_px(const ColourPicture& picture) {
  double sum = 0;
  for (const Vec3f& rgb : picture.rgb) sum += std::max(0.0f, rgb.x() - rgb.y());
  return sum;
}

TEST(SurfacePicture, AnEdgePixelIsGreyByItsCoverage) {
  // The plate ends 30.5 pixels left of the middle.
  const ColourPicture picture = picture_of(plate_across_y(-0.305, 0.9), 2).resolved();
  EXPECT_EQ(picture.width_px, 200);
  ASSERT_EQ(picture.rgb.size(), 200u * 160u);
  for (int y = 0; y < 160; ++y) {
    EXPECT_FLOAT_EQ(picture.rgb[static_cast<std::size_t>(200 * y + 68)].x(), 1.0f);
    EXPECT_FLOAT_EQ(picture.rgb[static_cast<std::size_t>(200 * y + 69)].x(), 0.75f) << y;
    EXPECT_FLOAT_EQ(picture.rgb[static_cast<std::size_t>(200 * y + 70)].x(), 0.5f);
  }
}

TEST(SurfacePicture, OmitsSurfacesNearerThanTheCut) {
  const Scene two =
      joined(plate_across_y(-0.5, 0.5), transformed(plate_across_y(-0.5, 0.5), 1, Mat3::Identity(), Vec3(0, -1, 0)));
  SurfacePicture picture(before_the_plate(), 1, 1.2, kWhitePaper);
  Vec3 seen = Vec3::Zero();
  ASSERT_TRUE(picture.draw(RayScene(two),
                           [&](const Hit& hit, const Vec3&) {
                             seen = seen.cwiseMax(hit.position_world_m.cwiseAbs());
                             return kGreyPlate;
                           },
                           1, {}));
  EXPECT_NEAR(seen.y(), 0, 1e-6) << "only the farther plate";
  EXPECT_GT(seen.x(), 0.45);
  EXPECT_TRUE(picture.shows(Vec3(0, 0, 0), 0.001));
  EXPECT_FALSE(picture.shows(Vec3(0, -1, 0), 0.001));
}

TEST(SurfacePicture, ADiscShowsInFrontOfASurfaceAndIsHiddenBehindIt) {
  const Scene plate = plate_across_y(-0.9, 0.9);
  const auto red_of = [&](const Disc& disc) {
    SurfacePicture picture = picture_of(plate, 4);
    picture.draw(std::span(&disc, 1));
    return red_px(picture.resolved());
  };
  // At half the distance, twice as large: 0.1 m are 20 px, the area is π 20².
  EXPECT_NEAR(red_of({Vec3(0.1, -1, 0.1), Vec3::UnitY(), 0.1, 0, kRedDisc, 1}), kPi * 400, 10);
  EXPECT_NEAR(red_of({Vec3(0.1, -1, 0.1), Vec3::UnitY(), 0.1, 0, kRedDisc, 0.25}), kPi * 100, 3);
  EXPECT_EQ(red_of({Vec3(0.1, 0.2, 0.1), Vec3::UnitY(), 0.1, 0, kRedDisc, 1}), 0);
  // Turned by 60° it is half as high (nearly: perspective); edge-on it shows nothing.
  EXPECT_NEAR(red_of({Vec3(0, -0.5, 0), Vec3(0, 0.5, std::sqrt(0.75)), 0.02, 0, kRedDisc, 1}),
              kPi * std::pow(2 / 1.5 * 2, 2) / 2, 0.5);
  EXPECT_EQ(red_of({Vec3(0, -0.5, 0), Vec3::UnitZ(), 0.1, 0, kRedDisc, 1}), 0);
  // A disc that faces the eye wherever it is.
  EXPECT_NEAR(red_of({Vec3(0, -1, 0), Vec3::Zero(), 0.1, 0, kRedDisc, 1}), kPi * 400, 10);
}

TEST(SurfacePicture, ALiftedDiscIsNotCutByItsSurface) {
  const Disc on_it{Vec3(0, 0.001, 0), Vec3::UnitY(), 0.1, 0, kRedDisc, 1};
  Disc lifted = on_it;
  lifted.lift_m = 0.01;
  SurfacePicture picture = picture_of(plate_across_y(-0.9, 0.9), 4);
  EXPECT_FALSE(picture.shows(on_it.centre_world_m, 0));
  EXPECT_TRUE(picture.shows(on_it.centre_world_m, 0.01));
  picture.draw(std::span(&on_it, 1));
  EXPECT_EQ(red_px(picture.resolved()), 0);
  picture.draw(std::span(&lifted, 1));
  EXPECT_NEAR(red_px(picture.resolved()), kPi * 100, 5);
}

TEST(SurfacePicture, TheNearerOfTwoDiscsCoversTheOther) {
  const std::vector<Disc> discs = {{Vec3(0, -1, 0), Vec3::UnitY(), 0.05, 0, Vec3f(0, 0, 1), 1},
                                   {Vec3(0, -0.5, 0), Vec3::UnitY(), 0.2, 0, kRedDisc, 1}};
  SurfacePicture picture = picture_of(Scene{}, 1);
  picture.draw(discs);
  const ColourPicture drawn = picture.resolved();
  EXPECT_EQ(pixel(drawn, 0, 0), Vec3f(0, 0, 1));
  EXPECT_EQ(pixel(drawn, 0.2, 0), kRedDisc);
}

TEST(SurfacePicture, ALineIsHiddenBehindTheSurfaceItCrosses) {
  // It passes through the plate at x = 0, seen at the middle of the picture.
  const DrawnLine line{Vec3(-0.4, -0.5, 0), Vec3(0.4, 0.5, 0), 4, kRedDisc, 0, 0};
  SurfacePicture picture = picture_of(plate_across_y(-0.9, 0.9), 2);
  picture.draw(line);
  const ColourPicture drawn = picture.resolved();
  for (const double x_m : {-0.5, -0.3, -0.1, -0.03}) EXPECT_EQ(pixel(drawn, x_m, 0), kRedDisc) << x_m;
  for (const double x_m : {0.03, 0.1, 0.25}) EXPECT_EQ(pixel(drawn, x_m, 0), kGreyPlate) << x_m;
  EXPECT_EQ(pixel(drawn, -0.1, 0.05), kGreyPlate) << "beside it";
  DrawnLine faint = line;
  faint.hidden_opacity = 0.5;
  picture.draw(faint);
  EXPECT_FLOAT_EQ(pixel(picture.resolved(), 0.1, 0).x(), 0.75f);
}

TEST(SurfacePicture, ALineFromBehindTheEyeIsClipped) {
  SurfacePicture picture = picture_of(Scene{}, 1);
  picture.draw(DrawnLine{Vec3(0.1, -5, 0), Vec3(0.1, 3, 0), 3, kRedDisc, 0, 0});
  EXPECT_EQ(pixel(picture.resolved(), 0.05, 0), kRedDisc);  // at 3 m of 5 m: 0.04 m in the plane
  picture.draw(DrawnLine{Vec3(0, -5, 0), Vec3(0, -3, 0), 3, kRedDisc, 0, 0});
}

TEST(SurfacePicture, ValuesAreLinearBetweenPoints) {
  const Scene sphere = uv_sphere(0.5, 30);
  const auto surface = make_target_surface(sphere);
  ASSERT_TRUE(surface.has_value());
  std::vector<double> constant(surface->points_m.size(), 7.5), linear;
  const Vec3 slope(1, -2, 3);
  for (std::uint32_t i = 0; i < surface->points_m.size(); ++i)
    linear.push_back(4 + slope.dot(surface->point_world_m(i)));
  SurfacePicture picture(before_the_plate(), 1, 0, kWhitePaper);
  double worst = 0, worst_normal = 0;
  int seen = 0;
  ASSERT_TRUE(picture.draw(
      RayScene(sphere),
      [&](const Hit& hit, const Vec3&) {
        const auto corners = corners_at(sphere, *surface, hit);
        EXPECT_TRUE(corners.has_value());
        if (!corners) return kGreyPlate;
        ++seen;
        EXPECT_NEAR(corners->value(constant), 7.5, 1e-12);
        worst = std::max(worst, std::abs(corners->value(linear) - 4 - slope.dot(hit.position_world_m)));
        worst_normal = std::max(worst_normal, (corners->normal(*surface) - hit.position_world_m.normalized()).norm());
        return kGreyPlate;
      },
      1, {}));
  EXPECT_GT(seen, 5000);
  EXPECT_LT(worst, 1e-5);
  EXPECT_LT(worst_normal, 0.02) << "smooth, not the facets' 0.05";
}

}  // namespace
}  // namespace luxrig
