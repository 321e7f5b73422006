#pragma once
/// A Scene made ready for rays (Embree behind a wall).
///
/// Rays run in float, relative to the scene's origin. A surface may be off its true place there by
///   e(p) = 2^-24 · (4 |p|∞ + 16 L) + 2^-50 |origin|∞,   p = point relative to the origin, L = longest edge at p:
/// no more than the scene's longest, nor than the larger of 1.6 |p|∞ and the longest edge among those that are longer
/// than half of their distance from the origin (derived in ray_scene_state.h; 10 µm in a room of 10 m, 50 µm in one on
/// a plane of 20 km). So a ray that leaves a surface starts 2 e off it. A shadow ray stops 1 e short of its target and
/// passes triangles whose plane is within 2 e of it, since the target may lie on them. What stands nearer than that to
/// either end may be missed; nothing else is.

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
  Vec3 normal_world;  ///< unit geometric normal, turned towards where the ray came from
};

struct NearestSurface {
  double distance_m;
  std::uint32_t triangle;
  Vec3 position_world_m;  ///< on it
};

/// Immutable after construction; every query may be called from many threads at once. No ray passes a shared edge, but
/// of rays that are aimed at a corner of three surfaces, which no sample is, about 1 in 10 000 does (Embree's
/// rounding).
class RayScene {
 public:
  explicit RayScene(const Scene& scene);  ///< keeps what it needs; the Scene may go
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  /// Nearest hit along a ray, or nothing. direction_world need be unit (asserted to 1e-6).
  /// `leaving_normal_world` = normal of the surface the ray starts on (zero vector if none): the start
  /// is moved off the surface, to the side that the normal shows. A surface that meets it there in a corner
  /// still stops the ray, at distance 0.
  [[nodiscard]] std::optional<Hit> nearest(const Vec3& from_world_m, const Vec3& direction_world,
                                           const Vec3& leaving_normal_world) const;

  /// True if anything stands on the open segment between a surface point (with its normal, which may be
  /// zero) and another point, which may itself lie on a surface (a lamp flush with the ceiling).
  [[nodiscard]] bool occluded(const Vec3& from_world_m, const Vec3& from_normal_world, const Vec3& to_world_m) const;

  /// occluded() for many targets from one place: faster where they lie in similar directions.
  /// occluded   one per target: 1 or 0
  void occluded_many(const Vec3& from_world_m, const Vec3& from_normal_world, std::span<const Vec3> to_world_m,
                     std::span<std::uint8_t> occluded) const;

  /// Whether light may have to pass glass. Panes stop no ray of the queries here.
  [[nodiscard]] bool has_panes() const;
  /// Share of the light between two places that the panes of glass in between let through; 1 without any. Those within
  /// twice the surface error of an end do not count.
  [[nodiscard]] double transmittance(const Vec3& from_world_m, const Vec3& to_world_m) const;

  /// True only if no ray within the shaft can be stopped: then none need be cast. Casts none itself; the first call
  /// builds a tree of boxes. Agrees with occluded() about what stands nearer to a surface than it can be told.
  [[nodiscard]] bool surely_clear(const Shaft& shaft) const;

  /// True only if no ray from a surface point to any place within the convex hull of `corners` gets through: proven
  /// when all corners are seen through one triangle, or through two that share an edge. Adds the rays cast, at most one
  /// per corner.
  [[nodiscard]] bool surely_blocked(const Vec3& from_world_m, const Vec3& from_normal_world,
                                    std::span<const Vec3> corners_world_m, std::uint64_t& rays) const;

  /// The surface nearest to a place, if there is one within so far (which may be infinite). Computed in double from
  /// the triangles as they are held. of_triangles: one mark per triangle, others count as if not there; empty: all.
  [[nodiscard]] std::optional<NearestSurface> nearest_surface(const Vec3& from_world_m, double within_m,
                                                              std::span<const std::uint8_t> of_triangles = {}) const;

  /// Luminous reflectance and colour of a triangle's material.
  [[nodiscard]] const Material& material_of(std::uint32_t triangle) const;

  /// All materials, and the index of a triangle's into them.
  [[nodiscard]] std::span<const Material> materials() const;
  [[nodiscard]] std::uint32_t material_index_of(std::uint32_t triangle) const;

  [[nodiscard]] std::size_t triangles() const;
  /// As they are held: faces that are large were split.
  [[nodiscard]] std::array<Vec3, 3> corners_world_m(std::uint32_t triangle) const;

  /// Bounding box in world coordinates; empty box when there are no triangles.
  [[nodiscard]] Eigen::AlignedBox3d bounds_world_m() const;

  /// e(p) above [m]: the largest error of a surface's place near a point.
  [[nodiscard]] double surface_error_m(const Vec3& point_world_m) const;

 private:
  struct State;
  struct NearestQuery;
  std::unique_ptr<State> state_;
};

}  // namespace luxrig
