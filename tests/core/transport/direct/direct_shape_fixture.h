#pragma once
/// Shared by the tests of direct_shape.

#include <gtest/gtest.h>

#include "core/transport/direct/direct_light.h"
#include "core/transport/evaluator.h"
#include "tests/core/transport/closed_forms.h"
#include "tests/core/transport/diffuser.h"
#include "tests/core/transport/lamp_pose.h"

namespace luxrig::direct_shape_fixture {

/// Constant luminance above the horizon.
class UniformSky final : public SkyLuminance {
 public:
  explicit UniformSky(double cd_m2) : cd_m2_(cd_m2) {}
  double luminance_cd_m2(const Vec3& d) const override { return d.z() > 0 ? cd_m2_ : 0; }
  double horizontal_illuminance_lx() const override { return kPi * cd_m2_; }
  DirectionSample sample(double u, double v) const override {
    const double r = std::sqrt(1 - u * u), angle = 2 * kPi * v;
    return {{r * std::cos(angle), r * std::sin(angle), u}, 1 / (2 * kPi)};
  }
  double density_per_sr(const Vec3& d) const override { return d.z() > 0 ? 1 / (2 * kPi) : 0; }

 private:
  double cd_m2_;
};

struct Builder {
  Scene scene;
  void quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, int split = 1) {
    const auto base = static_cast<std::uint32_t>(scene.vertices_m.size());
    for (int i = 0; i <= split; ++i)
      for (int j = 0; j <= split; ++j) {
        const double s = static_cast<double>(i) / split, t = static_cast<double>(j) / split;
        scene.vertices_m.push_back(
            ((1 - s) * (1 - t) * a + s * (1 - t) * b + s * t * c + (1 - s) * t * d).cast<float>());
      }
    const auto row = static_cast<std::uint32_t>(split + 1);
    for (std::uint32_t i = 0; i + 1 < row; ++i)
      for (std::uint32_t j = 0; j + 1 < row; ++j) {
        const std::uint32_t v = base + i * row + j;
        scene.triangles.push_back({v, v + row, v + row + 1});
        scene.triangles.push_back({v, v + row + 1, v + 1});
      }
  }
  void box(const Vec3& l, const Vec3& h, int split = 1) {
    const auto at = [&](int i) { return Vec3(i & 1 ? h.x() : l.x(), i & 2 ? h.y() : l.y(), i & 4 ? h.z() : l.z()); };
    for (const auto& f : {std::array{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}})
      quad(at(f[0]), at(f[1]), at(f[2]), at(f[3]), split);
  }
  Scene done() {
    scene.materials.resize(1);
    scene.material_of_triangle.assign(scene.triangles.size(), 0);
    scene.object_of_triangle.assign(scene.triangles.size(), 0);
    scene.object_names = {"scene"};
    return scene;
  }
};

inline DirectLight direct(const Scene& scene, const std::vector<Receiver>& receivers,
                          const std::vector<Emitter>& emitters, const EvaluateOptions& options = {}) {
  const RayScene rays(scene);
  auto result = direct_light(rays, receivers, emitters, options);
  EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().detail);
  return result ? *result : DirectLight{};
}

/// A luminous rectangle 2 m above the receiver. A screen half-way up hides its part at x < at_x.
struct HalfHidden {
  explicit HalfHidden(double at_x) : at_x_m(at_x) {
    Builder screen;
    screen.quad({-5, -5, 1}, {at_x / 2, -5, 1}, {at_x / 2, 5, 1}, {-5, 5, 1});
    scene = screen.done();
  }
  [[nodiscard]] double expected() const {
    return rectangle_form(at_x_m, 0.8, -0.5, 0.5, 2, Vec3::Zero(), Vec3::UnitZ());
  }
  double at_x_m;
  Scene scene;
  std::vector<Receiver> receivers = {{{0, 0, 0}, Vec3::UnitZ()}};
  std::vector<Emitter> emitters = {{diffuser(1.6), {Mat3::Identity(), {0, 0, 2}}, rectangle(1.6, 1)}};
};

}  // namespace luxrig::direct_shape_fixture
