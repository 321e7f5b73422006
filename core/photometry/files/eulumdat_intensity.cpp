#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"
#include "core/photometry/files/eulumdat.h"
#include "core/photometry/grid_intensity.h"

namespace luxrig {
Intensity make_intensity(const EulumdatFile& file, std::size_t lamp_set) {
  using Table = SphereTable::Symmetry;
  const std::size_t gammas = file.gamma_deg.size();
  const std::size_t planes = file.stored_planes();
  LUXRIG_CHECK(lamp_set < file.lamp_sets.size() && file.cd_per_klm.size() == planes * gammas,
               "lamp set {} of {}, {} values for {} planes of {}", lamp_set, file.lamp_sets.size(),
               file.cd_per_klm.size(), planes, gammas);
  const double cd_per_value = file.conversion_factor * file.lamp_sets[lamp_set].flux_lm / 1000;
  std::vector<double> c_deg(file.c_deg.begin(), file.c_deg.begin() + static_cast<std::ptrdiff_t>(planes));
  std::vector<double> candela = file.cd_per_klm;
  for (double& value : candela) value *= cd_per_value;

  Table symmetry = Table::none;
  switch (file.symmetry) {
    case EulumdatFile::Symmetry::round:
      symmetry = Table::round;
      break;
    case EulumdatFile::Symmetry::about_c0_c180:
      symmetry = Table::half_0_180;
      break;
    case EulumdatFile::Symmetry::both:
      symmetry = Table::quadrant;
      break;
    case EulumdatFile::Symmetry::about_c90_c270: {
      // Stored: C270 … C0 … C90. The table needs their mirror images C270 … C180 … C90, ascending.
      symmetry = Table::half_90_270;
      c_deg.assign(planes, 0);
      for (std::size_t i = 0; i < planes; ++i) {
        const double deg = file.c_deg[(file.stored_first() + i) % file.c_deg.size()];
        const std::size_t mirrored = planes - 1 - i;
        c_deg[mirrored] = 180 - (deg >= 270 ? deg - 360 : deg);
        for (std::size_t g = 0; g < gammas; ++g) {
          candela[mirrored * gammas + g] = file.cd_per_klm[i * gammas + g] * cd_per_value;
        }
      }
      break;
    }
    case EulumdatFile::Symmetry::none:
      if (c_deg.back() < 360) {  // repeat plane 0 to close the circle
        c_deg.push_back(360);
        candela.resize(candela.size() + gammas);
        std::copy_n(candela.begin(), gammas, candela.end() - static_cast<std::ptrdiff_t>(gammas));
      }
      break;
  }
  return make_grid_intensity(
      SphereTable(symmetry, radians(file.gamma_deg), radians(std::move(c_deg)), std::move(candela)), GridAxes::c);
}

LuminousOpening luminous_opening(const EulumdatFile& file) {
  using Kind = LuminousShape::Kind;
  LuminousOpening opening;
  const double length = file.luminous_length_m;
  const double width = file.luminous_width_m;
  const auto [least, most] = std::minmax_element(file.luminous_height_m.begin(), file.luminous_height_m.end());
  if (length > 0 && width > 0) {
    opening.shape = {Kind::rectangle, Vec3(width, length, 0)};
    if (*most > 0) opening.note = "its luminous opening is a box: taken as the rectangle below";
  } else if (length > 0 && *least > 0) {
    opening.shape = {Kind::cylinder, Vec3(length, 0, *most)};
  } else if (length > 0) {
    opening.shape = {Kind::disk, Vec3(length, 0, 0)};
    if (*most > 0) opening.note = "its luminous opening shines to some sides only: taken as the disk below";
  } else if (width > 0 || *most > 0) {
    opening.note = "its luminous opening has no length: taken as a point";
  }
  return opening;
}

}  // namespace luxrig
