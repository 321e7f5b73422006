#pragma once
/// The surfaces of a scene, cut by the cells of a grid into sides: patches that light is stored on.

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/scene/ray_scene.h"
#include "tools/bench/cache/volume/voxel_grid.h"

namespace luxrig {

/// A place on one face of a triangle that represents some area around it.
struct SurfacePiece {
  Vec3 position_world_m;
  Vec3f normal_world;
  float area_m2;
  std::uint32_t triangle;
  std::uint32_t side;
};

/// A side is the surface within one cell that faces about the same way (one of 54 equal parts of a cube around the
/// normals) and sees itself. Two places belong together if nothing is between them just above the surface. Both faces
/// of each triangle are cut. Groups are the same with larger cells, made of whole sides.
class SurfaceSides {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;

  /// cells          grid in the scene's frame; surfaces outside belong to the nearest cells
  /// group_cells    cells per group cell, per axis
  SurfaceSides(const Scene& scene, const RayScene& rays, const VoxelGrid& cells, int group_cells, int threads);

  [[nodiscard]] std::size_t sides() const { return area_of_side_m2_.size(); }
  [[nodiscard]] std::size_t groups() const { return area_of_group_m2_.size(); }
  [[nodiscard]] double area_of_side_m2(std::size_t side) const { return area_of_side_m2_[side]; }
  [[nodiscard]] double area_of_group_m2(std::size_t group) const { return area_of_group_m2_[group]; }
  [[nodiscard]] std::uint32_t group_of_side(std::size_t side) const { return group_of_side_[side]; }

  /// All pieces, ordered by side; together they have exactly the area of each side.
  [[nodiscard]] std::span<const SurfacePiece> pieces() const { return pieces_; }
  [[nodiscard]] std::span<const SurfacePiece> pieces_of_side(std::size_t side) const {
    return std::span(pieces_).subspan(first_piece_[side], first_piece_[side + 1] - first_piece_[side]);
  }

  /// The side of a place; kNone if no surface nearby faces that way. `rays` counts the rays that distinguish sides
  /// within one cell.
  [[nodiscard]] std::uint32_t side_at(const Vec3& position_world_m, const Vec3& normal_world,
                                      std::uint64_t& rays) const;

  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Slot {
    std::uint32_t cell;
    std::uint32_t facing;
    bool plain = false;  ///< all surfaces of the cell lie in one plane: its places always see each other
    std::uint32_t first_place, end_place;  ///< into side_of_place_; while sides are being made, into pieces_
  };
  [[nodiscard]] bool sees(const Vec3& a_world_m, const Vec3& normal_a, const Vec3& b_world_m, const Vec3& normal_b,
                          double lift_m) const;
  [[nodiscard]] std::span<const Slot> slots_of_cell(std::uint32_t cell) const;
  /// The side with the nearest place that a place sees, and its distance; none if it sees no side of the slot.
  struct Found {
    std::uint32_t side = kNone;
    double distance_squared_m2 = HUGE_VAL;
  };
  void look_in(const Slot& slot, const Vec3& position_world_m, const Vec3& normal_world, std::uint64_t& rays,
               Found& seen, Found& nearest) const;
  void cut_up(const Scene& scene, int threads);
  void make_sides(int threads);
  void join_small_sides(int threads);
  void index_pieces();  ///< first_piece_ and area_of_side_m2_ from pieces_, which are ordered by side
  [[nodiscard]] Eigen::Vector3i voxel_of(std::uint32_t cell) const;
  void make_groups(int group_cells, int threads);

  const RayScene& rays_;
  Vec3 origin_world_m_;
  VoxelGrid cells_;
  std::vector<SurfacePiece> pieces_;
  std::vector<std::uint32_t> side_of_place_;  ///< per place in slots, after small ones were joined
  std::vector<std::uint32_t> first_piece_;    ///< per side, and one more
  std::vector<double> area_of_side_m2_, area_of_group_m2_;
  std::vector<std::uint32_t> group_of_side_;
  std::vector<Slot> slots_;                ///< ordered by cell and facing
  std::vector<std::uint32_t> first_slot_;  ///< per cell, and one more
};

/// The part of a cube, out of 54, that a direction passes through: nine per face, the middle one around the axis.
[[nodiscard]] std::uint32_t facing_of(const Vec3& normal);

}  // namespace luxrig
