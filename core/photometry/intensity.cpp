#include "core/photometry/intensity.h"

#include <algorithm>
#include <array>
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

 private:
  double flux_lm_;
};

/// Gauss–Legendre, 8 points on [from, to].
template <class F>
double gauss8(const F& f, double from, double to) {
  constexpr std::array<double, 4> kNode = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                           0.9602898564975363};
  constexpr std::array<double, 4> kWeight = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                             0.1012285362903763};
  const double middle = 0.5 * (from + to);
  const double half = 0.5 * (to - from);
  double sum = 0;
  for (std::size_t i = 0; i < kNode.size(); ++i) {
    sum += kWeight[i] * (f(middle - half * kNode[i]) + f(middle + half * kNode[i]));
  }
  return sum * half;
}

/// Halves the interval until both halves agree with the whole to `allowed`.
template <class F>
double integral(const F& f, double from, double to, double allowed, int depth) {
  const double middle = 0.5 * (from + to);
  const double whole = gauss8(f, from, to);
  const double left = gauss8(f, from, middle);
  const double right = gauss8(f, middle, to);
  if (depth == 0 || std::abs(left + right - whole) <= allowed) return left + right;
  return integral(f, from, middle, 0.5 * allowed, depth - 1) + integral(f, middle, to, 0.5 * allowed, depth - 1);
}

class Spot final : public IntensityDistribution {
 public:
  Spot(double flux_lm, double beam_angle_rad, double field_angle_rad)
      : flux_lm_(flux_lm),
        beam_rad_(0.5 * beam_angle_rad),
        field_rad_(0.5 * field_angle_rad),
        cos_cut_off_(std::cos(2 * field_rad_)),
        power_(std::log(std::log2(10.0)) / (std::log(field_angle_rad) - std::log(beam_angle_rad))) {
    const auto ring = [this](double gamma_rad) { return 2 * kPi * profile(gamma_rad) * std::sin(gamma_rad); };
    // The profile is at least 1/2 within the beam, which bounds the integral from below.
    const double allowed = 1e-14 * kPi * (1 - std::cos(beam_rad_));
    // Pieces over each of which (γ/b)^p doubles: without them the rule would step over the edge of a spot whose
    // field is hardly wider than its beam, and find itself agreed.
    double per_cd = 0;
    double from_rad = 0;
    const auto add = [&](double to_rad) {
      if (to_rad <= from_rad) return;
      per_cd += integral(ring, from_rad, to_rad, allowed, 40);
      from_rad = to_rad;
    };
    for (int doubling = -30; doubling <= 7; ++doubling) {
      const double edge_rad = beam_rad_ * std::exp2(doubling / power_);
      if (edge_rad > field_rad_ && from_rad < field_rad_) add(field_rad_);
      add(std::min(edge_rad, 2 * field_rad_));
    }
    add(2 * field_rad_);
    peak_cd_ = flux_lm / per_cd;
  }

  double intensity_cd(const Vec3& direction_lamp) const override {
    if (-direction_lamp.z() <= cos_cut_off_) return 0;
    // atan2, not acos: exact near the axis, where a narrow beam has all its light.
    return peak_cd_ * profile(std::atan2(std::hypot(direction_lamp.x(), direction_lamp.y()), -direction_lamp.z()));
  }
  double flux_lm() const override { return flux_lm_; }
  double max_intensity_cd() const override { return peak_cd_; }
  double emission_cone_rad() const override { return 2 * field_rad_ > 0.5 * kPi ? 2 * kPi : 4 * field_rad_; }

 private:
  double profile(double gamma_rad) const {
    const double fall = std::exp2(-std::pow(gamma_rad / beam_rad_, power_));
    if (gamma_rad <= field_rad_) return fall;
    const double t = gamma_rad / field_rad_ - 1;
    if (t >= 1) return 0;
    return std::max(0.0, fall * (1 - t * t * t * (10 + t * (6 * t - 15))));
  }

  double flux_lm_;
  double beam_rad_;  // half angles
  double field_rad_;
  double cos_cut_off_;
  double power_;
  double peak_cd_ = 0;
};

class Scaled final : public IntensityDistribution {
 public:
  Scaled(Intensity of, double flux_lm) : of_(std::move(of)), flux_lm_(flux_lm), factor_(flux_lm / of_->flux_lm()) {}
  double intensity_cd(const Vec3& direction_lamp) const override { return factor_ * of_->intensity_cd(direction_lamp); }
  double flux_lm() const override { return flux_lm_; }
  double max_intensity_cd() const override { return factor_ * of_->max_intensity_cd(); }
  double emission_cone_rad() const override { return of_->emission_cone_rad(); }

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

Intensity make_spot(double flux_lm, double beam_angle_rad, double field_angle_rad) {
  LUXRIG_CHECK(positive(flux_lm), "flux {} lm", flux_lm);
  LUXRIG_CHECK(0 < beam_angle_rad && beam_angle_rad < field_angle_rad && field_angle_rad < kPi,
               "beam {} rad, field {} rad", beam_angle_rad, field_angle_rad);
  return std::make_shared<Spot>(flux_lm, beam_angle_rad, field_angle_rad);
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
