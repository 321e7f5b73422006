#include <algorithm>
#include <utility>

#include "core/check.h"
#include "core/photometry/files/ies.h"
#include "core/photometry/grid_intensity.h"

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

Intensity type_c(const IesFile& file) {
  const Symmetry symmetry = symmetry_of(file.horizontal_deg);
  std::vector<double> horizontal_deg = file.horizontal_deg;
  std::vector<double> candela = file.candela;
  if (symmetry == Symmetry::none && horizontal_deg.back() < 360) {  // repeat plane 0 to close the circle
    horizontal_deg.push_back(360);
    candela.reserve(candela.size() + file.vertical_deg.size());
    for (std::size_t i = 0; i < file.vertical_deg.size(); ++i) candela.push_back(file.candela[i]);
  }
  return make_grid_intensity(
      SphereTable(symmetry, radians(file.vertical_deg), radians(std::move(horizontal_deg)), std::move(candela)),
      GridAxes::c);
}

/// Mirrors a range that starts at 0: angles from minus the last one on, with the index of the values for each.
struct BothSides {
  explicit BothSides(const std::vector<double>& angles_deg) {
    if (angles_deg.front() == 0) {
      for (std::size_t i = angles_deg.size() - 1; i > 0; --i) {
        deg.push_back(-angles_deg[i]);
        source.push_back(i);
      }
    }
    for (std::size_t i = 0; i < angles_deg.size(); ++i) {
      deg.push_back(angles_deg[i]);
      source.push_back(i);
    }
  }
  std::vector<double> deg;
  std::vector<std::size_t> source;
};

Intensity type_a_or_b(const IesFile& file) {
  const bool b = file.type == IesFile::Type::b;
  const std::size_t verticals = file.vertical_deg.size();
  if (file.horizontal_deg.size() == 1) {
    return make_grid_intensity(SphereTable(Symmetry::round, radians(file.vertical_deg), {}, file.candela), GridAxes::c);
  }
  const BothSides vertical(file.vertical_deg);
  const BothSides horizontal(file.horizontal_deg);
  // Planes share the polar axis: in type B, H runs from pole to pole; in type A, Y (vertical) does.
  const BothSides& polar = b ? horizontal : vertical;
  const BothSides& azimuth = b ? vertical : horizontal;
  std::vector<double> values;
  values.reserve(polar.deg.size() * azimuth.deg.size());
  for (const std::size_t a : azimuth.source) {
    for (const std::size_t p : polar.source) {
      values.push_back(b ? file.candela[p * verticals + a] : file.candela[a * verticals + p]);
    }
  }
  return make_grid_intensity(
      SphereTable(Symmetry::part, radians(polar.deg, 90), radians(azimuth.deg), std::move(values)),
      b ? GridAxes::b : GridAxes::a);
}

}  // namespace

Intensity make_intensity(const IesFile& file) {
  LUXRIG_CHECK(file.vertical_deg.size() >= 2 && !file.horizontal_deg.empty() &&
                   file.candela.size() == file.vertical_deg.size() * file.horizontal_deg.size(),
               "{} vertical and {} horizontal angles, {} values", file.vertical_deg.size(), file.horizontal_deg.size(),
               file.candela.size());
  return file.type == IesFile::Type::c ? type_c(file) : type_a_or_b(file);
}

}  // namespace luxrig
