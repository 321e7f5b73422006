/// Luminous flux: the flux onto a sphere around a luminaire equals its emission, at any distance.

#include <cmath>

#include "tools/bench/analytic/case.h"
#include "tools/bench/analytic/closed_forms.h"

namespace luxrig {
namespace {

constexpr double kSource_lm = 1000;

/// Receivers on a sphere of radius_m: Gauss' rule in the cosine of γ between `breaks_rad`, the kinks of the
/// distribution, and even steps around the axis. One row, with the error of their weighted sum.
void add_flux(const std::string& name, const Emitter& lamp, double radius_m, std::vector<double> breaks_rad,
              double target, const BenchOptions& options, std::vector<BenchRow>& rows) {
  const GaussNodes rule = gauss_rule(24);
  constexpr int kAround = 48;
  std::vector<Receiver> receivers;
  std::vector<double> weights_m2;
  breaks_rad.insert(breaks_rad.begin(), 0.0);
  breaks_rad.push_back(kPi);
  for (std::size_t piece = 0; piece + 1 < breaks_rad.size(); ++piece)
    for (std::size_t n = 0; n < rule.nodes.size(); ++n) {
      const double half = (breaks_rad[piece + 1] - breaks_rad[piece]) / 2;
      const double gamma = breaks_rad[piece] + half * (1 + rule.nodes[n]);
      for (int c = 0; c < kAround; ++c) {
        const double turn = 2 * kPi * (c + 0.25) / kAround;
        const Vec3 leaving = lamp.world_from_lamp.direction(
            {std::sin(gamma) * std::cos(turn), std::sin(gamma) * std::sin(turn), -std::cos(gamma)});
        receivers.push_back({lamp.world_from_lamp.translation_m + radius_m * leaving, -leaving});
        weights_m2.push_back(rule.weights[n] * half * std::sin(gamma) * 2 * kPi / kAround * radius_m * radius_m);
      }
    }
  const RayScene open_air{Scene{}};
  const std::vector<Emitter> emitters = {lamp};
  for (const Method& method : methods()) {
    EvaluateOptions evaluate;
    evaluate.threads = options.threads;
    const Measured run = measure(method, open_air, receivers, emitters, evaluate);
    double flux_lm = 0;
    if (run.refused.empty())
      for (std::size_t r = 0; r < receivers.size(); ++r)
        flux_lm += weights_m2[r] * run.matrix.lux_per_level(static_cast<Eigen::Index>(r), 0);
    rows.push_back(
        row_of(name, method.name, std::abs(flux_lm / lamp.intensity->flux_lm() - 1), run, std::nullopt, target));
  }
}

}  // namespace

void add_flux_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  const Pose pose{Eigen::AngleAxisd(0.6, Vec3(1, 2, 3).normalized()).toRotationMatrix(), {4, 5, 6}};
  constexpr double kFluxTarget = 1e-6, kSizedTarget = 1e-4;
  const double down = kPi / 2;
  add_flux("flux-isotropic", {make_isotropic(kSource_lm), pose}, 3, {down}, kFluxTarget, options, rows);
  add_flux("flux-lambertian", {make_lambertian(kSource_lm), pose}, 3, {down}, kFluxTarget, options, rows);
  add_flux("flux-cosine-power-20", {make_cosine_power(kSource_lm, 20), pose}, 3, {down}, kFluxTarget, options, rows);
  const double field = rad_from_deg(54);
  add_flux("flux-spot", {make_spot(kSource_lm, rad_from_deg(30), field), pose}, 3, {field / 2, field}, kFluxTarget,
           options, rows);
  // The whole sphere around a luminaire with size, from well within five times its size.
  const auto sized = [&](const Intensity& intensity, LuminousShape::Kind kind, const Vec3& size_m) {
    Emitter lamp{intensity, pose};
    lamp.shape = {kind, size_m};
    return lamp;
  };
  const Intensity flat = make_lambertian(kSource_lm), round = make_isotropic(kSource_lm);
  add_flux("flux-disk", sized(flat, LuminousShape::Kind::disk, {0.6, 0, 0}), 1, {down}, kSizedTarget, options, rows);
  add_flux("flux-rectangle", sized(flat, LuminousShape::Kind::rectangle, {1.2, 0.3, 0}), 1, {down}, kSizedTarget,
           options, rows);
  add_flux("flux-sphere", sized(round, LuminousShape::Kind::sphere, {0.5, 0, 0}), 1, {down}, kSizedTarget, options,
           rows);
  add_flux("flux-cylinder", sized(round, LuminousShape::Kind::cylinder, {0.1, 0, 1.2}), 1, {down}, 1e-3, options, rows);
}

}  // namespace luxrig
