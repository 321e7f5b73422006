#include "core/photometry/sky/sky.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/check.h"
#include "core/photometry/shapes/arc_tangent.h"
#include "core/photometry/shapes/gauss8.h"
#include "core/photometry/sphere_table.h"

namespace luxrig {
namespace {

double sine_of(double cosine) { return std::sqrt(std::max(0.0, 1 - cosine * cosine)); }

/// Relative luminance by direction: gradation times indicatrix.
struct GeneralProfile {
  GeneralSkyParameters p;
  Vec3 towards_sun;
  [[nodiscard]] double operator()(const Vec3& d) const {
    const double gradation = d.z() > 0 ? 1 + p.a * std::exp(p.b / d.z()) : 1;  // its limit at the horizon
    if (p.c == 0 && p.e == 0) return gradation;
    const double cosine = std::clamp(d.dot(towards_sun), -1.0, 1.0);
    const double angle = angle_rad(d.cross(towards_sun).norm(), cosine);
    return gradation * (1 + p.c * (std::exp(p.d * angle) - std::exp(p.d * 0.5 * kPi)) + p.e * cosine * cosine);
  }
};

/// (1 + 2 sin h) / 3 of the zenith's luminance.
struct OvercastProfile {
  Vec3 towards_sun = Vec3::UnitZ();  // unused: any will do
  [[nodiscard]] double operator()(const Vec3& d) const { return (1 + 2 * d.z()) / 3; }
};

/// ∫ f dx over [from, to], 8-point Gauss in each of `panels`, which get finer towards `to` (quadratically). The sun's
/// halo has a cusp there, which a smooth substitution removes.
template <class F>
double towards_end(const F& f, double from, double to, int panels) {
  double sum = 0;
  for (int i = 0; i < panels; ++i)  // t is 0 at `to`
    sum += gauss8([&](double t) { return 2 * t * f(to + (from - to) * t * t); }, static_cast<double>(i) / panels,
                  (i + 1.0) / panels);
  return sum * (to - from);
}

/// A sky by formula: luminance from the formula, directions from a table of it.
template <class Profile>
class FormulaSky final : public SkyLuminance {
 public:
  FormulaSky(Profile profile, double horizontal_lx)
      : profile_(std::move(profile)),
        horizontal_lx_(horizontal_lx),
        sun_zenith_rad_(
            angle_rad(std::hypot(profile_.towards_sun.x(), profile_.towards_sun.y()), profile_.towards_sun.z())),
        towards_sun_level_(level_direction(profile_.towards_sun)),
        table_(tabulated()) {
    scale_cd_m2_ = horizontal_lx / relative_illuminance();
  }

  double luminance_cd_m2(const Vec3& direction_world) const override {
    return direction_world.z() < 0 ? 0 : scale_cd_m2_ * profile_(direction_world);
  }
  double horizontal_illuminance_lx() const override { return horizontal_lx_; }

  DirectionSample sample(double u, double v) const override {
    const SphereTable::Sample drawn = table_.sample(u, v);
    return {world_from_table(drawn.direction), drawn.value / table_.integral()};
  }
  double density_per_sr(const Vec3& d) const override {
    const Vec3 in_table(d.x() * towards_sun_level_.x() + d.y() * towards_sun_level_.y(),
                        d.y() * towards_sun_level_.x() - d.x() * towards_sun_level_.y(), d.z());
    return table_.at(in_table) / table_.integral();
  }

 private:
  static Vec3 level_direction(const Vec3& d) {
    const double level = std::hypot(d.x(), d.y());
    return level > 1e-12 ? Vec3(d.x() / level, d.y() / level, 0) : Vec3::UnitX();
  }

  /// The table's azimuth counts from that of the sun.
  Vec3 world_from_table(const Vec3& d) const {
    return {d.x() * towards_sun_level_.x() - d.y() * towards_sun_level_.y(),
            d.x() * towards_sun_level_.y() + d.y() * towards_sun_level_.x(), d.z()};
  }

  [[nodiscard]] double at(double zenith_rad, double azimuth_rad) const {
    const double sine = std::sin(zenith_rad);
    const Vec3 d(sine * std::cos(azimuth_rad), sine * std::sin(azimuth_rad), std::max(0.0, std::cos(zenith_rad)));
    return profile_(world_from_table(d));
  }

