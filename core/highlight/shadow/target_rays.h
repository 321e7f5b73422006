#pragma once
/// Tests whether the target itself blocks many directions from one of its points.

#include <array>
#include <memory>
#include <span>

#include "core/scene/scene.h"

namespace luxrig {

/// Rays against the target alone, sixteen at once and without a filter at hits: about 1.5 times as fast as core/scene's
/// RayScene, which handles rays that end on a surface; these end nowhere, or at a light. Immutable and thread-safe.
class TargetRays {
 public:
  /// Vertices must be finite and indices within them (asserted). The Scene need not outlive it and may have no
  /// triangles.
  explicit TargetRays(const Scene& target);
  ~TargetRays();
  TargetRays(TargetRays&&) noexcept;
  TargetRays& operator=(TargetRays&&) noexcept;

  /// blocked   one per direction: 1 if the target is in the way, at any distance
  /// The start is lifted off the surface along its normal (unit) by 2^-18.5 of the bounding box's diagonal, which
  /// covers float rounding (4 u |p| + 16 u L of ray_scene.h with |p|, L ≤ the diagonal), plus lift_m.
  /// directions_world   need not be unit
  void blocked(const Vec3& from_world_m, const Vec3& normal_world, double lift_m,
               std::span<const Vec3f> directions_world, std::span<std::uint8_t> blocked) const;

  /// The same for rays that end at places: nothing blocks behind a place, or nearer to it than the lift.
  void blocked_before(const Vec3& from_world_m, const Vec3& normal_world, double lift_m,
                      std::span<const Vec3> to_world_m, std::span<std::uint8_t> blocked) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace luxrig
