#include "core/highlight/distant/bin_neighbours.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace luxrig {

BinNeighbours bins_within(const DirectionBins& bins, double angle_rad) {
  LUXRIG_CHECK(angle_rad >= 0 && angle_rad <= kPi, "angle {} rad", angle_rad);
  std::vector<Vec3> direction(bins.count());
  std::vector<double> from_pole_rad(bins.count());
  for (std::uint32_t b = 0; b < bins.count(); ++b) {
    direction[b] = bins.direction_of(b);
    from_pole_rad[b] = std::acos(std::clamp(direction[b].z(), -1.0, 1.0));
  }
  // Bins come in rings from the pole; the search ends at those farther from it by more than the angle.
  const double min_cosine = std::cos(angle_rad), past_rad = angle_rad + 1e-9;
  std::vector<std::vector<std::uint32_t>> near(bins.count());
  for (std::uint32_t a = 0; a < bins.count(); ++a) {
    for (std::uint32_t b = a + 1; b < bins.count() && from_pole_rad[b] - from_pole_rad[a] <= past_rad; ++b) {
      if (direction[a].dot(direction[b]) < min_cosine) continue;
      near[a].push_back(b);
      near[b].push_back(a);
    }
  }
  BinNeighbours result;
  for (auto& mine : near) {
    std::sort(mine.begin(), mine.end());
    result.bins.insert(result.bins.end(), mine.begin(), mine.end());
    result.begin.push_back(static_cast<std::uint32_t>(result.bins.size()));
  }
  return result;
}

double bin_width_rad(const DirectionBins& bins) { return std::sqrt(4 * kPi / bins.count()); }

}  // namespace luxrig
