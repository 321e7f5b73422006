#include "core/photometry/shapes/shape_sampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "tests/random.h"

namespace luxrig {
namespace {

using Kind = LuminousShape::Kind;

LuminousShape rectangle(double x_m, double y_m) { return {Kind::rectangle, {x_m, y_m, 0}}; }
LuminousShape disk(double diameter_m) { return {Kind::disk, {diameter_m, 0, 0}}; }
LuminousShape sphere(double diameter_m) { return {Kind::sphere, {diameter_m, 0, 0}}; }
LuminousShape cylinder(double diameter_m, double length_m) { return {Kind::cylinder, {diameter_m, 0, length_m}}; }

/// Distance along a ray to the first hit of the shape, from the shape's definition; independent of the code under test.
std::optional<double> met_at_m(const LuminousShape& shape, const Vec3& from_m, const Vec3& d) {
  const double radius = shape.size_m.x() / 2;
  const auto in_plane = [&](double z, auto&& inside) -> std::optional<double> {
    const double t = (z - from_m.z()) / d.z();
    if (!(t > 0) || !inside(from_m + t * d)) return {};
    return t;
  };
  const auto within_radius = [&](const Vec3& p) { return p.head<2>().norm() <= radius; };
  const auto first_root = [&](double a, double b, double c, auto&& inside) -> std::optional<double> {
    const double root = b * b - a * c;  // a t² + 2 b t + c = 0
    if (!(root >= 0)) return {};
    for (const double t : {(-b - std::sqrt(root)) / a, (-b + std::sqrt(root)) / a})
      if (t > 0 && inside(from_m + t * d)) return t;
    return {};
  };
  switch (shape.kind) {
    case Kind::point:
      return {};
    case Kind::rectangle:
      return in_plane(0, [&](const Vec3& p) {
        return std::abs(p.x()) <= shape.size_m.x() / 2 && std::abs(p.y()) <= shape.size_m.y() / 2;
      });
    case Kind::disk:
      return in_plane(0, within_radius);
    case Kind::sphere:
      return first_root(1, from_m.dot(d), from_m.squaredNorm() - radius * radius, [](const Vec3&) { return true; });
    case Kind::cylinder: {
      const double half = shape.size_m.z() / 2;
      auto nearest = first_root(d.head<2>().squaredNorm(), from_m.head<2>().dot(d.head<2>()),
                                from_m.head<2>().squaredNorm() - radius * radius,
                                [&](const Vec3& p) { return std::abs(p.z()) <= half; });
      for (const double z : {-half, half})
        if (const auto end = in_plane(z, within_radius); end && (!nearest || *end < *nearest)) nearest = end;
      return nearest;
    }
  }
  return {};
}

/// Distance of a place from the shape's surface.
double off_surface_m(const LuminousShape& shape, const Vec3& p) {
  const double radius = shape.size_m.x() / 2, rho = p.head<2>().norm();
  const auto past = [](double value, double limit) { return std::max(0.0, value - limit); };
  switch (shape.kind) {
    case Kind::rectangle:
      return std::hypot(p.z(), past(std::abs(p.x()), radius), past(std::abs(p.y()), shape.size_m.y() / 2));
    case Kind::disk:
      return std::hypot(p.z(), past(rho, radius));
    case Kind::sphere:
      return std::abs(p.norm() - radius);
    case Kind::cylinder: {
      const double half = shape.size_m.z() / 2;
      return std::min(std::hypot(rho - radius, past(std::abs(p.z()), half)),
                      std::hypot(std::abs(p.z()) - half, past(rho, radius)));
    }
    default:
      return HUGE_VAL;
  }
}

double bounding_radius_m(const LuminousShape& shape) {
  switch (shape.kind) {
    case Kind::rectangle:
      return std::hypot(shape.size_m.x(), shape.size_m.y()) / 2;
    case Kind::cylinder:
      return std::hypot(shape.size_m.x(), shape.size_m.z()) / 2;
    default:
      return shape.size_m.x() / 2;
  }
}

struct Scene {
  const char* name;
  LuminousShape shape;
  Vec3 from_m;
};
const Scene kScenes[] = {
    {"SquareFromItsAxis", rectangle(1, 1), {0, 0, 0.7}},
    {"SquareFromBelow", rectangle(1, 1), {0.1, -0.2, -0.4}},
    {"RectangleFromACorner", rectangle(0.6, 1.2), {0.3, 0.6, 0.5}},
    {"RectangleFromTheSide", rectangle(0.6, 1.2), {2, -1, 0.3}},
    {"RectangleNearlyInItsPlane", rectangle(0.6, 1.2), {1, 0.2, 0.01}},
    {"RectangleFromVeryNear", rectangle(0.6, 1.2), {0.1, 0.2, -0.001}},
    {"StripLight", rectangle(0.02, 5), {0.3, 1, 0.2}},
    {"DiskFromItsAxis", disk(1), {0, 0, 0.6}},
    {"DiskFromTheSide", disk(1), {1.5, 0.5, -0.4}},
    {"DiskNearlyInItsPlane", disk(1), {-0.8, 0, 0.01}},
    {"DiskFromVeryNear", disk(1), {0.1, 0.3, 0.002}},
    {"DiskFromVeryNearItsRim", disk(1), {0.5, 0, 0.01}},
    {"SphereFromAfar", sphere(0.2), {1, 2, 3}},
    {"SphereFromVeryNear", sphere(1), {0.3, -0.4, 0.08}},
    {"TubeFromTheSide", cylinder(0.026, 1.5), {0.5, 0.3, 0.2}},
    {"TubeFromBeyondItsEnd", cylinder(0.3, 1.5), {0.4, 0.3, 1.3}},
    {"TubeFromStraightBelow", cylinder(0.3, 0.5), {0.05, -0.1, -0.6}},
    {"TubeFromVeryNear", cylinder(0.3, 0.5), {0.1501, 0, 0.1}},
    {"DrumFromBesideItsEnd", cylinder(2, 0.1), {1.2, 0.4, -0.2}},
};
class AnyShape : public testing::TestWithParam<Scene> {};
INSTANTIATE_TEST_SUITE_P(Seen, AnyShape, testing::ValuesIn(kScenes), [](const auto& of) { return of.param.name; });

/// Uniform directions over a cap that holds the whole shape.
class Cap {
 public:
  Cap(const LuminousShape& shape, const Vec3& from_m) : axis_(-from_m.normalized()) {
    const double sine = bounding_radius_m(shape) / from_m.norm();
    if (sine < 1) versine_ = 1 - std::sqrt(1 - sine * sine);
  }
  [[nodiscard]] double solid_angle_sr() const { return 2 * kPi * versine_; }
  [[nodiscard]] Vec3 direction(double u, double v) const {
    const double cosine = 1 - u * versine_, sine = std::sqrt(1 - cosine * cosine);
    const Vec3 x = axis_.unitOrthogonal(), y = axis_.cross(x);
    return cosine * axis_ + sine * (std::cos(2 * kPi * v) * x + std::sin(2 * kPi * v) * y);
  }

