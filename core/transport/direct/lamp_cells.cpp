#include "core/transport/direct/lamp_cells.h"

#include <cmath>
#include <limits>
#include <numeric>

namespace luxrig {
namespace {

/// Up to this number of places, all are weighed at every point: cells would cost more than they save.
constexpr std::size_t kFewPlaces = 100;
/// Limits of cells times places (their rests are in memory), and of cells.
constexpr std::size_t kMaxCellEntries = 4'000'000, kMaxCells = 8192;
/// Share of the places' possible light in a cell that is left to the rest; and the most places weighed.
constexpr double kShareOfRest = 0.02;
constexpr std::size_t kMaxWeighed = 48;

}  // namespace

LampProfile LampProfile::of(const IntensityDistribution& intensity, bool sized) {
  constexpr int kAzimuths = 16, kAngles = 2;
  LampProfile profile;
  // Other points of a shape see a point at other angles.
  const auto least = static_cast<float>((sized ? 0.05 : 0.01) * intensity.max_intensity_cd());
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    double most = 0;
    for (int a = 0; a <= kAngles; ++a) {
      const double half_sine = (static_cast<double>(bin) + static_cast<double>(a) / kAngles) / kBins;
      const double angle = 2 * std::asin(std::min(half_sine, 1.0));
      for (int b = 0; b < kAzimuths; ++b) {
        const double azimuth = 2 * kPi * b / kAzimuths;
        most = std::max(most, intensity.intensity_cd({std::sin(angle) * std::cos(azimuth),
                                                      std::sin(angle) * std::sin(azimuth), -std::cos(angle)}));
      }
    }
    profile.candela[bin] = std::max(static_cast<float>(most), least);
  }
  return profile;
}

void WeighedLamps::add(const WeighedLamps& from, std::size_t lamp, std::uint32_t at_place) {
  x_m.push_back(from.x_m[lamp]);
  y_m.push_back(from.y_m[lamp]);
  z_m.push_back(from.z_m[lamp]);
  axis_x.push_back(from.axis_x[lamp]);
  axis_y.push_back(from.axis_y[lamp]);
  axis_z.push_back(from.axis_z[lamp]);
  cos_half_cone.push_back(from.cos_half_cone[lamp]);
  importance.push_back(from.importance[lamp]);
  radius_m.push_back(from.radius_m[lamp]);
  place.push_back(at_place);
  profile.push_back(from.profile[lamp]);
}

std::size_t LampCells::Cell::slot_of(std::size_t place) const {
  const auto found = std::lower_bound(places.begin(), places.end(), place);
  return found != places.end() && *found == place ? static_cast<std::size_t>(found - places.begin()) : places.size();
}

double LampCells::Cell::rest_of(std::size_t place) const {
  const auto found = std::lower_bound(rest.begin(), rest.end(), place);
  return found != rest.end() && *found == place
             ? static_cast<double>(rest_lx[static_cast<std::size_t>(found - rest.begin())])
             : 0;
}

LampCells::LampCells(WeighedLamps lamps, std::vector<LampProfile> profiles, std::size_t places,
                     const Eigen::AlignedBox3d& bounds_world_m)
    : profiles_(std::move(profiles)), places_(places), box_world_m_(bounds_world_m) {
  all_.lamps = std::move(lamps);
  all_.places.resize(places);
  std::iota(all_.places.begin(), all_.places.end(), 0u);
  luminaires_ = all_.lamps.place.empty() ? 0 : all_.lamps.place.back() + 1;
  if (luminaires_ <= kFewPlaces || box_world_m_.isEmpty()) return;
  const Eigen::Array3d size_m = box_world_m_.sizes().array().max(1e-3 * box_world_m_.sizes().maxCoeff());
  const double wanted = static_cast<double>(std::min(kMaxCells, kMaxCellEntries / luminaires_));
  if (!(wanted >= 1) || !(size_m > 0).all() || !size_m.allFinite()) return;
  const double side_m = std::cbrt(size_m.prod() / wanted);
  count_ = (size_m / side_m).floor().max(1).cast<int>();
  const Vec3 cell_m = (box_world_m_.sizes().array() / count_.cast<double>()).matrix();
  // A point on the rim of a cell may round into the next cell.
  const double radius_m = 0.5 * cell_m.norm() + 1e-6 * (box_world_m_.min().norm() + box_world_m_.sizes().norm());
  for (int z = 0; z < count_.z(); ++z)
    for (int y = 0; y < count_.y(); ++y)
      for (int x = 0; x < count_.x(); ++x)
        cells_.push_back(
            cell_of(box_world_m_.min() + ((Eigen::Array3d(x, y, z) + 0.5) * cell_m.array()).matrix(), radius_m));
}