  SphereTable tabulated() const {
    constexpr int kZeniths = 36, kAzimuths = 48;
    std::vector<double> zenith, azimuth, values;
    for (int i = 0; i <= kZeniths; ++i) zenith.push_back(0.5 * kPi * i / kZeniths);
    // Adds a row through the sun, so that the cusp of its halo is in the table.
    const double gap = 0.1 * zenith[1];
    const auto row = std::lower_bound(zenith.begin(), zenith.end(), sun_zenith_rad_);
    if (row != zenith.end() && row != zenith.begin() && *row - sun_zenith_rad_ > gap &&
        sun_zenith_rad_ - *(row - 1) > gap) {
      zenith.insert(row, sun_zenith_rad_);
    }
    for (int i = 0; i <= kAzimuths; ++i) azimuth.push_back(kPi * i / kAzimuths);
    for (const double a : azimuth) {
      for (const double z : zenith) values.push_back(at(z, a));
    }
    return SphereTable(SphereTable::Symmetry::half_0_180, std::move(zenith), std::move(azimuth), std::move(values));
  }

  /// ∫ L cos Z over the sky.
  [[nodiscard]] double relative_illuminance() const {
    constexpr int kPanels = 6;
    const auto ring = [&](double zenith) {
      const double around = towards_end([&](double azimuth) { return at(zenith, azimuth); }, kPi, 0, kPanels);
      return -2 * around * std::sin(zenith) * std::cos(zenith);
    };
    const double tip = std::clamp(sun_zenith_rad_, 0.0, 0.5 * kPi);
    return towards_end(ring, 0, tip, kPanels) - towards_end(ring, 0.5 * kPi, tip, kPanels);
  }

  Profile profile_;
  double horizontal_lx_;
  double sun_zenith_rad_;
  Vec3 towards_sun_level_;
  SphereTable table_;
  double scale_cd_m2_ = 0;
};

class UniformSky final : public SkyLuminance {
 public:
  explicit UniformSky(double horizontal_lx) : horizontal_lx_(horizontal_lx) {}
  double luminance_cd_m2(const Vec3& d) const override { return d.z() < 0 ? 0 : horizontal_lx_ / kPi; }
  double horizontal_illuminance_lx() const override { return horizontal_lx_; }
  DirectionSample sample(double u, double v) const override {
    const double cosine = 1 - v;
    const double sine = sine_of(cosine);
    return {{sine * std::cos(2 * kPi * u), sine * std::sin(2 * kPi * u), cosine}, 1 / (2 * kPi)};
  }
  double density_per_sr(const Vec3& d) const override { return d.z() < 0 ? 0 : 1 / (2 * kPi); }

