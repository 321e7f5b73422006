#include "tools/bench/analytic/closed_forms.h"

#include <gtest/gtest.h>

#include "tools/bench/analytic/box_radiosity.h"
#include "tools/bench/analytic/reference_sky.h"

namespace luxrig {
namespace {

/// ∫ cosθ cosθ' / (π d²) over a parallel or perpendicular surface z = h, in polar or Cartesian coordinates.
double by_quadrature(const Vec3& normal, double h, double x0, double x1, double y0, double y1, bool polar) {
  return integral(gauss_rule(64), x0, x1, y0, y1, [&](double p, double q) {
    const Vec3 to = polar ? Vec3(p * std::cos(q), p * std::sin(q), h) : Vec3(p, q, h);
    return std::max(0.0, normal.dot(to)) * h / (kPi * std::pow(to.squaredNorm(), 2)) * (polar ? p : 1);
  });
}

TEST(GaussNodes, AreExactForPolynomialsOfTwiceTheirDegree) {
  for (const int n : {1, 2, 5, 24, 64}) {
    const GaussNodes rule = gauss_rule(n);
    for (int power = 0; power < 2 * n; ++power) {
      double sum = 0;
      for (std::size_t i = 0; i < rule.nodes.size(); ++i) sum += rule.weights[i] * std::pow(rule.nodes[i], power);
      EXPECT_NEAR(sum, power % 2 ? 0.0 : 2.0 / (power + 1), 1e-13) << n << " nodes, power " << power;
    }
  }
}

TEST(ClosedForms, OfDisksAndRectanglesMatchTheirIntegrals) {
  for (const double h : {0.3, 1.0, 4.0}) {
    EXPECT_NEAR(form_factor_of_parallel_disk(0.7, h, 0), by_quadrature(Vec3::UnitZ(), h, 0, 0.7, 0, 2 * kPi, true),
                1e-12);
    // The element is offset by a from the axis: the disk's points are taken relative to it.
    for (const double a : {0.4, 1.5}) {
      const auto seen = [&](const Vec3& normal) {
        return integral(gauss_rule(96), 0, 0.7, 0, 2 * kPi, [&](double r, double q) {
          const Vec3 to(r * std::cos(q) - a, r * std::sin(q), h);
          return std::max(0.0, normal.dot(to)) * h / (kPi * std::pow(to.squaredNorm(), 2)) * r;
        });
      };
      EXPECT_NEAR(form_factor_of_parallel_disk(0.7, h, a), seen(Vec3::UnitZ()), 1e-9) << h << ' ' << a;
      if (a > 0.7) {
        EXPECT_NEAR(form_factor_of_perpendicular_disk(0.7, h, a), seen(-Vec3::UnitX()), 1e-9) << h << ' ' << a;
      }
    }
    EXPECT_NEAR(form_factor_of_parallel_rectangle(0.9, 0.4, h), by_quadrature(Vec3::UnitZ(), h, 0, 0.9, 0, 0.4, false),
                1e-12);
    EXPECT_NEAR(form_factor_of_perpendicular_rectangle(0.9, 0.4, h),
                by_quadrature(Vec3::UnitY(), h, 0, 0.9, 0, 0.4, false), 1e-12);
  }
}

TEST(ClosedForms, OfASphereMatchItsIntegralEvenAcrossTheHorizon) {
  const GaussNodes rule = gauss_rule(200);
  for (const double d : {1.05, 1.5, 4.0})
    for (const double theta : {0.0, 0.5, 1.2, 1.5, 1.8, 2.4}) {
      const Vec3 normal(std::sin(theta), 0, std::cos(theta));
      const double exact = integral(rule, std::sqrt(1 - 1 / (d * d)), 1, 0, kPi, [&](double c, double q) {
        const double s = std::sqrt(1 - c * c);
        return 2 / kPi * std::max(0.0, normal.dot(Vec3(s * std::cos(q), s * std::sin(q), c)));
      });
      EXPECT_NEAR(form_factor_of_sphere(1, d, theta), exact, 2e-5) << d << ' ' << theta;
    }
}

// Flux is conserved. Away from the edges, where the bench samples, refinement hardly changes the result. The error
// falls with the square of the refinement, so a third of the difference remains.
TEST(BoxRadiosity, ConservesFluxAndHasConverged) {
  const Vec3 size_m(4, 3, 2.5);
  const std::array<double, 6> same = {0.6, 0.6, 0.6, 0.6, 0.6, 0.6};
  const BoxRoom room{size_m, same, 1000, {1.7, 1.1, 1.4}};
  const BoxRadiosity coarse(room, 4), fine(room, 8);
  const GaussNodes rule = gauss_rule(6);
  double flux_lm = 0, largest = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, 1}) {
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      flux_lm += integral(rule, 0, size_m[a], 0, size_m[b], [&](double u, double v) {
        Vec3 at_m = side * size_m[axis] * Vec3::Unit(axis);
        at_m[a] = u, at_m[b] = v;
        const Vec3 normal = (side ? -1.0 : 1.0) * Vec3::Unit(axis);
        const double lux = fine.reflected_lx(at_m, normal);
        const bool amid = std::abs(u / size_m[a] - 0.5) < 0.35 && std::abs(v / size_m[b] - 0.5) < 0.35;
        if (amid) largest = std::max(largest, std::abs(coarse.reflected_lx(at_m, normal) / lux - 1));
        return lux;
      });
    }
  EXPECT_NEAR(flux_lm, 1000 * 0.6 / 0.4, 0.001 * 1500);
  EXPECT_LT(largest, 1.5e-3);
}

TEST(ReferenceSky, OfTypeFiveIsUniform) {
  const ReferenceSky sky(5, {0, 1, 1}, 2000);
  EXPECT_NEAR(sky.luminance_cd_m2(Vec3(1, 2, 0.1).normalized()), 2000, 1e-9);
  EXPECT_NEAR(sky.horizontal_illuminance_lx(), 2000 * kPi, 1e-6);
  EXPECT_EQ(sky.luminance_cd_m2(-Vec3::UnitZ()), 0);
}

// CIE S 011: the overcast sky (type 1) falls from the zenith to about a third of it at the horizon.
TEST(ReferenceSky, OfTypeOneIsThreeTimesBrighterAtTheZenithThanAtTheHorizon) {
  const ReferenceSky sky(1, {0, 1, 1}, 3000);
  EXPECT_NEAR(sky.luminance_cd_m2(Vec3::UnitZ()), 3000, 1e-9);
  EXPECT_NEAR(sky.luminance_cd_m2(Vec3(1, 0, 1e-6).normalized()), 3000 / (1 + 4 * std::exp(-0.7)), 0.01);
  EXPECT_NEAR(sky.luminance_cd_m2(Vec3(0, 1, 1).normalized()) / 3000,
              (1 + 4 * std::exp(-0.7 * std::sqrt(2.0))) / (1 + 4 * std::exp(-0.7)), 1e-9);
}

}  // namespace
}  // namespace luxrig
