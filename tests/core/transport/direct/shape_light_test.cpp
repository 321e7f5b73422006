#include "core/transport/direct/shape_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/photometry/shapes/shape_sampling.h"
#include "tests/core/transport/closed_forms.h"
#include "tests/core/transport/diffuser.h"
#include "tests/random.h"

namespace luxrig {
namespace {

using Kind = LuminousShape::Kind;

LuminousShape disk(double diameter_m) { return {Kind::disk, {diameter_m, 0, 0}}; }
LuminousShape sphere(double diameter_m) { return {Kind::sphere, {diameter_m, 0, 0}}; }
LuminousShape cylinder(double diameter_m, double length_m) { return {Kind::cylinder, {diameter_m, 0, length_m}}; }

/// cosⁿ γ below the horizontal.
class Power final : public IntensityDistribution {
 public:
  explicit Power(double n) : n_(n) {}
  double intensity_cd(const Vec3& d) const override { return d.z() < 0 ? 1000 * std::pow(-d.z(), n_) : 0; }
  double flux_lm() const override { return 2000 * kPi / (n_ + 1); }
  double max_intensity_cd() const override { return 1000; }
  double emission_cone_rad() const override { return kPi; }

 private:
  double n_;
};

TEST(ShapeLight, DiffuseRectanglesFollowTheContourIntegral) {
  Random random(1);
  int lit = 0;
  double evaluations = 0;
  for (int i = 0; i < 2000; ++i) {
    const double x_m = std::exp(random.between(-2, 2)), y_m = std::exp(random.between(-2, 2));
    const Vec3 p = std::exp(random.between(-3, 3)) * random.direction(), n = random.direction();
    const Emitter emitter{std::make_shared<Diffuser>(x_m * y_m, true), {}, rectangle(x_m, y_m)};
    const double expected = rectangle_form(-x_m / 2, x_m / 2, -y_m / 2, y_m / 2, 0, p, n);
    const auto light = shape_light(p, n, emitter, {1e-6, 100'000});
    EXPECT_NEAR(light.lux, expected, 1e-6 * expected + 1e-12) << p.transpose() << " n " << n.transpose();
    if (expected < 1e-6) continue;
    ++lit;
    evaluations += static_cast<double>(light.evaluations);
  }
  EXPECT_GT(lit, 800);
  EXPECT_LT(evaluations / lit, 1500);
}

TEST(ShapeLight, DiffuseDisksFollowTheClosedFormForAFacingReceiver) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const double r = std::exp(random.between(-2, 2)), h = std::exp(random.between(-3, 3)), a = random.between(0, 5);
    const double turn = random.between(0, 6);
    const Emitter emitter{diffuser(kPi * r * r), {}, disk(2 * r)};
    const double expected = parallel_disk_form(r, h, a);
    const Vec3 p(a * std::cos(turn), a * std::sin(turn), -h);
    const auto light = shape_light(p, Vec3::UnitZ(), emitter, {1e-6, 100'000});
    // Far away the closed form itself cancels: a difference of nearly equal numbers.
    EXPECT_NEAR(light.lux, expected, 1e-6 * expected + 1e-14) << r << " " << h << " " << a;
  }
}

TEST(ShapeLight, DiffuseSpheresFollowTheClosedFormEvenAcrossTheHorizon) {
  Random random(3);
  int partly = 0;
  for (int i = 0; i < 2000; ++i) {
    const double radius_m = std::exp(random.between(-2, 2));
    const double distance_m = radius_m * (1 + std::exp(random.between(-4, 3)));
    const Vec3 away = random.direction(), p = distance_m * away;
    Vec3 n = random.direction();
    if (i % 2 == 0)  // for half of them the horizon cuts the sphere
      n = (n - n.dot(away) * away).normalized() + random.between(-1, 1) * radius_m / distance_m * away;
    n.normalize();
    const Emitter emitter{
        make_isotropic(std::pow(2 * kPi * radius_m, 2)), {random.rotation(), Vec3::Zero()}, sphere(2 * radius_m)};
    const double expected = sphere_form(radius_m, distance_m, -n.dot(away));
    const auto light = shape_light(p, n, emitter, {1e-6, 100'000});
    EXPECT_NEAR(light.lux, expected, 2e-6 * expected + 1e-9 * std::pow(radius_m / distance_m, 2))
        << distance_m / radius_m << " " << n.dot(away);
    partly += std::abs(n.dot(away)) * distance_m < radius_m;
  }
  EXPECT_GT(partly, 1000);
}

struct Sum {
  double lux, error_lx;
};

/// By definition: directions drawn in jittered strata. Slow and simple.
Sum by_definition(const Vec3& p, const Vec3& n, const Emitter& emitter, int side) {
  const Pose& pose = emitter.world_from_lamp;
  const Vec3 p_lamp = pose.inverse_direction(p - pose.translation_m), n_lamp = pose.inverse_direction(n);
  Random random(77);
  double sum = 0, sum2 = 0;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const auto s =
          sample_seen_from(emitter.shape, p_lamp, (i + random.between(0, 1)) / side, (j + random.between(0, 1)) / side);
      if (s.density_per_sr == 0) continue;
      const double luminance =
          emitter.intensity->intensity_cd(-s.direction) / projected_area_m2(emitter.shape, s.direction);
      const double lux = luminance * std::max(0.0, n_lamp.dot(s.direction)) / s.density_per_sr;
      sum += lux;
      sum2 += lux * lux;
    }
  const double count = side * side, mean = sum / count;
  return {mean, std::sqrt(std::max(0.0, sum2 / count - mean * mean) / count)};  // upper bound: strata reduce the error
}

TEST(ShapeLight, AnyDistributionOnAnyShapeFollowsTheDefinition) {
  Random random(4);
  const Intensity intensities[] = {diffuser(100), std::make_shared<Power>(20), make_spot(1000, 0.3, 0.6),
                                   make_isotropic(1000), std::make_shared<Diffuser>(100, true)};
  int lit = 0;
  for (int i = 0; i < 1000; ++i) {
    const LuminousShape shape{static_cast<Kind>(1 + i % 4),
                              {random.between(0.05, 2), random.between(0.05, 2), random.between(0.05, 2)}};
    const int k = (i / 4) % 5;
    const Vec3 q(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
    const Emitter emitter{intensities[k], {random.rotation(), q}, shape};
    const Vec3 p = q + std::exp(random.between(-1.5, 2)) * random.direction();
    const Vec3 n = (random.between(0, 1.5) * random.direction() + (q - p).normalized()).normalized();
    const Sum expected = by_definition(p, n, emitter, 40);
    const auto light = shape_light(p, n, emitter);
    ASSERT_TRUE(std::isfinite(light.lux) && light.lux >= 0);
    EXPECT_LE(light.error_lx, 1e-4 * light.lux) << i << ": reached though hard";
    EXPECT_NEAR(light.lux, expected.lux, 4.5 * expected.error_lx + 1e-4 * expected.lux + 1e-9)
        << i << " kind " << 1 + i % 4 << " intensity " << k;
    lit += light.lux > 0;
  }
  EXPECT_GT(lit, 500);
}

TEST(ShapeLight, TheEstimatedErrorBoundsTheTrueOne) {
  // Truth: the same integral to 1e-9. At most one in a hundred may be off by more than estimated.
  Random random(5);
  const Intensity intensities[] = {diffuser(100), std::make_shared<Power>(8), make_spot(1000, 0.5, 0.9)};
  int lit = 0, beyond = 0;
  for (int i = 0; i < 300; ++i) {
    const LuminousShape shape{static_cast<Kind>(1 + i % 4), {0.6, 0.3, 1.2}};
    const Emitter emitter{intensities[(i / 4) % 3], {random.rotation(), Vec3::Zero()}, shape};
    const Vec3 p = std::exp(random.between(-0.3, 2)) * random.direction();
    const Vec3 n = (random.between(0, 1) * random.direction() - p.normalized()).normalized();
    const double exact = shape_light(p, n, emitter, {1e-9, 300'000}).lux;
    const auto light = shape_light(p, n, emitter, {1e-4, 100'000});
    if (!(exact > 1e-6)) continue;
    ++lit;
    beyond += std::abs(light.lux - exact) > light.error_lx + 1e-12 * exact;
    EXPECT_LE(light.error_lx, 1e-4 * light.lux);
    EXPECT_NEAR(light.lux, exact, 3e-4 * exact);
  }
  EXPECT_GT(lit, 120);
  EXPECT_LE(beyond, lit / 100);
}

TEST(ShapeLight, ADiffuserIsAPointWithinOnePercentAtFiveTimesItsSize) {
  // The five-times rule of photometry: on the axis of a disk, point / exact = 1 + (r/d)².
  const Vec3 up = Vec3::UnitZ();
  const auto excess = [&](const LuminousShape& shape, const Vec3& p) {
    const double as_shape = illuminance_lx(p, up, {diffuser(100), {}, shape});
    return illuminance_lx(p, up, {diffuser(100), {}, {}}) / as_shape - 1;
  };
  EXPECT_NEAR(excess(disk(1), {0, 0, -5}), 0.01, 1e-7);
  EXPECT_NEAR(excess(disk(1), {0, 0, -10}), 0.0025, 1e-7);
  EXPECT_NEAR(excess(disk(1), {0, 0, -1}), 0.25, 1e-6);
  EXPECT_NEAR(excess(rectangle(1, 1), {0, 0, -5}), 0.01333, 2e-5);  // 2 a²/6 / d², at 5 sides (next: 5 diagonals)
  EXPECT_NEAR(excess(rectangle(1, 1), {0, 0, -5 * std::sqrt(2)}), 0.0066, 1e-4);
  EXPECT_NEAR(excess(rectangle(1.2, 0.2), {0, 0, -5 * 1.2}), 0.0068, 1e-4);
  for (double offset_m = 0; offset_m < 20; offset_m += 0.5) {
    EXPECT_LT(std::abs(excess(disk(1), {offset_m, 0, -5})), 0.0101) << offset_m;
  }
}

TEST(ShapeLight, TinyShapesFollowTheDistanceLaw) {
  Random random(6);
  for (int i = 0; i < 200; ++i) {
    const Vec3 p = random.direction(), n = random.direction();
    const Pose pose{random.rotation(), Vec3::Zero()};
    const double as_point = illuminance_lx(p, n, {make_spot(1000, 0.5, 1.0), pose, {}});
    for (const double size_m : {1e-9, 1e-6, 1e-4})
      for (const auto& shape : {rectangle(size_m, size_m / 2), disk(size_m), sphere(size_m)})
        EXPECT_NEAR(illuminance_lx(p, n, {make_spot(1000, 0.5, 1.0), pose, shape}), as_point,
                    10 * size_m * as_point + 1e-9)
            << size_m << " " << i;
  }
  EXPECT_EQ(shape_light({0, 0, -1}, Vec3::UnitZ(), {diffuser(1), {}, disk(1e-9)}).evaluations, 1u);
}

TEST(ShapeLight, NoLightArrivesWithinInThePlaneOrBelowTheHorizon) {
  const Vec3 up = Vec3::UnitZ();
  const auto lux = [](const LuminousShape& shape, const Vec3& p, const Vec3& n) {
    const auto light = shape_light(p, n, {make_isotropic(1000), {}, shape});
    EXPECT_TRUE(std::isfinite(light.lux) && light.lux >= 0);
    return light.lux;
  };
  EXPECT_EQ(lux(rectangle(1, 1), {2, 0, 0}, -Vec3::UnitX()), 0) << "edge on";
  EXPECT_EQ(lux(rectangle(1, 1), {0.1, 0, 0}, up), 0);
  EXPECT_EQ(lux(disk(1), {0.1, 0, 0}, up), 0);
  EXPECT_EQ(lux(sphere(1), {0.1, 0, 0}, up), 0);
  EXPECT_EQ(lux(cylinder(1, 1), {0.1, 0, 0.3}, up), 0);
  EXPECT_EQ(lux(rectangle(1, 1), {0, 0, -1}, -up), 0);
  EXPECT_EQ(lux(sphere(1), {0, 0, -1}, -up), 0);
  EXPECT_GT(lux(sphere(1), {0, 0, -1}, Vec3::UnitX()), 0) << "half of it is above the horizon";
  EXPECT_GT(lux(cylinder(1, 1), {0, 0, -1}, Vec3::UnitX()), 0);
  // Sizes of zero.
  EXPECT_EQ(lux(rectangle(0, 1), {0, 0, -1}, up), 0);
  EXPECT_EQ(lux(rectangle(-1, 1), {0, 0, -1}, up), 0);
}

TEST(ShapeLight, NearTheSurfaceADiffuserGivesPiTimesItsLuminance) {
  for (const double h_m : {1e-2, 1e-4, 1e-6}) {
    EXPECT_NEAR(illuminance_lx({0.1, 0.05, -h_m}, Vec3::UnitZ(), {diffuser(1.0 / 4), {}, rectangle(0.5, 0.5)}), kPi,
                100 * h_m * h_m + 4e-6);
    EXPECT_NEAR(illuminance_lx({0.1, 0.05, -h_m}, Vec3::UnitZ(), {diffuser(kPi / 4), {}, disk(1)}), kPi,
                20 * h_m * h_m + 4e-6);
    EXPECT_NEAR(illuminance_lx({0, 0, -0.5 - h_m}, Vec3::UnitZ(), {make_isotropic(kPi * kPi), {}, sphere(1)}),
                kPi * std::pow(0.5 / (0.5 + h_m), 2), 4e-6);
  }
}

TEST(ShapeLight, AllFluxOfAShapeArrivesOnASphereAroundIt) {
  // Flux through a sphere around the lamp, by a product rule over directions, equals the lamp's flux for any shape.
  const Intensity intensity = std::make_shared<Power>(4);
  const Vec3 turn(0.3, -0.2, 0.5);
  for (const auto& shape : {rectangle(0.6, 0.4), disk(0.7), sphere(0.5), cylinder(0.3, 0.8)}) {
    const Emitter emitter{
        intensity, {Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix(), {1, 2, 3}}, shape};
    double flux_lm = 0;
    constexpr int kRings = 60, kPerRing = 80;
    for (int i = 0; i < kRings; ++i)
      for (int j = 0; j < kPerRing; ++j) {
        const double z = 2 * (i + 0.5) / kRings - 1, angle = 2 * kPi * (j + 0.5) / kPerRing, r = std::sqrt(1 - z * z);
        const Vec3 d(r * std::cos(angle), r * std::sin(angle), z);
        flux_lm += shape_light(Vec3(1, 2, 3) + 1.5 * d, -d, emitter, {1e-4, 20'000}).lux * 1.5 * 1.5 * 4 * kPi /
                   (kRings * kPerRing);
      }
    EXPECT_NEAR(flux_lm, intensity->flux_lm(), 2e-3 * intensity->flux_lm()) << static_cast<int>(shape.kind);
  }
}

TEST(ShapeLight, AnySizeAndPlaceGivesAFiniteResultInBoundedWork) {
  Random random(8);
  const Intensity intensities[] = {diffuser(100), make_spot(1000, 0.02, 0.05), make_isotropic(1000)};
  for (int i = 0; i < 2000; ++i) {
    const double size_m = std::pow(10, random.between(-9, 6));
    const Vec3 sizes = size_m * Vec3(std::pow(10, random.between(-4, 0)), std::pow(10, random.between(-4, 0)), 1);
    const Emitter emitter{intensities[i % 3], {}, {static_cast<Kind>(1 + i % 4), sizes}};
    Vec3 p = size_m * std::pow(10, random.between(-3, 3)) * random.direction();
    if (i % 3 == 0) p.z() *= std::pow(10, random.between(-9, 0));
    if (i % 7 == 0) p.x() = p.y() = 0;
    if (i % 11 == 0) p.x() = sizes.x() / 2;
    const auto light = shape_light(p, i % 5 == 0 ? Vec3(-p.normalized()) : random.direction(), emitter, {1e-4, 3'000});
    ASSERT_TRUE(std::isfinite(light.lux) && light.lux >= 0) << i;
    ASSERT_TRUE(std::isfinite(light.error_lx)) << i;
    ASSERT_LE(light.evaluations, 60'000u) << i;
  }
}

}  // namespace
}  // namespace luxrig
