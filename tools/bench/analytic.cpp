/// Evaluators against closed forms.

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "core/transport/enclosures.h"
#include "core/transport/evaluator.h"
#include "tools/bench/suites.h"

namespace luxrig {
namespace {

constexpr double kFlux_lm = 1000;

struct Method {
  const char* name;
  std::unique_ptr<Evaluator> (*make)(const RayScene&);
  bool reflects;  ///< claims interreflection, not only direct light
};
constexpr Method kMethods[] = {{"direct", make_direct_evaluator, false}, {"path", make_path_evaluator, true}};

struct Timed {
  TransportMatrix matrix;
  double seconds = 0;
};

Timed timed(const Method& method, const RayScene& rays, const std::vector<Receiver>& receivers,
            const std::vector<Emitter>& emitters, double wanted, int threads) {
  const auto evaluator = method.make(rays);
  EvaluateOptions options;
  options.wanted_relative_error = wanted;
  options.threads = threads;
  const auto start = std::chrono::steady_clock::now();
  auto result = evaluator->evaluate(receivers, emitters, options);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  if (result) return {std::move(*result), took.count()};
  // The inputs below are valid; should one be refused all the same, its row shows an error that misses every target.
  fmt::print(stderr, "luxrig bench: {}: {}\n", method.name, result.error().detail);
  TransportMatrix none;
  none.lux_per_level = none.direct_lux_per_level = Eigen::MatrixXd::Constant(
      static_cast<Eigen::Index>(receivers.size()), static_cast<Eigen::Index>(emitters.size()), 1e30);
  return {none, took.count()};
}

BenchRow row_of(const std::string& case_name, const Method& method, double error, const Timed& run,
                std::optional<double> wanted, double target) {
  const double rays = static_cast<double>(run.matrix.rays);
  return {case_name,
          method.name,
          error,
          run.seconds,
          target,
          std::nullopt,
          {{"wanted_error", wanted ? fmt::format("{:g}", *wanted) : ""},
           {"reported_error", fmt::format("{:.3g}", run.matrix.relative_error)},
           {"receivers", fmt::format("{}", run.matrix.receivers())},
           {"rays", fmt::format("{}", run.matrix.rays)},
           {"rays_per_second", fmt::format("{:.3g}", run.seconds > 0 ? rays / run.seconds : 0)}}};
}

Emitter bulb(const Vec3& position_m) { return {make_isotropic(kFlux_lm), {Mat3::Identity(), position_m}}; }

/// E = Φ/4π cosθ/d² in open air, for 1 000 random pairs from millimetres to kilometres: the largest relative error.
void point_source(const BenchOptions& options, std::vector<BenchRow>& rows) {
  const RayScene open_air{Scene{}};
  for (const Method& method : kMethods) {
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> unit(-1, 1), exponent(-3, 3);
    const auto any = [&] { return Vec3(unit(random), unit(random), unit(random)); };
    Timed all;
    double worst = 0;
    for (int i = 0; i < 1000; ++i) {
      const double size_m = std::pow(10, exponent(random));
      const Vec3 to_m = size_m * any();
      Vec3 normal = any().normalized();
      if (normal.dot(to_m) < 0) normal = -normal;
      const Timed run = timed(method, open_air, {{Vec3::Zero(), normal}}, {bulb(to_m)}, 0.01, options.threads);
      long double d2 = 0, height = 0;
      for (int k = 0; k < 3; ++k) {
        d2 += static_cast<long double>(to_m[k]) * to_m[k];
        height += static_cast<long double>(normal[k]) * to_m[k];
      }
      const long double exact_lx = kFlux_lm / (4 * std::numbers::pi_v<long double>)*height / (d2 * std::sqrt(d2));
      worst = std::max(worst, static_cast<double>(std::abs(run.matrix.lux_per_level(0, 0) / exact_lx - 1)));
      all.seconds += run.seconds;
      all.matrix = run.matrix;
    }
    rows.push_back(row_of("point-source", method, worst, all, std::nullopt, 1e-5));
  }
}

std::vector<double> wanted_errors(const BenchOptions& options) {
  if (options.quick) return {0.1, 0.03, 0.01};
  return {0.1, 0.03, 0.01, 0.005};
}

/// Mean of the walls of a closed cube around a source off its centre, by Gauss-Legendre quadrature on each face.
void cube(const BenchOptions& options, std::vector<BenchRow>& rows) {
  constexpr double kNodes[] = {-0.9324695142031521, -0.6612093864662645, -0.2386191860831969,
                               0.2386191860831969,  0.6612093864662645,  0.9324695142031521};
  constexpr double kWeights[] = {0.1713244923791704, 0.3607615730481386, 0.4679139345726910,
                                 0.4679139345726910, 0.3607615730481386, 0.1713244923791704};
  constexpr double kEdge_m = 3, kReflectance = 0.5;
  const Scene scene = make_cube(kEdge_m, kReflectance);
  const RayScene rays(scene);
  std::vector<Receiver> receivers;
  std::vector<double> weights;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) {
          Vec3 position_m = side * kEdge_m / 2 * Vec3::Unit(axis);
          position_m[(axis + 1) % 3] = kNodes[i] * kEdge_m / 2;
          position_m[(axis + 2) % 3] = kNodes[j] * kEdge_m / 2;
          receivers.push_back({position_m, -side * Vec3::Unit(axis)});
          weights.push_back(kWeights[i] * kWeights[j] / 24);
        }
  const double exact_lx = mean_wall_illuminance_lx(kFlux_lm, area_m2(scene), kReflectance);
  for (const Method& method : kMethods) {
    if (!method.reflects) continue;
    for (const double wanted : wanted_errors(options)) {
      const Timed run = timed(method, rays, receivers, {bulb({0.3, -0.2, 0.4})}, wanted, options.threads);
      double mean_lx = 0;
      for (std::size_t r = 0; r < weights.size(); ++r)
        mean_lx += weights[r] * run.matrix.lux_per_level(static_cast<Eigen::Index>(r), 0);
      rows.push_back(row_of("cube", method, std::abs(mean_lx / exact_lx - 1), run, wanted, wanted));
    }
  }
}

/// Wall of an integrating sphere (20 480 facets) around a source at its centre: the largest error over 16 places.
void sphere(const BenchOptions& options, std::vector<BenchRow>& rows) {
  constexpr double kReflectance = 0.8;
  const Scene scene = make_icosphere(2, 5, kReflectance);
  const RayScene rays(scene);
  std::vector<Receiver> receivers;
  for (const WallPoint& p : spread_over_walls(scene, 16, Vec3::Zero())) receivers.push_back({p.position_m, p.normal});
  const double reflected_lx = reflected_wall_illuminance_lx(kFlux_lm, area_m2(scene), kReflectance);
  for (const Method& method : kMethods) {
    if (!method.reflects) continue;
    for (const double wanted : wanted_errors(options)) {
      const Timed run = timed(method, rays, receivers, {bulb(Vec3::Zero())}, wanted, options.threads);
      double worst = 0;
      for (Eigen::Index r = 0; r < run.matrix.receivers(); ++r) {
        const double exact_lx = run.matrix.direct_lux_per_level(r, 0) + reflected_lx;
        worst = std::max(worst, std::abs(run.matrix.lux_per_level(r, 0) / exact_lx - 1));
      }
      rows.push_back(row_of("sphere", method, worst, run, wanted, wanted));
    }
  }
}

}  // namespace

std::vector<BenchRow> bench_analytic(const BenchOptions& options) {
  std::vector<BenchRow> rows;
  point_source(options, rows);
  cube(options, rows);
  sphere(options, rows);
  return rows;
}

}  // namespace luxrig
