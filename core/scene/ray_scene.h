#pragma once
/// A Scene prepared for rays (hides Embree).
///
/// Rays run in float, relative to the scene's origin. A surface may be off its true place by
///   e(p) = 2^-24 · (4 |p|∞ + 16 L) + 2^-50 |origin|∞,   p = point relative to the origin, L = longest edge at p.
/// L is at most the scene's longest edge. It is also at most the larger of 1.6 |p|∞ and the longest edge among those
/// longer than half their distance from the origin (derived in ray_scene_state.h). e is 10 µm in a room of 10 m, 50 µm
/// in one on a plane of 20 km. So a ray that leaves a surface starts 2 e off it. A shadow ray stops 1 e short of its
/// target and passes triangles whose plane is within 2 e of it, since the target may be on them. Only obstacles nearer
/// than that to either end may be missed.

#include <array>
#include <memory>
#include <optional>
#include <span>

#include "core/scene/scene.h"
#include "core/scene/shaft.h"

namespace luxrig {

struct Hit {
  double distance_m;
  std::uint32_t triangle;
  Vec3 position_world_m;
  Vec3 normal_world;  ///< unit geometric normal, on the side that the ray came from
};

struct NearestSurface {
  double distance_m;
  std::uint32_t triangle;
  Vec3 position_world_m;  ///< on it
};

/// Immutable after construction; all queries may be called from many threads at once. No ray slips through a shared
/// edge. Of rays aimed exactly at a corner of three surfaces, about 1 in 10 000 slips through (Embree's rounding);
/// samples are never aimed so.
class RayScene {
 public:
  explicit RayScene(const Scene& scene);  ///< copies what it needs; the Scene may be destroyed
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  /// Nearest hit along a ray, or nullopt. direction_world must be unit (asserted to 1e-6).
  /// `leaving_normal_world` = normal of the surface on which the ray starts (zero vector = none). The start is moved
  /// off that surface along the normal. Another surface that meets it there in a corner still stops the ray, at
  /// distance 0.
  [[nodiscard]] std::optional<Hit> nearest(const Vec3& from_world_m, const Vec3& direction_world,
                                           const Vec3& leaving_normal_world) const;

  /// True if anything blocks the open segment between a surface point (with its normal, which may be zero) and another
  /// point, which may itself be on a surface (a lamp flush with the ceiling).
  [[nodiscard]] bool occluded(const Vec3& from_world_m, const Vec3& from_normal_world, const Vec3& to_world_m) const;

  /// occluded() for many targets from one place; faster if they are in similar directions.
  /// occluded   one per target: 1 or 0
  void occluded_many(const Vec3& from_world_m, const Vec3& from_normal_world, std::span<const Vec3> to_world_m,
                     std::span<std::uint8_t> occluded) const;

  /// Whether light may have to pass glass. Panes stop no ray of these queries.
  [[nodiscard]] bool has_panes() const;
  /// Share of light between two places that passes the panes between them; 1 = no pane. Panes within twice the surface
  /// error of an end do not count.
  [[nodiscard]] double transmittance(const Vec3& from_world_m, const Vec3& to_world_m) const;

  /// True only if no ray in the shaft can be stopped, so that none need be cast. Casts none; the first call builds a
  /// tree of boxes. Treats obstacles too near to a surface to resolve as occluded() does.
  [[nodiscard]] bool surely_clear(const Shaft& shaft) const;

  /// True only if no ray from a surface point to any place in the convex hull of `corners` gets through. Proven if all
  /// corners are seen through one triangle, or through two that share an edge. Adds the number of rays cast to `rays`,
  /// at most one per corner.
  [[nodiscard]] bool surely_blocked(const Vec3& from_world_m, const Vec3& from_normal_world,
                                    std::span<const Vec3> corners_world_m, std::uint64_t& rays) const;

  /// The nearest surface within a distance (which may be infinite), if any. Computed in double from the triangles as
  /// stored. of_triangles: one mark per triangle, and unmarked ones are ignored; empty = all.
  [[nodiscard]] std::optional<NearestSurface> nearest_surface(const Vec3& from_world_m, double within_m,
                                                              std::span<const std::uint8_t> of_triangles = {}) const;

  /// Luminous reflectance and colour of a triangle's material.
  [[nodiscard]] const Material& material_of(std::uint32_t triangle) const;

  /// All materials, and the index of a triangle's into them.
  [[nodiscard]] std::span<const Material> materials() const;
  [[nodiscard]] std::uint32_t material_index_of(std::uint32_t triangle) const;

  [[nodiscard]] std::size_t triangles() const;
  /// As stored: large faces are split.
  [[nodiscard]] std::array<Vec3, 3> corners_world_m(std::uint32_t triangle) const;

  /// Bounding box in world coordinates; empty without triangles.
  [[nodiscard]] Eigen::AlignedBox3d bounds_world_m() const;

  /// e(p) above [m]: the largest position error of a surface near a point.
  [[nodiscard]] double surface_error_m(const Vec3& point_world_m) const;

 private:
  struct State;
  struct NearestQuery;
  std::unique_ptr<State> state_;
};

}  // namespace luxrig
