// White furnace: under a uniform sky, a basin that absorbs nothing is as bright as the sky in every direction. It
// reveals light lost or gained by the gloss model or along the way.
#include <gtest/gtest.h>

#include "core/photometry/sky/sky.h"
#include "core/scene/ray_scene.h"
#include "core/transport/bsdf.h"
#include "core/transport/evaluator.h"

namespace luxrig {
namespace {

constexpr double kLux = 10'000;
constexpr int kEvenSky = 5;  ///< sky type in CIE S 011

/// Floor and four walls of 2 m × 2 m × 1 m, open above.
Scene basin(double body, double specular, double roughness) {
  Scene scene;
  for (int i = 0; i < 8; ++i) scene.vertices_m.push_back({i & 1 ? 1.f : -1.f, i & 2 ? 1.f : -1.f, i & 4 ? 1.f : 0.f});
  constexpr std::uint32_t kFaces[5][4] = {{0, 1, 3, 2}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  for (const auto& f : kFaces) {
    scene.triangles.push_back({f[0], f[1], f[2]});
    scene.triangles.push_back({f[0], f[2], f[3]});
  }
  scene.material_of_triangle.assign(10, 0);
  scene.object_of_triangle.assign(10, 0);
  scene.object_names = {"basin"};
  Material material;
  material.name = "glaze";
  material.reflectance_rgb = Vec3::Constant(body);
  material.specular_reflectance = specular;
  material.roughness = roughness;
  scene.materials = {material};
  return scene;
}

class WhiteFurnace : public testing::TestWithParam<std::unique_ptr<Evaluator> (*)(const RayScene&)> {};

TEST_P(WhiteFurnace, IsAsBrightAsTheSkyAtAnyGlossAndRoughness) {
  std::vector<Receiver> receivers;
  for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(0, -1, 0)})
    for (int i = 0; i < 8; ++i) receivers.push_back({{-0.9 + 0.23 * i, 0.3, 0.25}, normal});  // enough to share paths
  Emitter sky;
  sky.sky = make_general_sky(kEvenSky, Vec3(0.3, 0, 0.8).normalized(), kLux);
  sky.world_from_lamp = {Mat3::Identity(), Vec3::Zero()};
  EvaluateOptions options;
  options.wanted_relative_error = 0.1;
  for (const double specular : {0.0, 0.04, 0.5, 0.95})
    for (const double roughness : {0.05, 0.1, 0.3, 0.6, 1.0}) {
      const Scene scene = basin(1, specular, roughness);
      const RayScene rays(scene);
      const auto transport = GetParam()(rays)->evaluate(receivers, std::vector{sky}, options);
      ASSERT_TRUE(transport) << transport.error().detail;
      const Eigen::VectorXd error_lx = transport->standard_error_lux(Eigen::VectorXd::Ones(1));
      EXPECT_LE(transport->relative_error, 0.1) << "specular " << specular << " roughness " << roughness;
      for (Eigen::Index r = 0; r < error_lx.size(); ++r)
        EXPECT_NEAR(transport->lux_per_level(r, 0), kLux, 6 * error_lx[r])
            << "specular " << specular << " roughness " << roughness << " receiver " << r;
      // All share the same light vertices, so their mean is known little better than each value.
      EXPECT_NEAR(transport->lux_per_level.mean(), kLux, 3 * error_lx.mean())
          << "specular " << specular << " roughness " << roughness;
      if (specular == 0) break;
    }
}

// Receivers that look down on the plate see the sky in its gloss. Neither random light sampling nor light vertices find
// it.
TEST_P(WhiteFurnace, APlateMirrorsTheSkyAsItsModelPredicts) {
  Scene scene = basin(0.95, 0.04, 0.05);
  for (Vec3f& vertex : scene.vertices_m) vertex *= 5;
  scene.triangles.resize(2);
  scene.material_of_triangle.resize(2);
  scene.object_of_triangle.resize(2);
  std::vector<Receiver> receivers;
  for (int i = 0; i < 30; ++i) receivers.push_back({{0.1 * i - 1.5, 0.05, 0.02}, -Vec3::UnitZ()});
  Emitter sky;
  sky.sky = make_general_sky(kEvenSky, Vec3(0.3, 0, 0.8).normalized(), kLux);
  sky.world_from_lamp = {Mat3::Identity(), Vec3::Zero()};
  for (const double roughness : {0.05, 0.1, 0.5}) {
    scene.materials[0].roughness = roughness;
    const Bsdf bsdf(scene.materials[0]);
    constexpr int kSteps = 1000;
    double expected_lx = 0;  // cosine-weighted mean reflection; the plate fills all but 1e-5 of the view
    for (int i = 0; i < kSteps; ++i) {
      const double cosine = (i + 0.5) / kSteps, coat = bsdf.coat_albedo(cosine);
      expected_lx += kLux * 2 * cosine * (coat + 0.95 * (1 - coat)) / kSteps;
    }
    const RayScene rays(scene);
    const auto transport = GetParam()(rays)->evaluate(receivers, std::vector{sky}, EvaluateOptions{});
    ASSERT_TRUE(transport) << transport.error().detail;
    const Eigen::VectorXd error_lx = transport->standard_error_lux(Eigen::VectorXd::Ones(1));
    EXPECT_LE(error_lx.maxCoeff(), 0.01 * kLux);
    EXPECT_NEAR(transport->lux_per_level.mean(), expected_lx, 2 * error_lx.mean()) << "roughness " << roughness;
  }
}

INSTANTIATE_TEST_SUITE_P(Evaluators, WhiteFurnace, testing::Values(make_path_evaluator, make_gather_evaluator),
                         [](const auto& which) { return which.index == 0 ? "path" : "gather"; });

}  // namespace
}  // namespace luxrig
