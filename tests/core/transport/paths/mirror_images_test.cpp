// A smooth floor mirrors the lamps. The law of reflection gives the brightness.
#include "core/transport/paths/mirror_images.h"

#include <gtest/gtest.h>

#include <random>

#include "core/scene/ray_scene.h"
#include "core/transport/bsdf.h"

namespace luxrig {
namespace {

constexpr double kFlux = 4 * 3.14159265358979323846 * 100;  // 100 cd in all directions

/// A floor of 8 m × 8 m that reflects only by its coat.
Scene smooth_floor(double specular, double roughness) {
  Scene scene;
  scene.vertices_m = {{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}};
  scene.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.material_of_triangle = {0, 0};
  scene.object_of_triangle = {0, 0};
  scene.object_names = {"floor"};
  Material material;
  material.name = "glass";
  material.reflectance_rgb = Vec3::Zero();
  material.specular_reflectance = specular;
  material.roughness = roughness;
  scene.materials = {material};
  return scene;
}

Emitter bare_lamp(const Vec3& position_world_m, double diameter_m = 0) {
  Emitter lamp;
  lamp.intensity = make_isotropic(kFlux);
  lamp.world_from_lamp = {Mat3::Identity(), position_world_m};
  if (diameter_m > 0) lamp.shape = {LuminousShape::Kind::sphere, Vec3::Constant(diameter_m)};
  return lamp;
}

/// Below the lamps and looking down: lit only by the floor.
std::vector<Receiver> below_the_lamps() {
  std::vector<Receiver> receivers;
  for (int i = 0; i < 30; ++i) receivers.push_back({{0.05 * i - 0.7, 0.3, 1.2}, -Vec3::UnitZ()});
  return receivers;
}

TEST(MirrorImages, PlacesAreSampledWithTheirStatedDensity) {
  const Scene scene = smooth_floor(0.5, 0.4);
  const RayScene rays(scene);
  const std::vector<Emitter> emitters = {bare_lamp({0.5, 0.2, 1.5}), bare_lamp({-1, -0.5, 2}, 0.2)};
  const EmitterSampler lamps(emitters, {}, rays.bounds_world_m());
  const MirrorImages images(rays, lamps);
  ASSERT_TRUE(images.any());
  const Vec3 from(-0.2, 0.4, 1);
  const ImageChoice choice = images.seen_from(from, -Vec3::UnitZ());
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit;
  constexpr int kDraws = 400'000;
  for (std::size_t lamp = 0; lamp < 2; ++lamp) {
    // ∫ (draws / density) over any part of the floor is the area of that part.
    double near_m2 = 0, wide_m2 = 0;
    for (int i = 0; i < kDraws; ++i) {
      const auto place = images.draw(choice, from, unit(random), unit(random), unit(random));
      if (place.plane == MirrorImages::kNoPlane || place.place_of_lamp != lamp) continue;
      EXPECT_DOUBLE_EQ(place.density_per_m2,
                       images.density_per_m2(choice, from, place.plane, lamp, place.position_world_m));
      EXPECT_NEAR(place.position_world_m.z(), 0, 1e-12);
      const Vec3 off = place.position_world_m - Vec3(-0.2, 0.1, 0);
      if (off.norm() < 0.3) near_m2 += 1 / (place.density_per_m2 * kDraws);
      if (off.norm() < 1) wide_m2 += 1 / (place.density_per_m2 * kDraws);
    }
    EXPECT_NEAR(near_m2 / (kPi * 0.09), 1, 0.05) << lamp;
    EXPECT_NEAR(wide_m2 / kPi, 1, 0.05) << lamp;
  }
}

TEST(MirrorImages, AreAbsentWhereNothingIsSmooth) {
  const std::vector<Emitter> emitters = {bare_lamp({0.5, 0.2, 1.5})};
  for (const auto& [specular, roughness] : {std::pair(0.0, 0.1), std::pair(0.5, 0.9)}) {
    const Scene scene = smooth_floor(specular, roughness);
    const RayScene rays(scene);
    const EmitterSampler lamps(emitters, {}, rays.bounds_world_m());
    EXPECT_FALSE(MirrorImages(rays, lamps).any());
  }
}

class Mirror : public testing::TestWithParam<std::unique_ptr<Evaluator> (*)(const RayScene&)> {};

// E = F(θ) I cosθ / d², with d the path length via the mirror. Facet slope α = 0.0025 blurs it far below the tolerance.
TEST_P(Mirror, AMirrorFloorLightsLikeTheImageOfItsLamp) {
  const Vec3 at(0.6, -0.2, 1.7);
  const auto receivers = below_the_lamps();
  for (const double specular : {0.04, 0.5})
    for (const double diameter_m : {0.0, 0.02, 0.3}) {
      const Scene scene = smooth_floor(specular, 0.05);
      const RayScene rays(scene);
      EvaluateOptions options;
      options.wanted_rms_error = 0.01;
      options.max_rays = 4'000'000;
      const auto light = GetParam()(rays)->evaluate(receivers, std::vector{bare_lamp(at, diameter_m)}, options);
      ASSERT_TRUE(light) << light.error().detail;
      EXPECT_LE(light->rms_error, 0.01) << specular << " " << diameter_m;
      const Eigen::VectorXd error_lx = light->standard_error_lux(Eigen::VectorXd::Ones(1));
      double ratio = 0;
      for (std::size_t r = 0; r < receivers.size(); ++r) {
        const Vec3 way_m = Vec3(at.x(), at.y(), -at.z()) - receivers[r].position_world_m;
        const double cosine = -way_m.z() / way_m.norm();
        const double fresnel = specular + (1 - specular) * std::pow(1 - cosine, 5);
        const double lux = fresnel * 100 * cosine / way_m.squaredNorm();
        const auto row = static_cast<Eigen::Index>(r);
        EXPECT_NEAR(light->lux_per_level(row, 0), lux, 5 * error_lx[row] + 0.002 * lux)
            << "specular " << specular << " diameter " << diameter_m << " receiver " << r;
        ratio += light->lux_per_level(row, 0) / lux / static_cast<double>(receivers.size());
      }
      EXPECT_NEAR(ratio, 1, 0.01) << specular << " " << diameter_m;
    }
}

INSTANTIATE_TEST_SUITE_P(, Mirror, testing::Values(make_path_evaluator, make_gather_evaluator),
                         [](const auto& one) { return one.index == 0 ? "Path" : "Gather"; });

}  // namespace
}  // namespace luxrig