LampCells::Cell LampCells::cell_of(const Vec3& centre_world_m, double radius_m) const {
  const WeighedLamps& w = all_.lamps;
  std::vector<double> could_lx(luminaires_, 0.0);  // approximate maximum by place, facing it; infinite = near
  for (std::size_t i = 0; i < w.place.size(); ++i) {
    const Vec3 towards_m = Vec3(w.x_m[i], w.y_m[i], w.z_m[i]) - centre_world_m;
    const double distance_m = towards_m.norm(), reach_m = radius_m + static_cast<double>(w.radius_m[i]);
    double& could = could_lx[w.place[i]];
    if (distance_m <= 2 * reach_m) {
      could = std::numeric_limits<double>::infinity();
      continue;
    }
    // Angle from the axis, and its variation over the cell.
    const Vec3 axis(w.axis_x[i], w.axis_y[i], w.axis_z[i]);
    const double cosine = std::clamp(-axis.dot(towards_m) / distance_m, -1.0, 1.0);
    const double angle = std::acos(cosine), spread = std::asin(reach_m / distance_m) + 1e-4;
    const double least = std::max(0.0, angle - spread), most = std::min(kPi, angle + spread);
    if (std::cos(least) < static_cast<double>(w.cos_half_cone[i])) continue;
    const std::size_t first = LampProfile::bin_of(static_cast<float>(std::sin(least / 2)));
    const std::size_t last = LampProfile::bin_of(static_cast<float>(std::sin(most / 2)));
    const auto& candela = profiles_[w.profile[i]].candela;
    const float largest = *std::max_element(candela.begin() + static_cast<std::ptrdiff_t>(first),
                                            candela.begin() + static_cast<std::ptrdiff_t>(last) + 1);
    const double nearest_m = distance_m - reach_m;
    could += static_cast<double>(w.importance[i]) * static_cast<double>(largest) / (nearest_m * nearest_m);
  }
  Cell cell;
  std::vector<std::uint32_t> order;
  double sum = 0;
  for (std::uint32_t p = 0; p < luminaires_; ++p) {
    if (!(could_lx[p] > 0)) continue;
    order.push_back(p);
    if (std::isfinite(could_lx[p])) sum += could_lx[p];
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return could_lx[a] > could_lx[b]; });
  std::size_t weighed = 0;
  double left = sum;
  for (; weighed < order.size(); ++weighed) {
    const double could = could_lx[order[weighed]];
    if (!std::isfinite(could)) continue;
    if (left <= kShareOfRest * sum || weighed >= kMaxWeighed) break;
    left -= could;
  }
  cell.places.assign(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(weighed));
  cell.rest.assign(order.begin() + static_cast<std::ptrdiff_t>(weighed), order.end());
  std::sort(cell.places.begin(), cell.places.end());
  std::sort(cell.rest.begin(), cell.rest.end());
  for (const std::uint32_t p : cell.rest) {
    // Half: few of them face the surface.
    cell.rest_lx.push_back(std::max(static_cast<float>(0.5 * could_lx[p]), std::numeric_limits<float>::min()));
    cell.rest_sum_lx += static_cast<double>(cell.rest_lx.back());
  }
  for (std::size_t slot = 0; slot < cell.places.size(); ++slot) {
    const auto begin = std::lower_bound(w.place.begin(), w.place.end(), cell.places[slot]);
    for (auto it = begin; it != w.place.end() && *it == cell.places[slot]; ++it)
      cell.lamps.add(w, static_cast<std::size_t>(it - w.place.begin()), static_cast<std::uint32_t>(slot));
  }
  for (std::size_t p = luminaires_; p < places_; ++p) cell.places.push_back(static_cast<std::uint32_t>(p));
  return cell;
}

const LampCells::Cell& LampCells::at(const Vec3& position_world_m) const {
  if (cells_.empty() || !box_world_m_.contains(position_world_m)) return all_;
  const Eigen::Array3d share =
      (position_world_m - box_world_m_.min()).array() / box_world_m_.sizes().array().max(1e-300);
  const Eigen::Array3i place = (share * count_.cast<double>()).cast<int>().max(0).min(count_ - 1);
  return cells_[static_cast<std::size_t>((place.z() * count_.y() + place.y()) * count_.x() + place.x())];
}

}  // namespace luxrig