 private:
  Vec3 axis_;
  double versine_ = 2;
};

TEST_P(AnyShape, DensityIntegratesToOneAndItsInverseToTheSolidAngle) {
  const auto& [name, shape, from_m] = GetParam();
  Random random(1);
  // Over random directions: the shape's solid angle by the share that meets it.
  const Cap cap(shape, from_m);
  constexpr int kDirections = 100'000;
  double total = 0, total2 = 0, hits = 0;
  for (int i = 0; i < kDirections; ++i) {
    const Vec3 d = cap.direction(random.between(0, 1), random.between(0, 1));
    const double density = density_seen_from(shape, from_m, d);
    const auto met_m = met_at_m(shape, from_m, d);
    const bool meets = met_m.has_value();
    EXPECT_EQ(meets, density > 0) << d.transpose();
    if (meets && density > 0) {
      EXPECT_NEAR(distance_towards_m(shape, from_m, d), *met_m, 1e-9 * *met_m) << d.transpose();
    }
    total += density;
    total2 += density * density;
    hits += meets;
  }
  const double n = kDirections, mean = total / n;
  const double integral = mean * cap.solid_angle_sr();
  const double error = cap.solid_angle_sr() * std::sqrt(std::max(0.0, total2 / n - mean * mean) / n);
  EXPECT_NEAR(integral, 1, 4 * error + 1e-9);
  const double seen_sr = hits / n * cap.solid_angle_sr();
  const double seen_error_sr = cap.solid_angle_sr() * std::sqrt(hits / n * (1 - hits / n) / n);

  constexpr int kSide = 150;
  double inverse = 0, lowest = HUGE_VAL, highest = 0;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const auto s =
          sample_seen_from(shape, from_m, (i + random.between(0, 1)) / kSide, (j + random.between(0, 1)) / kSide);
      inverse += 1 / s.density_per_sr / (kSide * kSide);
      lowest = std::min(lowest, s.density_per_sr);
      highest = std::max(highest, s.density_per_sr);
    }
  EXPECT_NEAR(inverse, seen_sr, 4 * seen_error_sr + 1e-4 * seen_sr);
  if (shape.kind == Kind::rectangle || shape.kind == Kind::sphere) {
    EXPECT_EQ(lowest, highest) << "even over the solid angle";
  }
  if (shape.kind == Kind::disk) {
    EXPECT_LT(highest / lowest, 1.35) << "nearly even over the solid angle";
  }
}

TEST_P(AnyShape, SamplesLieOnTheNearSideOfTheShapeWithTheDensityTheyState) {
  const auto& [name, shape, from_m] = GetParam();
  Random random(2);
  const double size_m = bounding_radius_m(shape);
  for (int i = 0; i < 5'000; ++i) {
    // Also the square's edges, where rounding may miss the rim.
    const double u = i < 100 ? i / 99.0 : i < 200 ? (i % 2) : random.between(0, 1);
    const double v = i < 200 ? (i % 100) / 99.0 : random.between(0, 1);
    const auto s = sample_seen_from(shape, from_m, u, v);
    ASSERT_GT(s.density_per_sr, 0) << u << " " << v;
    EXPECT_NEAR(s.direction.norm(), 1, 1e-14);
    EXPECT_LT(off_surface_m(shape, from_m + s.distance_m * s.direction), 1e-12 * (size_m + from_m.norm())) << i;
    // On the edge between a cylinder's wall and its end, either is right.
    if (shape.kind != Kind::cylinder || i >= 200) {
      EXPECT_NEAR(density_seen_from(shape, from_m, s.direction), s.density_per_sr, 1e-9 * s.density_per_sr)
          << u << " " << v;
    }
    if (u > 1e-3 && u < 1 - 1e-3 && v > 1e-3 && v < 1 - 1e-3) {
      const auto met = met_at_m(shape, from_m, s.direction);
      ASSERT_TRUE(met.has_value()) << u << " " << v;
      EXPECT_NEAR(s.distance_m, *met, 1e-9 * *met);
    }
  }
}

TEST_P(AnyShape, DirectionsAreDrawnWithTheStatedDensity) {
  const auto& [name, shape, from_m] = GetParam();
  // Moments of the direction: from samples as drawn, and from uniform directions weighted with the density.
  Random random(3);
  const Cap cap(shape, from_m);
  constexpr int kCount = 100'000;
  const auto moments = [](const Vec3& d) {
    Eigen::Matrix<double, 9, 1> m;
    m << d, d.x() * d.x(), d.y() * d.y(), d.x() * d.y(), d.y() * d.z(), d.z() * d.x(), d.x() * d.y() * d.z();
    return m;
  };
  using Moments = Eigen::Matrix<double, 9, 1>;
  Moments drawn = Moments::Zero(), weighted = Moments::Zero(), drawn2 = Moments::Zero(), weighted2 = Moments::Zero();
  for (int i = 0; i < kCount; ++i) {
    const Moments a = moments(sample_seen_from(shape, from_m, random.between(0, 1), random.between(0, 1)).direction);
    const Vec3 d = cap.direction(random.between(0, 1), random.between(0, 1));
    const double weight = density_seen_from(shape, from_m, d) * cap.solid_angle_sr();
    const Moments b = weight * moments(d) - (weight - 1) * moments(-from_m.normalized());  // less noise, same mean
    drawn += a / kCount;
    drawn2 += a.cwiseAbs2() / kCount;
    weighted += b / kCount;
    weighted2 += b.cwiseAbs2() / kCount;
  }
  for (int k = 0; k < 9; ++k) {
    const double variance = drawn2[k] - drawn[k] * drawn[k] + weighted2[k] - weighted[k] * weighted[k];
    EXPECT_NEAR(drawn[k], weighted[k], 4.5 * std::sqrt(std::max(variance, 0.0) / kCount) + 1e-12) << k;
  }
}

TEST_P(AnyShape, NearbyPointsMapToNearbyDirections) {
  const auto& [name, shape, from_m] = GetParam();
  if (shape.kind == Kind::cylinder) return;  // its wall and its end are two pieces
  Random random(4);
  for (int i = 0; i < 2000; ++i) {
    const double u = random.between(0, 1 - 1e-9), v = random.between(0, 1 - 1e-9);
    const auto here = sample_seen_from(shape, from_m, u, v);
    const auto near = sample_seen_from(shape, from_m, u + 1e-9, v + 1e-9);
    EXPECT_LT((here.direction - near.direction).norm(), 1e-5);
  }
}

TEST(ShapeSampling, InverseDensityMatchesClosedFormSolidAngles) {
  Random random(5);
  for (int i = 0; i < 300; ++i) {
    // A rectangle above its own corner: atan(ab / (h √(a²+b²+h²))); four such make one about the axis.
    const double a = random.log_between(1e-2, 1e2), b = random.log_between(1e-2, 1e2),
                 h = random.log_between(1e-2, 1e2);
    const double corner_sr = std::atan(a * b / (h * std::hypot(a, b, h)));
    const auto from_axis = sample_seen_from(rectangle(2 * a, 2 * b), {0, 0, h}, 0.3, 0.6);
    EXPECT_NEAR(1 / from_axis.density_per_sr, 4 * corner_sr, 1e-9 * corner_sr);
    const auto from_corner = sample_seen_from(rectangle(a, b), {a / 2, b / 2, -h}, 0.3, 0.6);
    EXPECT_NEAR(1 / from_corner.density_per_sr, corner_sr, 1e-7 * corner_sr);
    // Disk on its axis and sphere: 2π (1 - cos θ).
    const double sine = a / std::hypot(a, h), cosine = h / std::hypot(a, h);
    const double cap_sr = 2 * kPi * sine * sine / (1 + cosine);
    EXPECT_NEAR(1 / sample_seen_from(disk(2 * a), {0, 0, h}, 0.3, 0.6).density_per_sr, cap_sr, 1e-12 * cap_sr);
    const Vec3 from_m = std::hypot(a, h) * random.direction();
    EXPECT_NEAR(1 / sample_seen_from(sphere(2 * a), from_m, 0.3, 0.6).density_per_sr, cap_sr, 1e-7 * cap_sr);
  }
}

TEST(ShapeSampling, ProjectedAreasMatchClosedForms) {
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    const Vec3 d = random.direction();
    const double across = d.head<2>().norm();
    EXPECT_DOUBLE_EQ(projected_area_m2(rectangle(0.5, 3), d), 1.5 * std::abs(d.z()));
    EXPECT_DOUBLE_EQ(projected_area_m2(disk(0.5), d), kPi / 16 * std::abs(d.z()));
    EXPECT_DOUBLE_EQ(projected_area_m2(sphere(0.5), d), kPi / 16);
    EXPECT_NEAR(projected_area_m2(cylinder(0.5, 3), d), 1.5 * across + kPi / 16 * std::abs(d.z()), 1e-14);
    EXPECT_EQ(projected_area_m2({}, d), 0);
  }
}

