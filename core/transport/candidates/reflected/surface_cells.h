#pragma once
/// Surfaces cut by a grid into small cells of constant light.
///
/// A cell is the part of the surfaces within one grid cube that faces roughly one way (the axis nearest to its normal).
/// If that part falls into pieces that do not see each other, such as a floor under a wall, each is its own cell, so
/// that no light leaks through walls thinner than a cell. Cells are made where rays hit; surfaces that light never
/// reaches cost nothing. The places that represent a cell are an even random choice of all hits. There are several,
/// since a doorway's edge cuts through many cells.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/scene/ray_scene.h"

namespace luxrig {

class SurfaceCells {
 public:
  static constexpr std::uint32_t kNone = ~0u;

  /// How a place was found. A place known to be seen by a receiver represents a cell only if there are no others:
  /// otherwise light would be too bright (by 1 % in a flat of eight rooms, by more behind doors).
  enum class Found { from_receiver, from_surface, from_lamp };

  /// The first half of a cell's places come from hits from surfaces, the others from hits from lamps, if any: in a cell
  /// partly under a table, lamp light falls on the other part.
  static constexpr std::size_t kPlaces = 4;

  struct CellPoint {
    Vec3 position_world_m;
    Vec3 normal_world;
  };
  struct Cell {
    std::array<CellPoint, kPlaces> places;  ///< represent the cell; the same one several times if few were hit
    Vec3 first_world_m;                     ///< the first hit; places that see it belong to the cell
    Vec3 first_normal_world;
    std::uint32_t hits_from_surfaces = 0, hits_from_lamps = 0;
    std::uint32_t next = kNone;  ///< another piece in the same cube that faces the same way
  };

  /// offset_share   start of the grid, as a share of a cell in each axis
  SurfaceCells(const Scene& scene, const RayScene& rays, double cell_m, const Vec3& offset_share);

  /// The cell of a place on a surface; made if there is none yet and there are fewer than `max_cells`.
  std::uint32_t cell_at(const Vec3& position_world_m, const Vec3& normal_world, std::uint32_t max_cells, Found by);

  /// The same without making one: the nearest cell around it, or kNone. Adds the rays cast to `rays`.
  [[nodiscard]] std::uint32_t find(const Vec3& position_world_m, const Vec3& normal_world, std::uint64_t& rays) const;

  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }
  [[nodiscard]] double cell_m() const { return cell_m_; }
  [[nodiscard]] std::uint64_t rays_cast() const { return rays_cast_; }

 private:
  using Cube = Eigen::Matrix<int, 3, 1>;
  struct Slot {
    std::uint64_t key = 0;  ///< 0 = empty
    std::uint32_t first = kNone;
  };

  [[nodiscard]] Cube cube_at(const Vec3& position_world_m) const;
  [[nodiscard]] static std::uint64_t key_of(const Cube& cube, const Vec3& normal);
  [[nodiscard]] std::size_t slot_of(std::uint64_t key) const;
  [[nodiscard]] std::uint32_t plane_in(const Cube& cube) const;
  /// True if only one plane passes through the cube, with a margin: then all of it is one cell.
  [[nodiscard]] bool simple(const Cube& cube) const;
  [[nodiscard]] bool sees(const Vec3& position_world_m, const Vec3& normal_world, const Cell& cell,
                          std::uint64_t& rays) const;
  /// The same within a cube: only surfaces in the cube can be in between.
  [[nodiscard]] bool sees_within(const Cube& cube, const Vec3& position_world_m, const Vec3& normal_world,
                                 const Cell& cell, std::uint64_t& rays) const;
  /// Piece of the cell chain that the place belongs to.
  [[nodiscard]] std::uint32_t piece(std::uint32_t first, const Cube& cube, const Vec3& position_world_m,
                                    const Vec3& normal_world, std::uint64_t& rays) const;
  static void stand_in(Cell& cell, std::uint64_t key, const CellPoint& place, Found by);
  void mark_cubes(const Scene& scene);
  void grow();

  const RayScene* rays_;
  double cell_m_;
  Vec3 start_world_m_;
  Cube size_ = Cube::Zero();
  /// Per cube: a triangle in its only plane; kNone = no plane; from kSeveral on = index of a list of several.
  std::vector<std::uint32_t> plane_in_cube_;
  struct Corners {
    Vec3 a_world_m, ab_m, ac_m;
  };
  std::vector<std::uint32_t> list_begin_ = {0};
  std::vector<Corners> listed_;
  std::vector<Cell> cells_;
  std::vector<Slot> slots_;
  std::size_t slots_used_ = 0;
  std::uint64_t rays_cast_ = 0;
};

}  // namespace luxrig