 private:
  double horizontal_lx_;
};

class Sun final : public SkyLuminance {
 public:
  Sun(const Vec3& towards_sun, double normal_lx) : towards_sun_(towards_sun) {
    const double sine = std::sin(0.5 * kSunDiameter_rad);
    luminance_cd_m2_ = normal_lx / (kPi * sine * sine);
    horizontal_lx_ = towards_sun.z() >= sine ? normal_lx * towards_sun.z() : rising_illuminance_lx();
    const Vec3 away = std::abs(towards_sun.z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitX();
    side_ = away.cross(towards_sun).normalized();
    over_ = towards_sun.cross(side_);
  }

  double luminance_cd_m2(const Vec3& d) const override { return d.z() >= 0 && within(d) ? luminance_cd_m2_ : 0; }
  double horizontal_illuminance_lx() const override { return horizontal_lx_; }
  DirectionSample sample(double u, double v) const override {
    const double versine = v * kVersine;
    const double sine = std::sqrt(versine * (2 - versine));
    const double angle = 2 * kPi * u;
    return {(1 - versine) * towards_sun_ + sine * (std::cos(angle) * side_ + std::sin(angle) * over_), kDensity};
  }
  double density_per_sr(const Vec3& d) const override { return within(d) ? kDensity : 0; }

 private:
  static double versine_of(double angle) {
    const double half = std::sin(0.5 * angle);
    return 2 * half * half;
  }
  static inline const double kVersine = versine_of(0.5 * kSunDiameter_rad);
  static inline const double kDensity = 1 / (2 * kPi * kVersine);

  /// By the chord, which keeps the digits that a cosine near 1 loses. Slightly wider than the range of samples.
  bool within(const Vec3& d) const { return (d - towards_sun_).squaredNorm() <= 2 * kVersine * (1 + 1e-9); }

  /// For a disk that the horizon cuts.
  [[nodiscard]] double rising_illuminance_lx() const {
    const double radius = 0.5 * kSunDiameter_rad;
    const double height = std::asin(towards_sun_.z());
    // Rows of the small disk above the horizon, taken as flat: sin h = h.
    constexpr int kRows = 2000;
    double sum = 0;
    for (int i = 0; i < kRows; ++i) {
      const double y = -radius + 2 * radius * (i + 0.5) / kRows;
      const double above = height + y;
      if (above > 0) sum += 2 * std::sqrt(radius * radius - y * y) * std::sin(above);
    }
    return luminance_cd_m2_ * sum * 2 * radius / kRows;
  }

  Vec3 towards_sun_;
  Vec3 side_, over_;
  double luminance_cd_m2_ = 0;
  double horizontal_lx_ = 0;
};

bool gives_light(double value) { return value > 0 && std::isfinite(value); }

void check_direction(const Vec3& towards_sun) {
  LUXRIG_CHECK(std::abs(towards_sun.norm() - 1) < 1e-6 && towards_sun.z() > 0, "sun at ({}, {}, {})", towards_sun.x(),
               towards_sun.y(), towards_sun.z());
}

}  // namespace

GeneralSkyParameters general_sky_parameters(int type) {
  constexpr GeneralSkyParameters kTable[kGeneralSkyTypes] = {
      {4.0, -0.70, 0, -1.0, 0.00},     // 1 overcast, steep gradation, even about the zenith
      {4.0, -0.70, 2, -1.5, 0.15},     // 2 overcast, steep gradation, slightly brighter towards the sun
      {1.1, -0.80, 0, -1.0, 0.00},     // 3 overcast, moderate gradation, even about the zenith
      {1.1, -0.80, 2, -1.5, 0.15},     // 4 overcast, moderate gradation, slightly brighter towards the sun
      {0.0, -1.00, 0, -1.0, 0.00},     // 5 uniform
      {0.0, -1.00, 2, -1.5, 0.15},     // 6 partly cloudy, no gradation, slightly brighter towards the sun
      {0.0, -1.00, 5, -2.5, 0.30},     // 7 partly cloudy, no gradation, brighter circumsolar region
      {0.0, -1.00, 10, -3.0, 0.45},    // 8 partly cloudy, no gradation, distinct solar corona
      {-1.0, -0.55, 2, -1.5, 0.15},    // 9 partly cloudy, obscured sun
      {-1.0, -0.55, 5, -2.5, 0.30},    // 10 partly cloudy, brighter circumsolar region
      {-1.0, -0.55, 10, -3.0, 0.45},   // 11 white-blue, distinct solar corona
      {-1.0, -0.32, 10, -3.0, 0.45},   // 12 CIE clear, low turbidity
      {-1.0, -0.32, 16, -3.0, 0.30},   // 13 CIE clear, polluted atmosphere
      {-1.0, -0.15, 16, -3.0, 0.30},   // 14 cloudless, turbid, broad solar corona
      {-1.0, -0.15, 24, -2.8, 0.15}};  // 15 white-blue, turbid, broad solar corona
  LUXRIG_CHECK(type >= 1 && type <= kGeneralSkyTypes, "sky type {}", type);
  return kTable[type - 1];
}

Sky make_uniform_sky(double horizontal_lx) {
  LUXRIG_CHECK(gives_light(horizontal_lx), "{} lx", horizontal_lx);
  return std::make_shared<UniformSky>(horizontal_lx);
}

Sky make_overcast_sky(double horizontal_lx) {
  LUXRIG_CHECK(gives_light(horizontal_lx), "{} lx", horizontal_lx);
  return std::make_shared<FormulaSky<OvercastProfile>>(OvercastProfile{}, horizontal_lx);
}

Sky make_general_sky(int type, const Vec3& towards_sun_world, double horizontal_lx) {
  LUXRIG_CHECK(gives_light(horizontal_lx), "{} lx", horizontal_lx);
  check_direction(towards_sun_world);
  const GeneralProfile profile{general_sky_parameters(type), towards_sun_world.normalized()};
  return std::make_shared<FormulaSky<GeneralProfile>>(profile, horizontal_lx);
}

Sky make_clear_sky(const Vec3& towards_sun_world, double horizontal_lx) {
  return make_general_sky(12, towards_sun_world, horizontal_lx);
}

Sky make_sun(const Vec3& towards_sun_world, double normal_lx) {
  LUXRIG_CHECK(gives_light(normal_lx), "{} lx", normal_lx);
  check_direction(towards_sun_world);
  return std::make_shared<Sun>(towards_sun_world.normalized(), normal_lx);
}

}  // namespace luxrig
