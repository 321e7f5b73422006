#pragma once
/// A Scene made ready for rays (Embree behind a wall).

#include <memory>
#include <optional>

#include "core/scene/scene.h"

namespace luxrig {

struct Hit {
  double distance_m;
  std::uint32_t triangle;
  Vec3 position_world_m;
  Vec3 normal_world;  ///< unit geometric normal, turned towards where the ray came from
};

/// Immutable after construction; every query may be called from many threads at once.
class RayScene {
 public:
  explicit RayScene(const Scene& scene);  ///< keeps what it needs; the Scene may go
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  /// Nearest hit along a ray, or nothing. direction_world need be unit (asserted to 1e-6).
  /// `leaving_normal_world` = normal of the surface the ray starts on (zero vector if none): the start
  /// is moved off the surface by a distance derived from the rounding of float coordinates.
  [[nodiscard]] std::optional<Hit> nearest(const Vec3& from_world_m, const Vec3& direction_world,
                                           const Vec3& leaving_normal_world) const;

  /// True if anything stands on the open segment between a surface point (with its normal, which may be
  /// zero) and another point.
  [[nodiscard]] bool occluded(const Vec3& from_world_m, const Vec3& from_normal_world, const Vec3& to_world_m) const;

  /// Luminous reflectance and colour of a triangle's material.
  [[nodiscard]] const Material& material_of(std::uint32_t triangle) const;

  /// Bounding box in world coordinates; empty box when there are no triangles.
  [[nodiscard]] Eigen::AlignedBox3d bounds_world_m() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace luxrig