TEST_P(AnyShape, ProjectedAreaIsTheAreaOfItsShadow) {
  const auto& [name, shape, from_m] = GetParam();
  Random random(7);
  const double radius_m = bounding_radius_m(shape);
  for (int i = 0; i < 5; ++i) {
    const Vec3 d = random.direction(), x = d.unitOrthogonal(), y = d.cross(x);
    constexpr int kSide = 150;
    double hits = 0;
    for (int j = 0; j < kSide; ++j)
      for (int k = 0; k < kSide; ++k) {
        const Vec3 at =
            ((j + random.between(0, 1)) / kSide * 2 - 1) * x + ((k + random.between(0, 1)) / kSide * 2 - 1) * y;
        hits += met_at_m(shape, radius_m * (1.01 * at + 5 * d), -d).has_value();
      }
    const double shadow_m2 = hits / (kSide * kSide) * std::pow(2.02 * radius_m, 2);
    // Jittered strata: only those on the outline are uncertain, with at most 1/4 variance each.
    const double outline_m2 = std::sqrt(4.0 * kSide / 4) * std::pow(2.02 * radius_m / kSide, 2);
    EXPECT_NEAR(projected_area_m2(shape, d), shadow_m2, 5 * outline_m2) << d.transpose();
  }
}

TEST_P(AnyShape, LeavingPlacesAreSpreadEvenlyOverTheShadow) {
  const auto& [name, shape, from_m] = GetParam();
  Random random(8);
  const double radius_m = bounding_radius_m(shape);
  for (int i = 0; i < 3; ++i) {
    const Vec3 d = random.direction(), x = d.unitOrthogonal(), y = d.cross(x);
    // Second moments about two transverse axes, of the places and of the shadow.
    constexpr int kSide = 150;
    Eigen::Vector4d places = Eigen::Vector4d::Zero(), shadow = Eigen::Vector4d::Zero();
    double lit = 0;
    for (int j = 0; j < kSide; ++j)
      for (int k = 0; k < kSide; ++k) {
        const double u = (j + random.between(0, 1)) / kSide, v = (k + random.between(0, 1)) / kSide;
        const Vec3 place = sample_leaving_place_m(shape, d, u, v);
        ASSERT_LT(off_surface_m(shape, place), 1e-12 * radius_m);
        // The side that faces d: nothing of the shape is in front of it.
        const auto met = met_at_m(shape, place + 10 * radius_m * d, -d);
        if (met) {
          EXPECT_NEAR(*met, 10 * radius_m, 1e-6 * radius_m);
        }
        const auto add = [&](Eigen::Vector4d& to, const Vec3& p) {
          const double a = p.dot(x) / radius_m, b = p.dot(y) / radius_m;
          to += Eigen::Vector4d(a, b, a * a, a * b);
        };
        add(places, place);
        const Vec3 at = 1.01 * radius_m * ((2 * u - 1) * x + (2 * v - 1) * y);
        if (met_at_m(shape, at + 5 * radius_m * d, -d)) {
          add(shadow, at);
          ++lit;
        }
      }
    if (lit < 500) continue;
    EXPECT_LT((places / (kSide * kSide) - shadow / lit).cwiseAbs().maxCoeff(), 0.003 + 3 * kSide / lit / 10)
        << d.transpose();
  }
}

