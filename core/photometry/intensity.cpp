#include "core/photometry/intensity.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"

namespace luxrig {
namespace {

class Isotropic final : public IntensityDistribution {
 public:
  explicit Isotropic(double flux_lm) : flux_lm_(flux_lm) {}
  double intensity_cd(const Vec3&) const override { return flux_lm_ / (4 * kPi); }
  double flux_lm() const override { return flux_lm_; }
  double max_intensity_cd() const override { return flux_lm_ / (4 * kPi); }
  double emission_cone_rad() const override { return 2 * kPi; }
  double density_per_sr(const Vec3&) const override { return 1 / (4 * kPi); }

 private:
  double flux_lm_;
};

/// I0 cosⁿγ below the horizontal: n = 1 is Lambertian.
class CosinePower final : public IntensityDistribution {
 public:
  CosinePower(double flux_lm, double exponent)
      : flux_lm_(flux_lm), exponent_(exponent), peak_cd_(flux_lm * (exponent + 1) / (2 * kPi)) {}
  double intensity_cd(const Vec3& direction_lamp) const override { return peak_cd_ * profile(-direction_lamp.z()); }
  double flux_lm() const override { return flux_lm_; }
  double max_intensity_cd() const override { return peak_cd_; }
  double emission_cone_rad() const override { return kPi; }
  DirectionSample sample(double u, double v) const override {
    // cosγ = (1-v)^(1/(n+1)). 1 - cosγ is computed by expm1, so that a narrow beam keeps its digits. v = 1 is the
    // horizon.
    const double versine = -std::expm1(std::log1p(-std::min(v, 1 - 1e-12)) / (exponent_ + 1));
    const double sine = std::sqrt(versine * (2 - versine));
    const double angle = 2 * kPi * u;
    const double cosine = 1 - versine;
    return {{sine * std::cos(angle), sine * std::sin(angle), -cosine}, (exponent_ + 1) / (2 * kPi) * profile(cosine)};
  }
  double density_per_sr(const Vec3& direction_lamp) const override {
    return (exponent_ + 1) / (2 * kPi) * profile(-direction_lamp.z());
  }

 private:
  double profile(double cosine) const {
    if (!(cosine > 0)) return 0;
    return exponent_ == 1 ? cosine : std::pow(cosine, exponent_);
  }

  double flux_lm_;
  double exponent_;
  double peak_cd_;
};

class Scaled final : public IntensityDistribution {
 public:
  Scaled(Intensity of, double flux_lm) : of_(std::move(of)), flux_lm_(flux_lm), factor_(flux_lm / of_->flux_lm()) {}
  double intensity_cd(const Vec3& direction_lamp) const override { return factor_ * of_->intensity_cd(direction_lamp); }
  double flux_lm() const override { return flux_lm_; }
  double max_intensity_cd() const override { return factor_ * of_->max_intensity_cd(); }
  double emission_cone_rad() const override { return of_->emission_cone_rad(); }
  DirectionSample sample(double u, double v) const override { return of_->sample(u, v); }
  double density_per_sr(const Vec3& direction_lamp) const override { return of_->density_per_sr(direction_lamp); }

 private:
  Intensity of_;
  double flux_lm_;
  double factor_;
};

bool positive(double value) { return value > 0 && std::isfinite(value); }

}  // namespace

Intensity make_isotropic(double flux_lm) {
  LUXRIG_CHECK(positive(flux_lm), "flux {} lm", flux_lm);
  return std::make_shared<Isotropic>(flux_lm);
}

Intensity make_lambertian(double flux_lm) { return make_cosine_power(flux_lm, 1); }

Intensity make_cosine_power(double flux_lm, double exponent) {
  LUXRIG_CHECK(positive(flux_lm), "flux {} lm", flux_lm);
  LUXRIG_CHECK(exponent >= 0 && exponent <= 1e6, "exponent {}", exponent);
  return std::make_shared<CosinePower>(flux_lm, exponent);
}

Intensity scaled_to_flux(Intensity of, double flux_lm) {
  LUXRIG_CHECK(of != nullptr, "no distribution");
  LUXRIG_CHECK(positive(flux_lm) && positive(of->flux_lm()), "from {} lm to {} lm", of->flux_lm(), flux_lm);
  return std::make_shared<Scaled>(std::move(of), flux_lm);
}

DirectionSample IntensityDistribution::sample(double u, double v) const {
  const double cos_half_cone = std::cos(0.5 * emission_cone_rad());
  const double z = 1 - v * (1 - cos_half_cone);
  const double radius = std::sqrt(std::max(0.0, 1 - z * z));
  const double angle = 2 * kPi * u;
  return {{radius * std::cos(angle), radius * std::sin(angle), -z}, 1 / (2 * kPi * (1 - cos_half_cone))};
}

double IntensityDistribution::density_per_sr(const Vec3& direction_lamp) const {
  const double cos_half_cone = std::cos(0.5 * emission_cone_rad());
  return -direction_lamp.z() >= cos_half_cone ? 1 / (2 * kPi * (1 - cos_half_cone)) : 0;
}

}  // namespace luxrig
