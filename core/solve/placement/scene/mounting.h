#pragma once
/// Where a luminaire may hang in a scene: `[mounting]` of the rig file, prepared for many queries.
///
/// A luminaire may hang at a place
///   within the box, or within the scene's bounds if there is no box;
///   with surfaces: within the offsets of the nearest of them, and at least `clearance_m` from all others;
///   without surfaces: at least `clearance_m` from everything.
/// Distances are from the luminaire's centre. The side of a wall is not checked: behind closed surfaces a light reaches
/// no point, and candidates there cost nothing (core/transport/candidates/air_regions.h).

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "core/result.h"
#include "core/rig/brief.h"
#include "core/scene/ray_scene.h"
#include "core/scene/scene.h"

namespace luxrig {

class Mounting {
 public:
  static constexpr std::size_t kMaxPlaces = 1'000'000;

  /// scene, rays   the same geometry; `rays` must outlive it
  /// rig_file      for problems: a pattern that matches no material or object, or nothing that bounds the places
  [[nodiscard]] static Checked<Mounting> make(const MountingSpec& spec, const std::filesystem::path& rig_file,
                                              const Scene& scene, const RayScene& rays);

  [[nodiscard]] bool may_hang(const Vec3& place_world_m) const;

  struct Snapped {
    Vec3 place_world_m;
    /// d place / d wanted: the identity within the mounting; otherwise without the directions fixed by box or offsets.
    Mat3 per_wanted;
  };
  /// The allowed place nearest to a wanted one, within box and offsets; empty when something else is too near there.
  /// Returns an allowed place unchanged, to the last bit.
  [[nodiscard]] std::optional<Snapped> snapped(const Vec3& wanted_world_m) const;

  /// Places to try, evenly spaced: a lattice in the box, or one laid on each surface and lifted off both of its sides.
  /// A light may hang at all of them. The result does not depend on threads.
  /// Cause::invalid, with the figures, when the spacing gives more than kMaxPlaces, or no place is left.
  [[nodiscard]] Result<std::vector<Vec3>> candidates(int threads) const;

  /// Between neighbouring candidates.
  [[nodiscard]] double spacing_m() const { return spec_.spacing_m.value_or(default_spacing_m()); }
  [[nodiscard]] const Eigen::AlignedBox3d& box_world_m() const { return box_world_m_; }
  /// One flag per triangle of the scene: 1 where lights hang off it. Empty = anywhere in the air.
  [[nodiscard]] const std::vector<std::uint8_t>& is_surface() const { return is_surface_; }

 private:
  Mounting() = default;
  [[nodiscard]] bool clear_of_others(const Vec3& place_world_m) const;
  [[nodiscard]] double default_spacing_m() const;
  [[nodiscard]] double places_at(double spacing_m) const;
  [[nodiscard]] std::vector<Vec3> places_in_air(double spacing_m) const;
  [[nodiscard]] std::vector<Vec3> places_off_surfaces(double spacing_m) const;

  using Triangle = std::array<Vec3, 3>;

  MountingSpec spec_;
  const RayScene* rays_ = nullptr;
  Eigen::AlignedBox3d box_world_m_;
  std::vector<std::uint8_t> is_surface_, is_other_;  ///< per triangle; empty without surfaces
  std::vector<Triangle> surfaces_world_m_;
};

}  // namespace luxrig