TEST(ShapeSampling, NothingIsVisibleFromWithinOrInThePlane) {
  const auto sees = [](const LuminousShape& shape, const Vec3& from_m) {
    const auto s = sample_seen_from(shape, from_m, 0.4, 0.7);
    EXPECT_EQ(s.density_per_sr > 0, density_seen_from(shape, from_m, s.direction) > 0);
    return s.density_per_sr > 0;
  };
  EXPECT_FALSE(sees(rectangle(1, 1), {0, 0, 0}));
  EXPECT_FALSE(sees(rectangle(1, 1), {0.2, 0.1, 0}));
  EXPECT_FALSE(sees(rectangle(1, 1), {2, 0.1, 0}));
  EXPECT_FALSE(sees(disk(1), {0.5, 0, 0}));
  EXPECT_FALSE(sees(disk(1), {3, 0, 0}));
  EXPECT_FALSE(sees(sphere(1), {0.1, 0.1, 0.1}));
  EXPECT_FALSE(sees(sphere(1), {0.5, 0, 0}));
  EXPECT_FALSE(sees(cylinder(1, 1), {0.1, 0.1, 0.1}));
  EXPECT_FALSE(sees(cylinder(1, 1), {0.1, 0, 0.5}));
  EXPECT_FALSE(sees(cylinder(1, 1), {0.5, 0, 0.2}));
  EXPECT_TRUE(sees(cylinder(1, 1), {0.1, 0, 0.5001}));
  EXPECT_TRUE(sees(cylinder(1, 1), {0.7, 0, 0.5})) << "level with the end, its wall is seen";
  EXPECT_FALSE(sees({}, {0, 0, 1}));
}

