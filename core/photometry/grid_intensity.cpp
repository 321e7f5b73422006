#include "core/photometry/grid_intensity.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace luxrig {
namespace {

Vec3 table_from_lamp(GridAxes axes, const Vec3& d) {
  switch (axes) {
    case GridAxes::b:
      return {-d.z(), d.x(), d.y()};
    case GridAxes::a:
      return {-d.z(), d.x(), -d.y()};
    default:
      return {d.x(), d.y(), -d.z()};
  }
}

Vec3 lamp_from_table(GridAxes axes, const Vec3& d) {
  if (axes == GridAxes::b) return {d.y(), d.z(), -d.x()};
  if (axes == GridAxes::a) return {d.y(), -d.z(), -d.x()};
  return table_from_lamp(axes, d);  // a mirror, its own inverse
}

/// Largest angle from -Z at which a table in axes C is not dark.
double half_cone_about_pole_rad(const SphereTable& table) {
  const auto& polar = table.polar_rad();
  const std::size_t columns = table.symmetry() == SphereTable::Symmetry::round ? 1 : table.azimuth_rad().size();
  std::size_t dark_from = 0;  // first polar index from which every column is 0
  for (std::size_t a = 0; a < columns; ++a) {
    for (std::size_t p = dark_from; p < polar.size(); ++p) {
      if (table.value(a, p) > 0) dark_from = p + 1;
    }
  }
  return polar[std::min(dark_from, polar.size() - 1)];
}

/// The same in axes A or B, where the cosine of that angle is sin(polar) cos(azimuth).
double half_cone_across_pole_rad(const SphereTable& table) {
  const auto& polar = table.polar_rad();
  const auto& azimuth = table.azimuth_rad();
  const bool round = table.symmetry() == SphereTable::Symmetry::round;
  double min_cosine = 1;
  for (std::size_t p = 0; p + 1 < polar.size(); ++p) {
    const double sine = std::max(0.0, std::min(std::sin(polar[p]), std::sin(polar[p + 1])));
    for (std::size_t a = 0; a + 1 < azimuth.size(); ++a) {
      const std::size_t last = round ? 0 : a + 1;
      const std::size_t first = round ? 0 : a;
      const bool dark = table.value(first, p) == 0 && table.value(first, p + 1) == 0 && table.value(last, p) == 0 &&
                        table.value(last, p + 1) == 0;
      if (dark) continue;
      const double cosine = round ? -1 : std::min(std::cos(azimuth[a]), std::cos(azimuth[a + 1]));
      min_cosine = std::min(min_cosine, cosine < 0 ? -1 : sine * cosine);
    }
  }
  return std::acos(min_cosine);
}

class GridIntensity final : public IntensityDistribution {
 public:
  GridIntensity(SphereTable table, GridAxes axes) : table_(std::move(table)), axes_(axes) {
    const double half_rad = axes_ == GridAxes::c ? half_cone_about_pole_rad(table_) : half_cone_across_pole_rad(table_);
    emission_cone_rad_ = half_rad > 0.5 * kPi + 1e-9 ? 2 * kPi : std::min(kPi, 2 * half_rad);
  }

  double intensity_cd(const Vec3& direction_lamp) const override {
    return table_.at(table_from_lamp(axes_, direction_lamp));
  }
  double flux_lm() const override { return table_.integral(); }
  double max_intensity_cd() const override { return table_.largest(); }
  double emission_cone_rad() const override { return emission_cone_rad_; }

  DirectionSample sample(double u, double v) const override {
    const SphereTable::Sample drawn = table_.sample(u, v);
    return {lamp_from_table(axes_, drawn.direction), drawn.value / table_.integral()};
  }
  double density_per_sr(const Vec3& direction_lamp) const override {
    return intensity_cd(direction_lamp) / table_.integral();
  }

 private:
  SphereTable table_;
  GridAxes axes_;
  double emission_cone_rad_ = 0;
};

}  // namespace

Intensity make_grid_intensity(SphereTable table, GridAxes axes) {
  return std::make_shared<GridIntensity>(std::move(table), axes);
}

std::vector<double> radians(std::vector<double> degrees, double offset_deg) {
  for (double& angle : degrees) angle = rad_from_deg(angle + offset_deg);
  return degrees;
}

}  // namespace luxrig
