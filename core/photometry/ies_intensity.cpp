#include <utility>

#include "core/check.h"
#include "core/photometry/grid_intensity.h"
#include "core/photometry/ies.h"

namespace luxrig {
namespace {

using Symmetry = SphereTable::Symmetry;

Symmetry symmetry_of(const std::vector<double>& horizontal_deg) {
  if (horizontal_deg.size() == 1) return Symmetry::round;
  if (horizontal_deg.front() == 90) return Symmetry::half_90_270;
  if (horizontal_deg.back() == 90) return Symmetry::quadrant;
  if (horizontal_deg.back() == 180) return Symmetry::half_0_180;
  return Symmetry::none;
}

}  // namespace

Intensity make_intensity(const IesFile& file) {
  LUXRIG_CHECK(file.vertical_deg.size() >= 2 && !file.horizontal_deg.empty() &&
                   file.candela.size() == file.vertical_deg.size() * file.horizontal_deg.size(),
               "{} vertical and {} horizontal angles, {} values", file.vertical_deg.size(), file.horizontal_deg.size(),
               file.candela.size());
  const Symmetry symmetry = symmetry_of(file.horizontal_deg);
  std::vector<double> horizontal_deg = file.horizontal_deg;
  std::vector<double> candela = file.candela;
  if (symmetry == Symmetry::none && horizontal_deg.back() < 360) {  // plane 0 again, to close the turn
    horizontal_deg.push_back(360);
    candela.reserve(candela.size() + file.vertical_deg.size());
    for (std::size_t i = 0; i < file.vertical_deg.size(); ++i) candela.push_back(file.candela[i]);
  }
  std::vector<double> vertical_deg = file.vertical_deg;
  for (double& angle : horizontal_deg) angle = rad_from_deg(angle);
  for (double& angle : vertical_deg) angle = rad_from_deg(angle);
  return make_grid_intensity(
      SphereTable(symmetry, std::move(vertical_deg), std::move(horizontal_deg), std::move(candela)), GridAxes::c);
}

}  // namespace luxrig
