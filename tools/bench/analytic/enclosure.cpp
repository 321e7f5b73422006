/// Closed rooms: the integrating sphere, and a cube judged by radiosity.

#include <fmt/format.h>

#include <cmath>

#include "tools/bench/analytic/box_radiosity.h"
#include "tools/bench/analytic/case.h"
#include "tools/bench/analytic/closed_forms.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig {
namespace {

constexpr double kBulb_lm = 1000;

Emitter bulb(const Vec3& position_m) { return {make_isotropic(kBulb_lm), {Mat3::Identity(), position_m}}; }

/// E = Φ/A (direct + ρ/(1-ρ)): a sphere of 20 480 facets around a source at its centre. The source sees the facets
/// slightly tilted, so the wall is uneven by the square of their half angle, 1e-4. The total and the reflected part are
/// judged separately.
void add_spheres(const BenchOptions& options, std::vector<BenchRow>& rows) {
  for (const double reflectance : {0.5, 0.9}) {
    if (options.quick && reflectance > 0.5) continue;
    AnalyticCase one;
    one.scene = make_icosphere(2, 5, reflectance);
    one.emitters = {bulb(Vec3::Zero())};
    one.reflects = true;
    const double reflected_lx = reflected_wall_illuminance_lx(kBulb_lm, area_m2(one.scene), reflectance);
    for (const WallPoint& p : spread_over_walls(one.scene, options.quick ? 2 : 16, Vec3::Zero())) {
      one.receivers.push_back({p.position_m, p.normal});
      one.exact_lx.push_back(reflected_lx);
    }
    one.part = AnalyticCase::Part::reflected;
    one.reflected_share = reflectance;
    one.name = fmt::format("integrating-sphere-{:.0f}-reflected", 100 * reflectance);
    if (!options.quick) measure_case(one, options, rows);
    for (std::size_t r = 0; r < one.receivers.size(); ++r) {
      const Vec3& at = one.receivers[r].position_world_m;
      one.exact_lx[r] += kBulb_lm / (4 * kPi) * -one.receivers[r].normal_world.dot(at) / std::pow(at.norm(), 3);
    }
    one.part = AnalyticCase::Part::total;
    one.reflected_share = 1;
    one.name = fmt::format("integrating-sphere-{:.0f}", 100 * reflectance);
    measure_case(one, options, rows);
  }
}

/// CIE 171:2006, 5.8: interreflection in a cube of 4 m with a source in its middle, and with the source off the middle.
/// Judged by independent radiosity at each place (the text's own formula holds for the mean only).
void add_cubes(const BenchOptions& options, std::vector<BenchRow>& rows) {
  const double edge_m = 4;
  for (const double reflectance : {0.3, 0.5, 0.8})
    for (const Vec3& source_m : {Vec3(2, 2, 2), Vec3(2.4, 1.7, 2.9)}) {
      const bool middle = source_m.x() == 2;
      if (options.quick && (reflectance > 0.5 || middle != (reflectance == 0.5))) continue;
      AnalyticCase one;
      one.scene = make_cube(edge_m, reflectance);
      one.scene.origin_world_m = Vec3::Constant(edge_m / 2);
      one.emitters = {bulb(source_m)};
      one.reflects = true;
      std::array<double, 6> same;
      same.fill(reflectance);
      const BoxRadiosity exact({Vec3::Constant(edge_m), same, kBulb_lm, source_m}, 8);
      for (const WallPoint& p : cube_wall_grid(edge_m, options.quick ? 1 : 2)) {
        // Not in the middle of patches or on their edges.
        const Vec3 shift = Vec3(0.31, -0.23, 0.17),
                   at_m = p.position_m + shift - shift.dot(p.normal) * p.normal + one.scene.origin_world_m;
        one.receivers.push_back({at_m, p.normal});
        one.exact_lx.push_back(exact.direct_lx(at_m, p.normal) + exact.reflected_lx(at_m, p.normal));
      }
      one.name = fmt::format("cie171-5.8-cube-{}-{:.0f}", middle ? "middle" : "aside", 100 * reflectance);
      measure_case(one, options, rows);
    }
}

/// Flux is conserved: the mean over the walls of a closed cube is Φ/(A (1-ρ)), wherever the source is.
void add_cube_means(const BenchOptions& options, std::vector<BenchRow>& rows) {
  const double edge_m = 3, reflectance = 0.5;
  const Scene scene = make_cube(edge_m, reflectance);
  const RayScene rays(scene);
  const GaussNodes rule = gauss_rule(6);
  std::vector<Receiver> receivers;
  std::vector<double> weights;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j < 6; ++j) {
          Vec3 position_m = side * edge_m / 2 * Vec3::Unit(axis);
          position_m[(axis + 1) % 3] = rule.nodes[i] * edge_m / 2;
          position_m[(axis + 2) % 3] = rule.nodes[j] * edge_m / 2;
          receivers.push_back({position_m, -side * Vec3::Unit(axis)});
          weights.push_back(rule.weights[i] * rule.weights[j] / 24);
        }
  const double exact_lx = mean_wall_illuminance_lx(kBulb_lm, area_m2(scene), reflectance);
  const std::vector<Emitter> source = {bulb({0.3, -0.2, 0.4})};
  for (const Method& method : methods()) {
    if (!method.reflects) continue;
    const double wanted = options.quick ? 0.02 : 0.005;
    EvaluateOptions evaluate;
    evaluate.wanted_rms_error = wanted;
    evaluate.threads = options.threads;
    const Measured run = measure(method, rays, receivers, source, evaluate);
    double mean_lx = 0;
    if (run.refused.empty())
      for (std::size_t r = 0; r < weights.size(); ++r)
        mean_lx += weights[r] * run.matrix.lux_per_level(static_cast<Eigen::Index>(r), 0);
    rows.push_back(
        row_of("cube-mean", method.name, std::abs(mean_lx / exact_lx - 1), run, wanted, method.reflected_target));
  }
}

}  // namespace

void add_enclosure_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  add_spheres(options, rows);
  add_cubes(options, rows);
  add_cube_means(options, rows);
}

}  // namespace luxrig
