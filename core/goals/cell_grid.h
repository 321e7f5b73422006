#pragma once
/// The grid of cells at whose boundaries surfaces are cut. Internal to core/goals.

#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

/// Cells along each axis.
inline constexpr std::uint32_t kMaxCells = (1u << 21) - 1;

/// Cubes of one size at fixed places in the world, so that a scene that grows elsewhere keeps its cells. Rooms are
/// built in whole centimetres. The boundaries are therefore an irrational share of a cell off the world's zero, or
/// floors would lie in them.
class CellGrid {
 public:
  CellGrid() = default;
  /// Boxes relative to origin_world_m. The grid reaches a cell further than the box on all sides.
  CellGrid(double cell_m, const Vec3& origin_world_m, const Eigen::AlignedBox3d& box_m);

  [[nodiscard]] double cell_m() const { return cell_m_; }
  /// Coordinates in cells, ≥ 1 inside the box, of a place relative to the scene's origin.
  [[nodiscard]] Vec3 cells_of(const Vec3& position_m) const { return position_m / cell_m_ + shift_cells_; }
  [[nodiscard]] Vec3 position_m(const Vec3& in_cells) const { return (in_cells - shift_cells_) * cell_m_; }
  /// False where a place is off the grid.
  [[nodiscard]] bool contains(const Vec3& in_cells) const {
    return in_cells.minCoeff() >= 0 && (in_cells.array() < cells_.array()).all();
  }

 private:
  double cell_m_ = 1;
  Vec3 shift_cells_ = Vec3::Zero(), cells_ = Vec3::Zero();
};

/// A cell as one number, in Morton order: near cells have near numbers, and the neighbour in a positive direction has
/// the higher one.
using CellKey = std::uint64_t;
[[nodiscard]] CellKey key_of(const std::array<std::uint32_t, 3>& cell);
[[nodiscard]] CellKey key_at(const Vec3& in_cells);
[[nodiscard]] std::array<std::uint32_t, 3> cell_of(CellKey key);
/// The next cell along an axis (0…2) upwards.
[[nodiscard]] CellKey next_cell(CellKey key, int axis);

/// Finds cells by their keys in a list that rises.
class CellIndex {
 public:
  static constexpr std::uint32_t kNone = ~0u;

  CellIndex() = default;
  explicit CellIndex(const std::vector<CellKey>& keys);
  /// The place in that list, or kNone.
  [[nodiscard]] std::uint32_t find(CellKey key) const;

 private:
  [[nodiscard]] std::size_t slot_of(CellKey key) const;
  struct Slot {
    CellKey key = 0;
    std::uint32_t place = kNone;
  };
  std::vector<Slot> slots_;  ///< a power of two of them, at most half in use
};

/// The order in which the keys rise. Equal keys keep their order. Linear in their number.
[[nodiscard]] std::vector<std::uint32_t> order_of(const std::vector<CellKey>& keys);

}  // namespace luxrig
