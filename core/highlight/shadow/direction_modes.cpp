#include "core/highlight/shadow/direction_modes.h"

#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>

#include "core/check.h"
#include "core/highlight/shadow/direction_bins.h"

namespace luxrig {
namespace {

constexpr double kBinsPerWindow = 8, kStartsPerWindow = 2;
constexpr int kFinestModeSide = 1024;
constexpr int kMaxShifts = 100;
constexpr std::size_t kModeLeaf = 8;

struct WeighedDirection {
  std::uint32_t bin;
  Vec3 direction;  // a sum until normalised
  double weight;
};

struct WeighedCloud {
  const std::vector<WeighedDirection>& all;
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return all.size(); }
  [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return all[i].direction[static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

int side_for(double width_rad) {
  const double side = std::sqrt(4 * kPi / 12) / width_rad;
  return static_cast<int>(std::clamp(std::ceil(side), 1.0, static_cast<double>(kFinestModeSide)));
}

/// Means by bin, in the order of bins.
std::vector<WeighedDirection> joined_by_bin(std::vector<WeighedDirection> all, const DirectionBins& bins) {
  for (WeighedDirection& one : all) one.bin = bins.bin_of(one.direction);
  std::stable_sort(all.begin(), all.end(),
                   [](const WeighedDirection& a, const WeighedDirection& b) { return a.bin < b.bin; });
  std::vector<WeighedDirection> joined;
  for (const WeighedDirection& one : all) {
    if (joined.empty() || joined.back().bin != one.bin) joined.push_back({one.bin, Vec3::Zero(), 0});
    joined.back().direction += one.weight * one.direction;
    joined.back().weight += one.weight;
  }
  for (WeighedDirection& one : joined) one.direction.normalize();
  return joined;
}

}  // namespace

std::vector<DirectionMode> direction_modes(std::span<const Vec3f> directions, std::span<const double> weights,
                                           double window_rad) {
  LUXRIG_CHECK(directions.size() == weights.size(), "{} weights for {} directions", weights.size(), directions.size());
  LUXRIG_CHECK(window_rad > 0 && window_rad <= kPi, "window {} rad", window_rad);
  std::vector<WeighedDirection> all;
  for (std::size_t i = 0; i < directions.size(); ++i)
    if (weights[i] > 0) all.push_back({0, directions[i].cast<double>().normalized(), weights[i]});
  if (all.empty()) return {};
  all = joined_by_bin(std::move(all), DirectionBins(side_for(window_rad / kBinsPerWindow)));
  const std::vector<WeighedDirection> starts =
      joined_by_bin(all, DirectionBins(side_for(window_rad / kStartsPerWindow)));

  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, WeighedCloud>, WeighedCloud, 3,
                                                   std::uint32_t>;
  const WeighedCloud cloud{all};
  Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(kModeLeaf));
  tree.buildIndex();
  const double chord2 = 4 * std::pow(std::sin(0.5 * window_rad), 2) * (1 + 1e-12);
  std::vector<std::pair<std::uint32_t, double>> near;
  nanoflann::SearchParams unsorted;
  unsorted.sorted = false;
  const auto mean_around = [&](const Vec3& direction, double& weight) {
    tree.radiusSearch(direction.data(), chord2, near, unsorted);
    Vec3 sum = Vec3::Zero();
    weight = 0;
    for (const auto& [i, unused] : near) {
      sum += all[i].weight * all[i].direction;
      weight += all[i].weight;
    }
    return sum;
  };
  std::vector<DirectionMode> found;
  for (const WeighedDirection& start : starts) {
    DirectionMode mode{start.direction, 0};
    for (int shift = 0; shift < kMaxShifts; ++shift) {
      const Vec3 sum = mean_around(mode.direction, mode.weight);
      // No direction near a start that is the mean of far ones; or directions that cancel, in a window of half a
      // sphere.
      if (!(mode.weight > 0) || !(sum.norm() > 1e-9 * mode.weight)) break;
      const Vec3 next = sum.normalized();
      const double moved = (next - mode.direction).norm();
      mode.direction = next;
      if (moved < 1e-3 * window_rad) break;
    }
    mean_around(mode.direction, mode.weight);
    if (mode.weight > 0) found.push_back(mode);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const DirectionMode& a, const DirectionMode& b) { return a.weight > b.weight; });
  std::vector<DirectionMode> modes;
  for (const DirectionMode& mode : found) {
    const bool known = std::any_of(modes.begin(), modes.end(), [&](const DirectionMode& other) {
      return (mode.direction - other.direction).squaredNorm() <= chord2;
    });
    if (!known) modes.push_back(mode);
  }
  return modes;
}

}  // namespace luxrig
