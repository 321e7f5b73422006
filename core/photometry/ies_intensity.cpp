#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"
#include "core/photometry/ies.h"

namespace luxrig {
namespace {

/// Ascending knots [rad], with a shortcut for the usual even spacing.
class Axis {
 public:
  explicit Axis(std::vector<double> knots_rad) : knots_rad_(std::move(knots_rad)) {
    const double step = (knots_rad_.back() - knots_rad_.front()) / static_cast<double>(knots_rad_.size() - 1);
    bool even = true;
    for (std::size_t i = 0; i < knots_rad_.size(); ++i) {
      const double expected = knots_rad_.front() + step * static_cast<double>(i);
      even = even && std::abs(knots_rad_[i] - expected) <= 1e-9 * step;
    }
    if (even) inverse_step_ = 1 / step;
  }

  struct Cell {
    std::size_t index;  // of its lower knot
    double fraction;    // 0…1 towards the upper
  };

  [[nodiscard]] Cell cell(double angle_rad) const {
    const std::size_t last = knots_rad_.size() - 2;
    if (inverse_step_ > 0) {
      const double position = std::max(0.0, (angle_rad - knots_rad_.front()) * inverse_step_);
      const std::size_t index = std::min(last, static_cast<std::size_t>(position));
      return {index, std::min(1.0, position - static_cast<double>(index))};
    }
    const auto above = std::upper_bound(knots_rad_.begin() + 1, knots_rad_.end() - 1, angle_rad);
    const auto index = static_cast<std::size_t>(above - knots_rad_.begin()) - 1;
    const double fraction = (angle_rad - knots_rad_[index]) / (knots_rad_[index + 1] - knots_rad_[index]);
    return {index, std::clamp(fraction, 0.0, 1.0)};
  }

  [[nodiscard]] const std::vector<double>& knots_rad() const { return knots_rad_; }

 private:
  std::vector<double> knots_rad_;
  double inverse_step_ = 0;  // 0: uneven
};

enum class Symmetry { axial, quadrant, half_0_180, half_90_270, none };

Symmetry symmetry_of(const std::vector<double>& horizontal_deg) {
  if (horizontal_deg.size() == 1) return Symmetry::axial;
  if (horizontal_deg.front() == 90) return Symmetry::half_90_270;
  if (horizontal_deg.back() == 90) return Symmetry::quadrant;
  if (horizontal_deg.back() == 180) return Symmetry::half_0_180;
  return Symmetry::none;
}

/// Integrals over one vertical cell of sin γ times the two linear hat functions, which weigh the values at
/// its ends:  ∫ (b-γ)/(b-a) sin γ dγ  and  ∫ (γ-a)/(b-a) sin γ dγ,  with middle m and half width h
///   = sin m sin h ± cos m (cos h - sin h / h).
std::pair<double, double> hat_weights(double a_rad, double b_rad) {
  const double middle = 0.5 * (a_rad + b_rad);
  const double h = 0.5 * (b_rad - a_rad);
  // The difference cancels for narrow cells; its series does not.
  const double difference =
      h < 0.05 ? h * h * (-1.0 / 3 + h * h * (1.0 / 30 - h * h / 840)) : std::cos(h) - std::sin(h) / h;
  const double even = std::sin(middle) * std::sin(h);
  const double odd = std::cos(middle) * difference;
  return {even + odd, even - odd};
}

class GridIntensity final : public IntensityDistribution {
 public:
  GridIntensity(Symmetry symmetry, std::vector<double> vertical_rad, std::vector<double> horizontal_rad,
                std::vector<double> candela)
      : symmetry_(symmetry),
        vertical_(std::move(vertical_rad)),
        horizontal_(std::move(horizontal_rad)),
        candela_(std::move(candela)) {
    max_cd_ = *std::max_element(candela_.begin(), candela_.end());
    flux_lm_ = integrate();
    emission_cone_rad_ = find_cone();
  }

  double intensity_cd(const Vec3& d) const override {
    const double gamma = std::atan2(std::sqrt(d.x() * d.x() + d.y() * d.y()), -d.z());
    // Rounding must not darken a direction that lies on the first or last angle.
    constexpr double kRounding = 1e-9;
    const auto& vertical = vertical_.knots_rad();
    if (gamma < vertical.front() - kRounding || gamma > vertical.back() + kRounding) return 0;
    const Axis::Cell v = vertical_.cell(gamma);
    if (symmetry_ == Symmetry::axial) return blend(candela_.data() + v.index, v.fraction);
    const Axis::Cell h = horizontal_.cell(fold(d));
    const double* const plane = candela_.data() + h.index * vertical.size() + v.index;
    const double here = blend(plane, v.fraction);
    return here + h.fraction * (blend(plane + vertical.size(), v.fraction) - here);
  }

