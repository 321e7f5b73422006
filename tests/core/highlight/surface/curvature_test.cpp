#include "core/highlight/surface/curvature.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/core/highlight/shapes.h"
#include "tests/core/highlight/surface/curvature_fixture.h"

namespace luxrig {
namespace {

using namespace curvature_fixture;

TEST(Curvature, OfASphereIsOneOverItsRadiusAtAnyResolutionAndScale) {
  for (const int rings : {40, 90}) {
    for (const double radius_m : {0.1, 0.2, 0.4}) {
      if (radius_m < 2 * kPi / rings) continue;
      const Errors e = errors_against(measured(uv_sphere(1, rings), radius_m), kEverywhereOne);
      EXPECT_EQ(e.unknown, 0u) << rings << " rings, " << radius_m;
      EXPECT_LT(e.mean_worst, 0.004 + 0.35 * radius_m * radius_m) << rings << " rings, " << radius_m;
      EXPECT_LT(e.principal_rms, 0.004 + 0.35 * radius_m * radius_m) << rings << " rings, " << radius_m;
    }
  }
}

TEST(Curvature, OfASphereIsBiasedByTheStatedFourthOrderTerm) {
  const Errors e = errors_against(measured(uv_sphere(1, 100), 0.3), kEverywhereOne);
  EXPECT_NEAR(e.mean_rms / (0.3 * 0.3), 0.17, 0.02);
}

TEST(Curvature, OfACylinderMatchesItsClosedFormWithDirections) {
  for (const int around : {60, 120}) {
    const Measured m = measured(cylinder(1, 2, around, around / 3), 0.25);
    const Errors e = errors_against(m, [](const Vec3& p) -> std::optional<Truth> {
      if (std::abs(p.z()) > 0.74) return std::nullopt;  // the rim
      return Truth{1, 0, Vec3(-p.y(), p.x(), 0).normalized()};
    });
    EXPECT_EQ(e.unknown, 0u);
    EXPECT_LT(e.mean_worst, 0.012);
    EXPECT_LT(e.principal_rms, 0.02);
    EXPECT_LT(e.direction_worst_rad, 0.01);
  }
}

TEST(Curvature, IsKnownAtTheOpenRimOfACylinder) {
  const Measured m = measured(cylinder(1, 2, 120, 40), 0.25);
  const Errors e = errors_against(m, [](const Vec3& p) -> std::optional<Truth> {
    if (std::abs(p.z()) < 0.99) return std::nullopt;
    return Truth{1, 0};
  });
  EXPECT_EQ(e.unknown, 0u);
  EXPECT_LT(e.mean_worst, 0.03);
}

std::optional<Truth> torus_truth(const Vec3& p) {
  // Ring 1, tube 0.4: 1 / tube across, cosθ / (ring + tube cosθ) along.
  const double out = std::hypot(p.x(), p.y());
  return Truth{2.5, (out - 1) / 0.4 / out};
}

TEST(Curvature, OfATorusIsRightOutsideAndInTheHole) {
  for (const int across : {40, 90}) {
    const Errors e = errors_against(measured(torus(1, 0.4, 5 * across / 2, across), 0.12), torus_truth);
    EXPECT_EQ(e.unknown, 0u);
    EXPECT_LT(e.mean_worst, 0.08);
    EXPECT_LT(e.principal_rms, 0.06);
  }
}

TEST(Curvature, OfASaddleHasBothSigns) {
  const Errors e = errors_against(measured(saddle(1, 0.5, 80), 0.1), [](const Vec3& p) -> std::optional<Truth> {
    const double x = p.x(), y = p.y();
    if (std::max(std::abs(x), std::abs(y)) > 0.39) return std::nullopt;
    // Graph of (x² - y²) / 2: Gaussian -1 / w⁴, mean (signed by -z) (y² - x²) / (2 w³), w² = 1 + x² + y².
    const double w2 = 1 + x * x + y * y, mean = -(y * y - x * x) / (2 * std::pow(w2, 1.5)), gauss = -1 / (w2 * w2);
    const double spread = std::sqrt(mean * mean - gauss);
    return Truth{mean + spread, mean - spread};
  });
  EXPECT_EQ(e.unknown, 0u);
  EXPECT_LT(e.mean_worst, 0.01);
  EXPECT_LT(e.principal_rms, 0.01);
}

TEST(Curvature, InwardNormalsFlipItsSign) {
  Scene inside = uv_sphere(1, 60);
  for (auto& t : inside.triangles) std::swap(t[1], t[2]);
  const Errors e = errors_against(measured(inside, 0.2), [](const Vec3&) { return std::optional(Truth{-1, -1}); });
  EXPECT_EQ(e.unknown, 0u);
  EXPECT_LT(e.mean_worst, 0.02);
}

TEST(Curvature, ErrsUnderNoiseAsItsStatedErrorPredicts) {
  // 0.1 % of the size, 2 m: σ = 2 mm.
  const Measured m = measured(noisy(uv_sphere(1, 120), 0.002, 3), 0.25);
  const Errors e = errors_against(m, kEverywhereOne);
  EXPECT_EQ(e.unknown, 0u);
  EXPECT_LT(e.mean_rms, 0.06);
  // Errors in units of the stated one, on even triangles (off the poles), without the bias of the scale.
  double sum = 0, square = 0, count = 0;
  for (std::size_t i = 0; i < m.curvature.size(); ++i) {
    if (std::abs(m.surface.points_m[i].z()) > 0.7) continue;
    const double off = (m.curvature[i].mean_per_m() - 1 - 0.17 * 0.25 * 0.25) / m.curvature[i].mean_error_per_m;
    sum += off;
    square += off * off;
    ++count;
  }
  EXPECT_NEAR(sum / count, 0, 0.5);
  EXPECT_GT(std::sqrt(square / count), 0.6);
  EXPECT_LT(std::sqrt(square / count), 1.5);
}

TEST(Curvature, OfANoisyTorusIsCloseToItsClosedForm) {
  // Size 2.8 m: σ = 2.8 mm; scale 0.2 m, half the tube's radius, whose own bias is 0.17 · 0.25 of 2.5 / m.
  const Errors e = errors_against(measured(noisy(torus(1, 0.4, 200, 80), 0.0028, 5), 0.2), torus_truth);
  EXPECT_EQ(e.unknown, 0u);
  EXPECT_LT(e.mean_rms, 0.15);
}

TEST(Curvature, TurnsAndScalesWithTheMesh) {
  Random random(7);
  const Scene scene = torus(1, 0.4, 100, 40);
  const Measured one = measured(scene, 0.15);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const Mat3 turn = random.rotation();
    const Measured two = measured(transformed(scene, scale, turn, scale * Vec3(1, -2, 3)), 0.15 * scale);
    ASSERT_EQ(two.curvature.size(), one.curvature.size());
    for (std::size_t i = 0; i < one.curvature.size(); ++i) {
      ASSERT_TRUE(two.curvature[i].known());
      EXPECT_NEAR(two.curvature[i].larger_per_m * scale, one.curvature[i].larger_per_m, 0.01);
      EXPECT_NEAR(two.curvature[i].smaller_per_m * scale, one.curvature[i].smaller_per_m, 0.01);
      EXPECT_NEAR(std::abs((turn * one.curvature[i].normal).dot(two.curvature[i].normal)), 1, 1e-4);
    }
  }
}

TEST(Curvature, DoesNotDependOnTheElementOrderOfTheFile) {
  const Scene scene = noisy(torus(1, 0.4, 100, 40), 0.002, 1);
  const Measured one = measured(scene, 0.15), two = measured(shuffled(scene, 9), 0.15);
  ASSERT_EQ(one.curvature.size(), two.curvature.size());
  std::map<std::array<double, 3>, double> mean;
  for (std::size_t i = 0; i < one.curvature.size(); ++i) {
    const Vec3& p = one.surface.points_m[i];
    mean[{p.x(), p.y(), p.z()}] = one.curvature[i].mean_per_m();
  }
  for (std::size_t i = 0; i < two.curvature.size(); ++i) {
    const Vec3& p = two.surface.points_m[i];
    EXPECT_NEAR(two.curvature[i].mean_per_m(), mean.at({p.x(), p.y(), p.z()}), 1e-6);
  }
}

TEST(Curvature, ToleratesScannerArtefacts) {
  // Slivers without area, a fin where three sheets meet, a stray vertex, an island of one triangle; half the surface is
  // missing.
  Scene scene = noisy(uv_sphere(1, 60), 0.001, 4);
  const auto n = static_cast<std::uint32_t>(scene.vertices_m.size());
  scene.triangles.resize(scene.triangles.size() / 2);
  scene.triangles.push_back({5, 5, 9});
  scene.triangles.push_back({n / 4, n / 4 + 1, n});
  scene.vertices_m.push_back({1.5f, 0, 0});
  scene.vertices_m.push_back({9, 9, 9});
  for (const Vec3f& v : {Vec3f(5, 5, 5), Vec3f(5.1f, 5, 5), Vec3f(5, 5.1f, 5)}) scene.vertices_m.push_back(v);
  scene.triangles.push_back({n + 2, n + 3, n + 4});
  scene = with_one_material(scene);
  const Measured m = measured(scene, 0.2);
  std::size_t known = 0;
  for (const Curvature& c : m.curvature) {
    EXPECT_TRUE(std::isfinite(c.larger_per_m) && std::isfinite(c.smaller_per_m) && std::isfinite(c.mean_error_per_m));
    EXPECT_TRUE(c.larger_direction.allFinite() && c.normal.allFinite());
    if (c.known()) ++known;
  }
  EXPECT_GT(known, m.curvature.size() * 99 / 100);
  EXPECT_EQ(m.surface.point_of_vertex[n + 1], TargetSurface::kNone);
  EXPECT_FALSE(m.curvature[m.surface.point_of_vertex[n + 2]].known());
}

TEST(Curvature, KeepsTheTwoSidesOfAThinSheetApart) {
  // Shells of 1.00 and 0.99 m: closer than the scale, of the same curvature with opposite signs.
  Scene scene = uv_sphere(1, 60);
  const Scene inner = uv_sphere(0.99, 60);
  const auto n = static_cast<std::uint32_t>(scene.vertices_m.size());
  scene.vertices_m.insert(scene.vertices_m.end(), inner.vertices_m.begin(), inner.vertices_m.end());
  for (const auto& t : inner.triangles) scene.triangles.push_back({n + t[0], n + t[2], n + t[1]});
  const Measured m = measured(with_one_material(scene), 0.2);
  const Errors e = errors_against(m, [](const Vec3& p) {
    return std::optional(p.norm() > 0.995 ? Truth{1, 1} : Truth{-1 / 0.99, -1 / 0.99});
  });
  EXPECT_EQ(e.unknown, 0u);
  EXPECT_LT(e.mean_worst, 0.02);
}

TEST(Curvature, WeighsLongFacetsByTheirArea) {
  // A cylinder of two rings: the neighbours of the rim are only facets.
  const Errors e = errors_against(measured(cylinder(1, 2, 120, 1), 0.3), [](const Vec3&) { return Truth{1, 0}; });
  EXPECT_EQ(e.unknown, 0u);
  EXPECT_LT(e.mean_worst, 0.05);
}

TEST(Curvature, OfAnEmptyOrTinyMeshIsUnknown) {
  const Measured empty = measured(Scene{}, 0.1);
  EXPECT_TRUE(empty.curvature.empty());
  Scene points;
  points.vertices_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_TRUE(measured(with_one_material(points), 0.1).curvature.empty());
  points.triangles = {{0, 1, 2}};
  for (const Curvature& c : measured(with_one_material(points), 1e-6).curvature) EXPECT_FALSE(c.known());
  // At a scale larger than itself a flat triangle is flat.
  for (const Curvature& c : measured(with_one_material(points), 0.9).curvature) {
    ASSERT_TRUE(c.known());
    EXPECT_NEAR(c.mean_per_m(), 0, 1e-9);
  }
  const auto surface = make_target_surface(with_one_material(points));
  ASSERT_TRUE(surface);
  for (const double bad :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_FALSE(curvature_of(*surface, {{}, bad}));
  points.vertices_m[1].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(make_target_surface(with_one_material(points)));
  points.vertices_m[1].y() = 0;
  points.triangles = {{0, 1, 3}};
  EXPECT_FALSE(make_target_surface(points));
}

TEST(TargetSurface, WeldsSeamsAndListsNeighbours) {
  const auto surface = make_target_surface(uv_sphere(1, 8));
  ASSERT_TRUE(surface);
  EXPECT_EQ(surface->points_m.size(), 7u * 16u + 2u);
  EXPECT_EQ(surface->triangles.size(), 16u * 8u * 2u - 2u * 16u);
  std::size_t poles = 0;
  for (std::uint32_t i = 0; i < surface->points_m.size(); ++i) {
    EXPECT_GT(surface->normals[i].dot(surface->points_m[i]), 0.95);
    EXPECT_TRUE(std::is_sorted(surface->ring(i).begin(), surface->ring(i).end()));
    if (surface->ring(i).size() == 16u) ++poles;
  }
  EXPECT_EQ(poles, 2u);
  // 8 rings: within 3 % of 4 π.
  EXPECT_NEAR(surface->area_m2(), 4 * kPi, 0.05 * 4 * kPi);
}

}  // namespace
}  // namespace luxrig
