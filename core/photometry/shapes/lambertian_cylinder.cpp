#include <cmath>
#include <utility>
#include <vector>

#include "core/check.h"
#include "core/photometry/intensity.h"
#include "core/photometry/sphere_table.h"

namespace luxrig {
namespace {

class LambertianCylinder final : public IntensityDistribution {
 public:
  LambertianCylinder(double flux_lm, double diameter_m, double length_m)
      : flux_lm_(flux_lm),
        side_cd_(flux_lm * length_m / (kPi * kPi * (length_m + 0.5 * diameter_m))),
        end_cd_(flux_lm * diameter_m / (4 * kPi * (length_m + 0.5 * diameter_m))),
        drawn_(tabulated()) {}

  double intensity_cd(const Vec3& d) const override {
    return side_cd_ * std::sqrt(d.x() * d.x() + d.y() * d.y()) + end_cd_ * std::abs(d.z());
  }
  double flux_lm() const override { return flux_lm_; }
  double max_intensity_cd() const override { return std::hypot(side_cd_, end_cd_); }
  double emission_cone_rad() const override { return 2 * kPi; }
  DirectionSample sample(double u, double v) const override {
    const SphereTable::Sample drawn = drawn_.sample(u, v);
    return {drawn.direction, drawn.value / drawn_.integral()};
  }
  double density_per_sr(const Vec3& d) const override { return drawn_.at(d) / drawn_.integral(); }

 private:
  /// Symmetric up and down, so the table's +Z may be the lamp's.
  [[nodiscard]] SphereTable tabulated() const {
    constexpr int kSteps = 180;  // includes 90°, where the ends' share has a kink
    std::vector<double> polar, values;
    for (int i = 0; i <= kSteps; ++i) {
      polar.push_back(kPi * i / kSteps);
      values.push_back(side_cd_ * std::sin(polar.back()) + end_cd_ * std::abs(std::cos(polar.back())));
    }
    return SphereTable(SphereTable::Symmetry::round, std::move(polar), {}, std::move(values));
  }

  double flux_lm_;
  double side_cd_, end_cd_;  // seen perpendicularly
  SphereTable drawn_;
};

}  // namespace

Intensity make_lambertian_cylinder(double flux_lm, double diameter_m, double length_m) {
  LUXRIG_CHECK(flux_lm > 0 && std::isfinite(flux_lm), "flux {} lm", flux_lm);
  LUXRIG_CHECK(diameter_m > 0 && length_m > 0, "{} by {} m", diameter_m, length_m);
  return std::make_shared<LambertianCylinder>(flux_lm, diameter_m, length_m);
}

}  // namespace luxrig
