/// CIE 171:2006, 5.4, 5.6 and 5.7 from first principles: flux from an opening, one diffuse reflection, and the same
/// past an obstruction. Dimensions are our own; the references are form factors and their quadrature.

#include <cmath>

#include "tools/bench/analytic/case.h"
#include "tools/bench/analytic/closed_forms.h"
#include "tools/bench/analytic/rectangle_scene.h"

namespace luxrig {
namespace {

/// A black room of 4 × 4 × 3 m, lit through a luminous opening of 1 × 1 m in its ceiling: all its flux falls inside.
void add_opening_flux(const BenchOptions& options, std::vector<BenchRow>& rows) {
  constexpr double kFlux_lm = 1000;
  const Vec3 size_m(4, 4, 3);
  RectangleScene room;
  room.add_box(Vec3::Zero(), size_m, 0);
  const Scene scene = room.scene();
  const RayScene rays(scene);
  Emitter opening{make_lambertian(kFlux_lm), {Mat3::Identity(), {2, 2, 3}}};
  opening.shape = {LuminousShape::Kind::rectangle, {1, 1, 0}};
  const GaussNodes rule = gauss_rule(24);
  std::vector<Receiver> receivers;
  std::vector<double> weights_m2;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, 1}) {
      if (axis == 2 && side == 1) continue;
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      for (std::size_t i = 0; i < rule.nodes.size(); ++i)
        for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
          Vec3 at_m = Vec3::Unit(axis) * side * size_m[axis];
          at_m[a] = size_m[a] * (0.5 + 0.5 * rule.nodes[i]);
          at_m[b] = size_m[b] * (0.5 + 0.5 * rule.nodes[j]);
          receivers.push_back({at_m, (side ? -1.0 : 1.0) * Vec3::Unit(axis)});
          weights_m2.push_back(rule.weights[i] * rule.weights[j] * size_m[a] * size_m[b] / 4);
        }
    }
  const std::vector<Emitter> emitters = {opening};
  for (const Method& method : methods()) {
    EvaluateOptions evaluate;
    evaluate.threads = options.threads;
    const Measured run = measure(method, rays, receivers, emitters, evaluate);
    double flux_lm = 0;
    if (run.refused.empty())
      for (std::size_t r = 0; r < receivers.size(); ++r)
        flux_lm += weights_m2[r] * run.matrix.lux_per_level(static_cast<Eigen::Index>(r), 0);
    rows.push_back(row_of("cie171-5.4-flux", method.name, std::abs(flux_lm / kFlux_lm - 1), run, std::nullopt, 1e-4));
  }
}

/// A surface S2 (z = 0, |x|, |y| ≤ half) of reflectance 0.8 under a lamp 20 m away, 35° off its normal. Nothing else
/// reflects. S1-v stands at x = 4, faces S2 and has its back to the lamp. S1-hz hangs at z = 3 and faces down. With an
/// obstruction, a black screen of 1.5 m stands at x = 2.5, far wider than S2.
AnalyticCase one_reflection(const std::string& name, double half_m, bool obstructed) {
  constexpr double kReflectance = 0.8, kScreenX_m = 2.5, kScreenHeight_m = 1.5, kFlux_lm = 1e6;
  AnalyticCase one;
  one.name = name;
  one.part = AnalyticCase::Part::reflected;
  one.reflects = true;
  RectangleScene scene;
  scene.add({-half_m, -half_m, 0}, {2 * half_m, 0, 0}, {0, 2 * half_m, 0}, kReflectance);
  if (obstructed) scene.add({kScreenX_m, -200, 0}, {0, 400, 0}, {0, 0, kScreenHeight_m}, 0);
  one.scene = scene.scene();
  const double z = std::cos(rad_from_deg(35));
  const Vec3 lamp_m = 20 * Vec3(0.3, -std::sqrt(1 - 0.09 - z * z), z);
  one.emitters.push_back({make_isotropic(kFlux_lm), {Mat3::Identity(), lamp_m}});
  const GaussNodes rule = gauss_rule(40);
  const auto expect = [&](const Vec3& at_m, const Vec3& normal) {
    double right_m = half_m;
    if (obstructed && at_m.x() > kScreenX_m) {
      // Seen from the receiver, the screen's edge meets S2's plane at this x; everything nearer is hidden.
      if (at_m.z() <= kScreenHeight_m) return;
      right_m = std::min(half_m, at_m.x() - (at_m.x() - kScreenX_m) * at_m.z() / (at_m.z() - kScreenHeight_m));
      if (right_m <= -half_m) return;
    }
    const double lux = integral(rule, -half_m, right_m, -half_m, half_m, [&](double x, double y) {
      const Vec3 from_m(x, y, 0), to_lamp_m = lamp_m - from_m, to_m = at_m - from_m;
      const double lit_lx = kFlux_lm / (4 * kPi) * to_lamp_m.z() / std::pow(to_lamp_m.norm(), 3);
      return kReflectance / kPi * lit_lx * to_m.z() * -normal.dot(to_m) / std::pow(to_m.squaredNorm(), 2);
    });
    one.receivers.push_back({at_m, normal});
    one.exact_lx.push_back(lux);
  };
  for (int i = 1; i <= 8; ++i) {
    expect({4, 0.35 * (i % 3), 0.45 * i}, -Vec3::UnitX());
    expect({-2 + 0.5 * i, 0.3, 3}, -Vec3::UnitZ());
  }
  return one;
}

}  // namespace

void add_reflection_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  add_opening_flux(options, rows);
  const std::size_t receivers = options.quick ? 3 : 16;
  measure_case(with_receivers(one_reflection("cie171-5.6-reflection-4m", 2, false), receivers), options, rows);
  if (!options.quick) measure_case(one_reflection("cie171-5.6-reflection-0.5m", 0.25, false), options, rows);
  measure_case(with_receivers(one_reflection("cie171-5.7-obstruction", 2, true), receivers), options, rows);
}

}  // namespace luxrig
