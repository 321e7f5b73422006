// Contents of the pictures of `luxrig render --show`, on shapes with known answers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/highlight/picture/direction_map.h"
#include "tests/core/highlight/shapes.h"
#include "tools/luxrig/render/render_show.h"
#include "tools/terminal/picture_png.h"

namespace luxrig {
namespace {

RenderOptions small_picture() {
  RenderOptions options;
  options.width_px = 240;
  options.height_px = 200;
  return options;
}

/// A hill on a plane: z = height · exp(-r² / 2 width²). Curvature is negative from r = √2 · width on.
constexpr double kHillWidth_m = 0.1, kHillHeight_m = 0.08;
Scene hill() {
  return parametric(120, 120, [](double u, double v) {
    const double x = 2 * u - 1, y = 2 * v - 1;
    return Vec3(x, y, kHillHeight_m * std::exp(-(x * x + y * y) / (2 * kHillWidth_m * kHillWidth_m)));
  });
}

ShownObject shown_hill(const Vec3& towards_viewer) {
  Scene target = hill();
  auto study = study_relief(target, {});
  EXPECT_TRUE(study.has_value());
  return {"hill", std::move(target), {}, std::move(*study), towards_viewer};
}

bool is_paper(const Vec3f& rgb) { return rgb == Vec3f(1, 1, 1); }

TEST(Figures, ABallsCurvatureHasOneColour) {
  constexpr double kRadius_m = 0.1;
  Scene ball = uv_sphere(kRadius_m, 60);
  auto surface = make_target_surface(ball);
  ASSERT_TRUE(surface.has_value());
  TargetRays rays(ball);
  const ShownObject object{"ball",
                           std::move(ball),
                           {},
                           {std::move(*surface), std::move(rays), 0.02, {}, {}, {}, {}, {}},
                           Vec3(1, 0.5, 0.3).normalized()};
  RenderOptions options = small_picture();
  const auto figure = curvature_figure(object, options);
  ASSERT_TRUE(figure.has_value());
  ASSERT_TRUE(figure->scale.has_value());
  // 1/R = 10 1/m, slightly more by the fit: the scale's next step is 20.
  EXPECT_DOUBLE_EQ(figure->scale->top, 20);
  const Vec3 expected = blue_white_red(0.5 + 10 / 40.0);
  int inside = 0;
  for (int y = 0; y < options.height_px; ++y)
    for (int x = 0; x < options.width_px; ++x) {
      // Well within the outline, which is 75 % of the height.
      if (std::hypot(x - 120, y - 100) > 70) continue;
      const Vec3 rgb = figure->picture.rgb[static_cast<std::size_t>(y * options.width_px + x)].cast<double>();
      ++inside;
      EXPECT_NEAR(rgb.y() / rgb.x(), expected.y() / expected.x(), 0.02);
      EXPECT_NEAR(rgb.z() / rgb.x(), expected.z() / expected.x(), 0.02);
      EXPECT_LE(rgb.x(), expected.x() + 1e-3) << "no brighter than in the legend";
    }
  EXPECT_GT(inside, 10000);
  EXPECT_TRUE(is_paper(figure->picture.rgb.front()));
}

TEST(Figures, DotsLieOnlyInTheRecess) {
  const ShownObject object = shown_hill(Vec3::UnitZ());
  RenderOptions options = small_picture();
  options.eye_world_m = Vec3(0, 0, 3);
  options.target_world_m = Vec3::Zero();
  options.vertical_fov_deg = deg_from_rad(2 * std::atan(0.5 / 3));  // 1 m high at z = 0: 5 mm a pixel
  const auto figure = interest_figure(object, options);
  ASSERT_TRUE(figure.has_value());
  int dots = 0;
  double nearest_m = 1, farthest_m = 0;
  for (int y = 0; y < options.height_px; ++y)
    for (int x = 0; x < options.width_px; ++x) {
      const Vec3f& rgb = figure->picture.rgb[static_cast<std::size_t>(y * options.width_px + x)];
      if (rgb.x() - rgb.z() < 0.3f) continue;
      ++dots;
      const double r_m = 0.005 * std::hypot(x + 0.5 - 120, y + 0.5 - 100);
      nearest_m = std::min(nearest_m, r_m);
      farthest_m = std::max(farthest_m, r_m);
    }
  EXPECT_GT(dots, 200);
  // A dot is up to a spacing wide; the fit's radius blurs the border of the recess.
  EXPECT_GT(nearest_m, 1.1 * kHillWidth_m);
  EXPECT_LT(farthest_m, 5 * kHillWidth_m);
}

TEST(Figures, FeaturesAreColouredAndCounted) {
  const ShownObject object = shown_hill(Vec3(0.3, 0, 1).normalized());
  const auto figure = feature_figure(object, small_picture());
  ASSERT_TRUE(figure.has_value());
  const auto coloured = std::ranges::count_if(figure->picture.rgb,
                                              [](const Vec3f& rgb) { return rgb.maxCoeff() - rgb.minCoeff() > 0.2f; });
  EXPECT_GT(coloured, 100);
  ASSERT_FALSE(figure->key.empty());
  EXPECT_NE(figure->key.front().words.find(std::to_string(*std::ranges::max_element(object.study.features.sizes))),
            std::string::npos);
}

TEST(Figures, TheHistogramMarksItsBestDirection) {
  const ShownObject object = shown_hill(Vec3(0.2, -1, 0.4).normalized());
  ShownRig rig;
  RenderOptions options;
  options.width_px = 640;
  options.height_px = 380;
  options.lights = 1;
  const auto figure = histogram_figure(rig, object, options);
  ASSERT_TRUE(figure.has_value());
  const auto ring = std::ranges::find(figure->labels, FigureMark::ring, &FigureLabel::mark);
  ASSERT_NE(ring, figure->labels.end());
  // The picture has the top colour of the scale there: the direction went to its pixel.
  const auto at = static_cast<std::size_t>(ring->y_px) * 640 + static_cast<std::size_t>(ring->x_px);
  EXPECT_LT((figure->picture.rgb[at].cast<double>() - viridis(1)).norm(), 0.05);
  EXPECT_GT(figure->scale->top, 0);
  // The plane hides what is below it: no shadow edges there, on either half.
  const DirectionMap map(object.towards_viewer);
  int below = 0;
  for (const auto& [x_px, behind] : {std::pair{160, false}, std::pair{480, true}})
    for (int y = 0; y < 380; ++y)
      for (int x = x_px - 140; x < x_px + 140; ++x) {
        const double radius_px = 144, u = (x + 0.5 - x_px) / radius_px, v = (198 - y - 0.5) / radius_px;
        if (u * u + v * v > 0.95 || map.direction_at({behind, u, v}).z() > -0.1) continue;
        ++below;
        const auto pixel = static_cast<std::size_t>(y) * 640 + static_cast<std::size_t>(x);
        EXPECT_LT((figure->picture.rgb[pixel].cast<double>() - viridis(0)).norm(), 1e-3) << x << ' ' << y;
      }
  EXPECT_GT(below, 10000);
}

TEST(Figures, TheDomainMarksItsHeaviestPlace) {
  const ShownObject object = shown_hill(Vec3(0.2, -1, 0.4).normalized());
  ShownRig rig;
  rig.scene = object.target;
  const auto figure = domain_figure(rig, object, small_picture());
  ASSERT_TRUE(figure.has_value());
  ASSERT_EQ(figure->labels.size(), 1u);
  // Its spot, in the scale's top colour, is there; other spots may cover part of it.
  double nearest = 1;
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx) {
      const auto at = static_cast<std::size_t>(figure->labels[0].y_px + dy) * 240 +
                      static_cast<std::size_t>(figure->labels[0].x_px + dx);
      nearest = std::min(nearest, (figure->picture.rgb[at].cast<double>() - viridis(1)).norm());
    }
  EXPECT_LT(nearest, 0.1);
}

SceneObject named_object(const std::string& name, bool mesh) {
  SceneObject object;
  object.name = name;
  if (mesh) object.mesh = MeshFile{};
  return object;
}

TEST(Figures, TheObjectIsTheOnlyMeshOrTheNamedOne) {
  Rig rig;
  const auto none = object_to_show(rig, {});
  ASSERT_FALSE(none.has_value());
  EXPECT_NE(none.error().detail.find("no object from a mesh file"), std::string::npos);
  rig.scene.objects = {named_object("table", false), named_object("skull", true)};
  EXPECT_EQ(object_to_show(rig, {}).value_or(""), "skull");
  EXPECT_EQ(object_to_show(rig, "table").value_or(""), "table");
  const auto unknown = object_to_show(rig, "skul");
  ASSERT_FALSE(unknown.has_value());
  EXPECT_NE(unknown.error().detail.find("did you mean \"skull\"?"), std::string::npos);
  rig.scene.objects.push_back(named_object("vase", true));
  const auto two = object_to_show(rig, {});
  ASSERT_FALSE(two.has_value());
  EXPECT_NE(two.error().detail.find("skull, vase"), std::string::npos);
}

TEST(Figures, TicksAreRoundAndReachTheEnds) {
  EXPECT_EQ(even_ticks(-50, 50, 6), (std::vector<double>{-40, -20, 0, 20, 40}));
  EXPECT_EQ(even_ticks(0, 1, 6).size(), 6u);
  for (const double top : {0.37, 3.0, 41.0, 12345.0}) {
    const auto ticks = even_ticks(0, top, 6);
    EXPECT_GE(ticks.size(), 2u);
    EXPECT_LE(ticks.size(), 6u);
    EXPECT_EQ(ticks.front(), 0);
    EXPECT_LE(ticks.back(), top * (1 + 1e-9));
  }
}

TEST(Figures, TheSignedScaleIsNeutralInItsMiddle) {
  const Vec3 middle = blue_white_red(0.5), recess = blue_white_red(0.1), ridge = blue_white_red(0.9);
  EXPECT_NEAR(middle.maxCoeff() - middle.minCoeff(), 0, 1e-9);
  EXPECT_GT(recess.z(), recess.x() + 0.2);
  EXPECT_GT(ridge.x(), ridge.z() + 0.2);
}

}  // namespace
}  // namespace luxrig
