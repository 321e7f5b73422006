#pragma once
/// Samples of a surface in the cells of a grid, for queries within a radius.

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

/// A place on a surface, and the area it represents.
struct SurfaceSample {
  Vec3 position_m;
  Vec3 normal;  ///< unit; zero = unknown
  double area_m2;
};

class SampleGrid {
 public:
  /// Cells of cell_m, which must be positive; empty cells take no memory.
  SampleGrid(std::vector<SurfaceSample> samples, double cell_m);

  [[nodiscard]] double cell_m() const { return cell_m_; }
  [[nodiscard]] std::size_t cells() const { return cells_.size(); }
  [[nodiscard]] std::span<const SurfaceSample> samples() const { return samples_; }

  /// Stretches of samples() that contain everything within reach_m of a place (and more). Always in the same order.
  void near(const Vec3& place_m, double reach_m, std::vector<std::span<const SurfaceSample>>& stretches) const;

  /// Integer coordinates of a place's cell.
  [[nodiscard]] std::array<std::int32_t, 3> cell_of(const Vec3& place_m) const;

 private:
  struct Cell {
    std::array<std::int32_t, 3> at;
    std::uint32_t begin, end;
  };
  [[nodiscard]] std::size_t slot_of(const std::array<std::int32_t, 3>& at) const;

  std::vector<SurfaceSample> samples_;  ///< by cell
  double cell_m_;
  Vec3 low_m_ = Vec3::Zero();
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> table_;  ///< open addressing: cell + 1, or 0
};

/// Merges the samples of each grid cell that face the same half-space as those before them: means weighted by area.
[[nodiscard]] std::vector<SurfaceSample> merged_in_cells(const std::vector<SurfaceSample>& samples, double cell_m);

}  // namespace luxrig
