#pragma once
/// Shared by the tests of curvature.

#include <gtest/gtest.h>

#include "core/highlight/surface/curvature.h"
#include "tests/core/highlight/shapes.h"

namespace luxrig::curvature_fixture {

struct Measured {
  TargetSurface surface;
  std::vector<Curvature> curvature;
};

inline Measured measured(const Scene& scene, double radius_m, int threads = 0) {
  auto surface = make_target_surface(scene);
  EXPECT_TRUE(surface);
  auto curvature = curvature_of(*surface, {{.threads = threads, .watch = {}}, radius_m});
  EXPECT_TRUE(curvature);
  return {*surface, *curvature};
}

/// Errors over the points with a known truth: root mean square of mean and principal curvatures, largest of mean
/// curvature and of direction.
struct Errors {
  double mean_rms = 0, mean_worst = 0, principal_rms = 0, direction_worst_rad = 0;
  std::size_t points = 0, unknown = 0;
};

struct Truth {
  double larger, smaller;
  Vec3 larger_direction = Vec3::Zero();  // zero: none
};

inline Errors errors_against(const Measured& m, const std::function<std::optional<Truth>(const Vec3&)>& truth_at) {
  Errors errors;
  for (std::size_t i = 0; i < m.surface.points_m.size(); ++i) {
    const auto truth = truth_at(m.surface.points_m[i]);
    if (!truth) continue;
    ++errors.points;
    const Curvature& c = m.curvature[i];
    if (!c.known()) {
      ++errors.unknown;
      continue;
    }
    const double off = c.mean_per_m() - (truth->larger + truth->smaller) / 2;
    errors.mean_rms += off * off;
    errors.mean_worst = std::max(errors.mean_worst, std::abs(off));
    errors.principal_rms +=
        (std::pow(c.larger_per_m - truth->larger, 2) + std::pow(c.smaller_per_m - truth->smaller, 2)) / 2;
    if (!truth->larger_direction.isZero(0))
      errors.direction_worst_rad =
          std::max(errors.direction_worst_rad,
                   std::acos(std::min(1.0, std::abs(c.larger_direction.dot(truth->larger_direction)))));
  }
  const auto known = static_cast<double>(errors.points - errors.unknown);
  errors.mean_rms = std::sqrt(errors.mean_rms / known);
  errors.principal_rms = std::sqrt(errors.principal_rms / known);
  return errors;
}

inline constexpr auto kEverywhereOne = [](const Vec3&) { return std::optional(Truth{1.0, 1.0}); };

}  // namespace luxrig::curvature_fixture