TEST(ShapeSampling, ShapesWithoutSizeAreInvisible) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Vec3 from_m(0.3, 0.4, 0.5);
  for (const double bad : {0.0, -1.0, nan}) {
    for (const auto& shape : {rectangle(bad, 1), rectangle(1, bad), disk(bad), sphere(bad), cylinder(bad, 1)}) {
      const auto s = sample_seen_from(shape, from_m, 0.4, 0.7);
      EXPECT_EQ(s.density_per_sr, 0) << static_cast<int>(shape.kind) << " " << bad;
      EXPECT_EQ(density_seen_from(shape, from_m, -from_m.normalized()), 0);
    }
  }
  // A cylinder without length is just its two ends.
  EXPECT_NEAR(sample_seen_from(cylinder(1, 0), from_m, 0.4, 0.7).density_per_sr,
              sample_seen_from(disk(1), from_m, 0.4, 0.7).density_per_sr, 1e-9);
}

TEST(ShapeSampling, AnySizeAndDistanceGivesFinitePlacesOnTheShape) {
  Random random(9);
  int seen = 0, asked = 0;
  for (int i = 0; i < 50'000; ++i) {
    const double size_m = std::pow(10, random.between(-9, 6));
    const double thin_m = size_m * std::pow(10, random.between(-6, 0));
    const Vec3 sizes(size_m, thin_m, random.between(0, 1) < 0.5 ? thin_m : size_m);
    LuminousShape shape{static_cast<Kind>(1 + i % 4), sizes};
    Vec3 from_m = size_m * std::pow(10, random.between(-4, 4)) * random.direction();
    if (random.between(0, 1) < 0.3) from_m.z() *= std::pow(10, random.between(-12, 0));  // near the plane
    if (random.between(0, 1) < 0.1) from_m.x() = from_m.y() = 0;                         // on the axis
    if (random.between(0, 1) < 0.1) from_m.x() = from_m.y() = shape.size_m.x() / 2;      // level with an edge
    const double u = i % 7 == 0 ? (i / 7) % 2 : random.between(0, 1);
    const double v = i % 5 == 0 ? (i / 5) % 2 : random.between(0, 1);
    const auto s = sample_seen_from(shape, from_m, u, v);
    ASSERT_TRUE(std::isfinite(s.density_per_sr) && s.density_per_sr >= 0);
    ASSERT_TRUE(s.direction.allFinite());
    ++asked;
    if (s.density_per_sr == 0) continue;
    ++seen;
    ASSERT_NEAR(s.direction.norm(), 1, 1e-12) << i;
    ASSERT_TRUE(s.distance_m > 0 && std::isfinite(s.distance_m));
    const double off_m = off_surface_m(shape, from_m + s.distance_m * s.direction);
    // From just above the plane the rim is nearly edge-on, so rounding of the direction moves the place.
    const double edge_on = size_m / std::abs(from_m.z());
    ASSERT_LT(off_m, (1e-11 + 4e-15 * edge_on) * (size_m + from_m.norm())) << i << " " << edge_on;
    const double density = density_seen_from(shape, from_m, s.direction);
    const bool at_rim = u < 1e-3 || u > 1 - 1e-3 || v < 1e-3 || v > 1 - 1e-3;
    // If the direction's rounding is as large as the shape is wide, the ray may miss it.
    const double thin_seen = thin_m / s.distance_m * std::abs(from_m.z()) / from_m.norm();
    if (!at_rim && shape.kind != Kind::cylinder && thin_seen > 1e-8) {
      ASSERT_NEAR(density, s.density_per_sr, 1e-4 * s.density_per_sr) << i << " kind " << i % 4;
    }
    ASSERT_TRUE(std::isfinite(density) && density >= 0);
  }
  EXPECT_GT(seen, asked / 2);
}

TEST(ShapeSampling, TheFarSolidAngleIsProjectedAreaOverSquaredDistance) {
  Random random(10);
  for (int i = 0; i < 400; ++i) {
    const LuminousShape shape{static_cast<Kind>(1 + i % 4), {0.7, 0.3, 1.1}};
    const Vec3 d = random.direction();
    if (std::abs(d.z()) < 0.05) continue;
    const double far_m = 1e4 * 1.1;
    double inverse = 0;
    constexpr int kSide = 16;
    for (int j = 0; j < kSide * kSide; ++j)
      inverse +=
          1 / sample_seen_from(shape, far_m * d, (j / kSide + 0.5) / kSide, (j % kSide + 0.5) / kSide).density_per_sr /
          (kSide * kSide);
    const double expected = projected_area_m2(shape, d) / (far_m * far_m);
    EXPECT_NEAR(inverse, expected, 2e-3 * expected) << static_cast<int>(shape.kind) << " " << d.transpose();
  }
}

}  // namespace
}  // namespace luxrig
