#pragma once
/// Chooses which of many lamps matter where. Internal to Lamps.
///
/// A scene with more than a few light positions is cut into cells. In each cell the places that could give most are
/// weighed individually for every surface point. All others that could give any light share a small part of the
/// probability, by their possible light in the cell. So no lamp that lights a point has probability 0 there, and the
/// cost of a choice does not grow with the number of lamps. With few lamps, and outside the cells, all are weighed.

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "core/photometry/intensity.h"

namespace luxrig {

/// Approximate intensity by the angle from the axis: accurate enough for choices, and fast.
struct LampProfile {
  static constexpr std::size_t kBins = 128;
  std::array<float, kBins> candela{};  ///< over sin(angle / 2), at least a hundredth of the largest
  static LampProfile of(const IntensityDistribution& intensity, bool sized);
  [[nodiscard]] static std::size_t bin_of(float half_sine) {
    return std::min(static_cast<std::size_t>(half_sine * kBins), kBins - 1);
  }
};

/// Lamps of luminaires as arrays, to weigh several at a time.
struct WeighedLamps {
  std::vector<double> x_m, y_m, z_m;
  std::vector<float> axis_x, axis_y, axis_z, cos_half_cone, importance, radius_m;
  std::vector<std::uint32_t> place, profile;  ///< place: index in the cell's places

  void add(const WeighedLamps& from, std::size_t lamp, std::uint32_t at_place);
};

class LampCells {
 public:
  struct Cell {
    WeighedLamps lamps;
    std::vector<std::uint32_t> places;  ///< rising; skies last
    std::vector<std::uint32_t> rest;    ///< rising: other places that could give light
    std::vector<float> rest_lx;         ///< approximate lux of each, > 0
    double rest_sum_lx = 0;

    /// Index of `place` in `places`, or their number if it is not there.
    [[nodiscard]] std::size_t slot_of(std::size_t place) const;
    /// Approximate lux of a place of the rest; 0 for all others.
    [[nodiscard]] double rest_of(std::size_t place) const;
  };

  /// lamps     all of them, in the order of their places
  /// places    their number: those with lamps, then skies
  /// bounds    of the region cut into cells; may be empty
  LampCells(WeighedLamps lamps, std::vector<LampProfile> profiles, std::size_t places,
            const Eigen::AlignedBox3d& bounds_world_m);
  LampCells() = default;

  [[nodiscard]] const Cell& at(const Vec3& position_world_m) const;
  [[nodiscard]] const LampProfile& profile(std::uint32_t which) const { return profiles_[which]; }

 private:
  [[nodiscard]] Cell cell_of(const Vec3& centre_world_m, double radius_m) const;

  Cell all_;
  std::vector<LampProfile> profiles_;
  std::vector<Cell> cells_;
  std::size_t luminaires_ = 0, places_ = 0;  ///< number of places with lamps; of all places
  Eigen::AlignedBox3d box_world_m_;
  Eigen::Array3i count_ = Eigen::Array3i::Zero();
};

}  // namespace luxrig
