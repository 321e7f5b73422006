#pragma once
/// Surfaces in small patches, on which light is painted, and which of them belong together.
/// Source: thesis §5.3, where a cell keeps one of several surfaces of similar orientation. Here each side of a triangle
/// counts, however it is wound, and a patch stands for all surfaces of its cell that face its way.

#include <optional>
#include <span>

#include "core/goals/cell_grid.h"
#include "core/result.h"
#include "core/scene/ray_scene.h"

namespace luxrig {

/// Surfaces of one cell whose normals differ by less are one patch.
inline constexpr double kOnePatch_rad = rad_from_deg(85);
/// Patches side by side whose normals differ by less belong together, if nothing stands between them.
inline constexpr double kOneGroup_rad = rad_from_deg(35);

/// One side of the surfaces in a cell. Where they lie behind one another, as the two faces of a thin wall do, its place
/// is on the front one.
struct SurfacePatch {
  Vec3f position_m;  ///< on a triangle, relative to origin_world_m
  Vec3f normal;      ///< unit, on the side that the patch is seen from
  float area_m2;     ///< of all surfaces that it stands for
};

/// A place on a surface, seen from one side.
struct SurfacePlace {
  Vec3 position_world_m = Vec3::Zero();
  Vec3 normal_world = Vec3::UnitZ();  ///< unit
  bool operator==(const SurfacePlace&) const = default;
};

/// Patches side by side that belong together.
struct PatchLink {
  std::uint32_t patch;
  std::uint32_t length;  ///< between their places, in kLengthsPerCell-ths of a cell; at least 1
};
inline constexpr double kLengthsPerCell = 32;

/// The patches of a scene. Their order, and everything else here, does not depend on the order of its triangles.
struct SurfacePatches {
  CellGrid grid;
  Vec3 origin_world_m = Vec3::Zero();
  std::vector<SurfacePatch> patches;  ///< by cell, then the largest first

  std::vector<CellKey> cells;                ///< rising; only those that surfaces meet
  std::vector<std::uint32_t> first_of_cell;  ///< cells + 1: patches [first_of_cell[c], first_of_cell[c + 1])
  std::vector<std::uint32_t> cell_of_patch;
  CellIndex cell_index;

  std::vector<std::uint32_t> first_link;  ///< patches + 1
  std::vector<PatchLink> links;           ///< both ways

  /// A group is a set of patches that links join: its number is that of its first patch among all groups.
  std::vector<std::uint32_t> group_of_patch;
  std::vector<std::uint32_t> first_of_group;    ///< groups + 1
  std::vector<std::uint32_t> patches_by_group;  ///< rising within a group

  [[nodiscard]] std::size_t size() const { return patches.size(); }
  [[nodiscard]] std::size_t groups() const { return first_of_group.empty() ? 0 : first_of_group.size() - 1; }
  [[nodiscard]] Vec3 position_world_m(std::uint32_t patch) const {
    return origin_world_m + patches[patch].position_m.cast<double>();
  }
  [[nodiscard]] std::span<const PatchLink> links_of(std::uint32_t patch) const {
    return {links.data() + first_link[patch], links.data() + first_link[patch + 1]};
  }
  [[nodiscard]] std::span<const std::uint32_t> patches_of_group(std::uint32_t group) const {
    return {patches_by_group.data() + first_of_group[group], patches_by_group.data() + first_of_group[group + 1]};
  }
};

struct PatchOptions {
  double cell_m = 0.1;  ///< edge of a cell, hence about that of a patch
  int threads = 0;      ///< 0 = one per core; results do not depend on it
};

/// Cuts the surfaces of a scene at the boundaries of cells, and finds groups. Time and memory are linear in the number
/// of triangles and of the pieces that they are cut into.
/// rays   of the same scene
/// Refuses (Cause::invalid) a cell that is not above 0, and one so small that there would be over 50 million pieces or
/// 2 million cells along an axis; says which size would do. Triangles without area, or that are not finite, have no
/// patch.
[[nodiscard]] Result<SurfacePatches> make_surface_patches(const Scene& scene, const RayScene& rays,
                                                          const PatchOptions& options);

/// The patch that a person means who points at a place: the nearest in its cell and those around that faces the same
/// way and is not hidden from there. None where no surface is near.
[[nodiscard]] std::optional<std::uint32_t> patch_at(const SurfacePatches& surface, const RayScene& rays,
                                                    const SurfacePlace& place);

}  // namespace luxrig
