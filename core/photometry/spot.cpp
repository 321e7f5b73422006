#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/check.h"
#include "core/photometry/intensity.h"
#include "core/photometry/shapes/arc_tangent.h"
#include "core/photometry/shapes/gauss8.h"
#include "core/photometry/sphere_table.h"

namespace luxrig {
namespace {

/// Integral of f ≥ 0. Halves the interval until both halves agree with the whole to `allowed`, or to rounding.
template <class F>
double integral(const F& f, double from, double to, double allowed, int depth) {
  const double middle = 0.5 * (from + to);
  const double whole = gauss8(f, from, to);
  const double left = gauss8(f, from, middle);
  const double right = gauss8(f, middle, to);
  constexpr double kRounds = 8 * std::numeric_limits<double>::epsilon();
  if (depth == 0 || std::abs(left + right - whole) <= std::max(allowed, kRounds * whole)) return left + right;
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
    // Intervals over each of which (γ/b)^p doubles. Without them, the rule would step over the edge of a spot whose
    // field is hardly wider than its beam, and seem to have converged.
    std::vector<double> edges{0};
    const auto add = [&](double to_rad) {
      if (to_rad > edges.back()) edges.push_back(to_rad);
    };
    for (int doubling = -30; doubling <= 7; ++doubling) {
      const double edge_rad = beam_rad_ * std::exp2(doubling / power_);
      if (edge_rad > field_rad_ && edges.back() < field_rad_) add(field_rad_);
      add(std::min(edge_rad, 2 * field_rad_));
    }
    add(2 * field_rad_);
    // Relative to all of it, not to the beam: in a wide field, that holds most of the light, and no sum is better than
    // its rounding.
    double about = 0, per_cd = 0;
    for (std::size_t i = 1; i < edges.size(); ++i) about += gauss8(ring, edges[i - 1], edges[i]);
    for (std::size_t i = 1; i < edges.size(); ++i) per_cd += integral(ring, edges[i - 1], edges[i], 1e-14 * about, 40);
    peak_cd_ = flux_lm / per_cd;
    drawn_.emplace(tabulated());
  }

  double intensity_cd(const Vec3& direction_lamp) const override {
    if (-direction_lamp.z() <= cos_cut_off_) return 0;
    return peak_cd_ * profile(gamma_rad(direction_lamp));
  }
  double flux_lm() const override { return flux_lm_; }
  double max_intensity_cd() const override { return peak_cd_; }
  double emission_cone_rad() const override { return 2 * field_rad_ > 0.5 * kPi ? 2 * kPi : 4 * field_rad_; }

  DirectionSample sample(double u, double v) const override {
    const SphereTable::Sample drawn = drawn_->sample(u, v);
    const Vec3& d = drawn.direction;
    return {{d.x(), d.y(), -d.z()}, drawn.value / drawn_->integral()};
  }
  double density_per_sr(const Vec3& d) const override {
    return drawn_->at({d.x(), d.y(), -d.z()}) / drawn_->integral();
  }

 private:
  static double gamma_rad(const Vec3& d) { return angle_rad(std::sqrt(d.x() * d.x() + d.y() * d.y()), -d.z()); }

  /// The profile at a few hundred angles, linear between them, for sampling directions. Positive wherever the profile
  /// is: it falls monotonically, so every interval begins where it has not ended.
  SphereTable tabulated() const {
    constexpr int kSteps = 96;
    const double end_rad = 2 * field_rad_;
    std::vector<double> angles{0, end_rad};
    const auto add = [&](double angle_rad) {
      if (angle_rad > 0 && angle_rad < end_rad) angles.push_back(angle_rad);
    };
    for (int i = 1; i < kSteps; ++i) {
      const double share = static_cast<double>(i) / kSteps;
      add(end_rad * share);
      add(field_rad_ * share * share);                           // finer near the axis
      add(beam_rad_ * std::pow(-std::log2(share), 1 / power_));  // equal steps down the edge
      if (i <= 40) add(beam_rad_ * std::pow(i, 1 / power_));     // 2^-i: its foot
    }
    std::sort(angles.begin(), angles.end());
    const double min_gap_rad = 1e-9 * end_rad;
    std::vector<double> kept{0}, values{1};
    for (const double angle_rad : angles) {
      if (angle_rad - kept.back() < min_gap_rad || end_rad - angle_rad < min_gap_rad) continue;
      kept.push_back(angle_rad);
      values.push_back(profile(angle_rad));
    }
    kept.push_back(end_rad);
    values.push_back(0);
    return SphereTable(SphereTable::Symmetry::round, std::move(kept), {}, std::move(values));
  }

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
  std::optional<SphereTable> drawn_;
};

}  // namespace

Intensity make_spot(double flux_lm, double beam_angle_rad, double field_angle_rad) {
  LUXRIG_CHECK(flux_lm > 0 && std::isfinite(flux_lm), "flux {} lm", flux_lm);
  LUXRIG_CHECK(0 < beam_angle_rad && beam_angle_rad < field_angle_rad && field_angle_rad < kPi,
               "beam {} rad, field {} rad", beam_angle_rad, field_angle_rad);
  return std::make_shared<Spot>(flux_lm, beam_angle_rad, field_angle_rad);
}

}  // namespace luxrig
