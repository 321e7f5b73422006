/// Evaluators against a brute-force path tracer that shares no code with them, in cluttered rooms.

#include <gtest/gtest.h>

#include "tests/core/transport/stress/brute_force_path.h"
#include "tests/core/transport/stress/hostile_scene.h"

namespace luxrig {
namespace {

/// A closed room with loose triangles that block the light, duplicate, touch and cut each other.
HostileScene cluttered_room(std::uint64_t seed) {
  HostileScenes dice(seed);
  HostileScene made;
  Scene& scene = made.scene;
  scene.origin_world_m = Vec3(1000, -500, 20) * dice.between(0, 1);
  for (const double reflectance : {0.3, 0.6, 0.85}) {
    Material material;
    material.reflectance_rgb =
        Vec3(reflectance, reflectance * dice.between(0.5, 1), reflectance * dice.between(0.3, 1));
    scene.materials.push_back(material);
  }
  scene.object_names = {"scene"};
  const auto vertex = [&](const Vec3& at_m) {
    scene.vertices_m.push_back(at_m.cast<float>());
    return static_cast<std::uint32_t>(scene.vertices_m.size() - 1);
  };
  const auto quad = [&](const Vec3& a, const Vec3& u, const Vec3& v) {
    const std::uint32_t p = vertex(a), q = vertex(a + u), r = vertex(a + u + v), s = vertex(a + v);
    scene.triangles.insert(scene.triangles.end(), {{p, q, r}, {p, r, s}});
  };
  const Vec3 size_m(4, 3, 2.5), half_m = size_m / 2;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const Vec3 u = Vec3::Unit((axis + 1) % 3) * size_m[(axis + 1) % 3],
                 v = Vec3::Unit((axis + 2) % 3) * size_m[(axis + 2) % 3];
      quad(side * half_m[axis] * Vec3::Unit(axis) - (u + v) / 2, u, v);
    }
  const auto inside = [&](double margin) {
    return Vec3(dice.between(-1, 1) * (half_m.x() - margin), dice.between(-1, 1) * (half_m.y() - margin),
                dice.between(-1, 1) * (half_m.z() - margin));
  };
  for (int i = 0; i < 8; ++i) {
    const Vec3 a = inside(0.3), u = inside(0.3) * 0.6, v = inside(0.3) * 0.6;
    quad(a, u, v);
    if (i == 3) quad(a, u, v);
    if (i == 5) quad(a + 0.5 * u, v, u);
  }
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    scene.object_of_triangle.push_back(0);
    scene.material_of_triangle.push_back(t < 12 ? 1 + static_cast<std::uint32_t>(t % 2)
                                                : static_cast<std::uint32_t>(t / 2 % 3));
  }
  for (int i = 0; i < 3; ++i) {
    const Vec3 normal = Vec3(dice.between(-1, 1), dice.between(-1, 1), dice.between(0.2, 1)).normalized();
    made.receivers.push_back({scene.origin_world_m + inside(0.2), normal});
  }
  made.receivers.push_back({scene.origin_world_m + Vec3(dice.between(-1.5, 1.5), 0.3, -half_m.z()), Vec3::UnitZ()});
  for (int i = 0; i < 2; ++i) {
    const Intensity intensity = i ? make_spot(700, 0.6, 1.1) : make_isotropic(900);
    made.emitters.push_back({intensity, {Mat3::Identity(), scene.origin_world_m + inside(0.3) + Vec3(0, 0, 0.4)}});
  }
  return made;
}

TEST(Agreement, OfPathsWithABruteForceTracerIsWithinBothErrors) {
  constexpr int kPaths = 20'000;
  int beyond_two = 0, count = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const HostileScene made = cluttered_room(seed);
    const RayScene rays(made.scene);
    EvaluateOptions options;
    options.wanted_relative_error = 0.01;
    options.max_rays = 2'000'000;
    const auto matrix = make_path_evaluator(rays)->evaluate(made.receivers, made.emitters, options);
    ASSERT_TRUE(matrix.has_value()) << matrix.error().detail;
    const Eigen::VectorXd levels = Eigen::VectorXd::Ones(matrix->emitters());
    const Eigen::VectorXd lux = matrix->lux(levels), error_lx = matrix->standard_error_lux(levels);
    const BruteForcePath brute(made.scene, made.emitters);
    for (std::size_t r = 0; r < made.receivers.size(); ++r, ++count) {
      const BruteForceLux truth = brute.lux_at(made.receivers[r], kPaths, 77 * seed + r);
      const auto row = static_cast<Eigen::Index>(r);
      const double sigma_lx = std::hypot(error_lx[row], truth.standard_error_lux);
      EXPECT_NEAR(lux[row], truth.lux, 4.5 * sigma_lx) << "seed " << seed << ", receiver " << r;
      beyond_two += std::abs(lux[row] - truth.lux) > 2 * sigma_lx;
    }
  }
  // By chance one in twenty-two is beyond two standard errors. Five of 24 happen once in 300.
  EXPECT_LE(beyond_two, 5) << "of " << count;
}

}  // namespace
}  // namespace luxrig