  double flux_lm() const override { return flux_lm_; }
  double max_intensity_cd() const override { return max_cd_; }
  double emission_cone_rad() const override { return emission_cone_rad_; }

 private:
  static double blend(const double* at, double fraction) { return at[0] + fraction * (at[1] - at[0]); }

  /// C angle [rad] folded into the planes that the file has: a mirror is the sign of a coordinate.
  double fold(const Vec3& d) const {
    switch (symmetry_) {
      case Symmetry::quadrant:
        return std::atan2(std::abs(d.y()), std::abs(d.x()));
      case Symmetry::half_0_180:
        return std::atan2(std::abs(d.y()), d.x());
      case Symmetry::half_90_270:  // from +Y (90°) over -X to -Y (270°)
        return kPi - std::atan2(d.y(), std::abs(d.x()));
      default: {
        const double c = std::atan2(d.y(), d.x());
        return c < 0 ? c + 2 * kPi : c;
      }
    }
  }

  double integrate() const {
    const auto& vertical = vertical_.knots_rad();
    std::vector<double> weight(vertical.size(), 0.0);
    for (std::size_t i = 0; i + 1 < vertical.size(); ++i) {
      const auto [lower, upper] = hat_weights(vertical[i], vertical[i + 1]);
      weight[i] += lower;
      weight[i + 1] += upper;
    }
    const auto& horizontal = horizontal_.knots_rad();
    double sum = 0;
    for (std::size_t h = 0; h + 1 < horizontal.size(); ++h) {
      const double* const plane = candela_.data() + h * vertical.size();
      double rings = 0;
      for (std::size_t i = 0; i < vertical.size(); ++i) rings += weight[i] * (plane[i] + plane[vertical.size() + i]);
      sum += 0.5 * (horizontal[h + 1] - horizontal[h]) * rings;
    }
    // The planes held cover the whole turn, or a half or a quarter of it.
    return sum * 2 * kPi / (horizontal.back() - horizontal.front());
  }

  double find_cone() const {
    const auto& vertical = vertical_.knots_rad();
    std::size_t dark_from = 0;  // first vertical index from which every plane is 0
    for (std::size_t i = 0; i < candela_.size(); ++i) {
      if (candela_[i] > 0) dark_from = std::max(dark_from, i % vertical.size() + 1);
    }
    const double gamma = vertical[std::min(dark_from, vertical.size() - 1)];
    return gamma > 0.5 * kPi ? 2 * kPi : 2 * gamma;
  }

  Symmetry symmetry_;
  Axis vertical_;
  Axis horizontal_;  // closed: includes the plane at 360° when there is no symmetry; 0 and 360° when axial
  std::vector<double> candela_;
  double max_cd_ = 0;
  double flux_lm_ = 0;
  double emission_cone_rad_ = 0;
};

}  // namespace

Intensity make_intensity(const IesFile& file) {
  LUXRIG_CHECK(file.vertical_deg.size() >= 2 && !file.horizontal_deg.empty() &&
                   file.candela.size() == file.vertical_deg.size() * file.horizontal_deg.size(),
               "{} vertical and {} horizontal angles, {} values", file.vertical_deg.size(), file.horizontal_deg.size(),
               file.candela.size());
  const Symmetry symmetry = symmetry_of(file.horizontal_deg);
  std::vector<double> horizontal_deg = file.horizontal_deg;
  std::vector<double> candela = file.candela;
  if (symmetry == Symmetry::axial) {
    horizontal_deg = {0, 360};
  } else if (symmetry == Symmetry::none && horizontal_deg.back() < 360) {
    horizontal_deg.push_back(360);
  }
  if (horizontal_deg.size() > file.horizontal_deg.size()) {  // plane 0 again, to close the turn
    candela.reserve(candela.size() + file.vertical_deg.size());
    for (std::size_t i = 0; i < file.vertical_deg.size(); ++i) candela.push_back(file.candela[i]);
  }
  std::vector<double> vertical_deg = file.vertical_deg;
  for (double& angle : horizontal_deg) angle = rad_from_deg(angle);
  for (double& angle : vertical_deg) angle = rad_from_deg(angle);
  return std::make_shared<GridIntensity>(symmetry, std::move(vertical_deg), std::move(horizontal_deg),
                                         std::move(candela));
}

}  // namespace luxrig
