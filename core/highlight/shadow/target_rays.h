#pragma once
/// "Does the target itself stand in the way?", for many directions from one of its points.

#include <array>
#include <memory>
#include <span>

#include "core/scene/scene.h"

namespace luxrig {

/// The target alone, sixteen rays at once with nothing to ask at a hit: about 1.5 times as fast as core/scene's
/// RayScene, which takes care of rays that end on a surface; these end nowhere, or at a light. Immutable; may be asked
/// from many threads.
class TargetRays {
 public:
  /// Vertices must be finite and indices within them (asserted); the Scene may go. None of its triangles is fine, too.
  explicit TargetRays(const Scene& target);
  ~TargetRays();
  TargetRays(TargetRays&&) noexcept;
  TargetRays& operator=(TargetRays&&) noexcept;

  /// blocked   one per direction: 1 if the target stands in the way, however far off
  /// The start is lifted off the surface along its normal (unit) by 2^-18.5 of the bounding box's diagonal, which
  /// covers the rounding of float (4 u |p| + 16 u L of ray_scene.h with |p|, L ≤ the diagonal), and by lift_m more.
  /// directions_world   need not be unit
  void blocked(const Vec3& from_world_m, const Vec3& normal_world, double lift_m,
               std::span<const Vec3f> directions_world, std::span<std::uint8_t> blocked) const;

  /// The same for rays that end at places: what stands behind these does not block, nor what is nearer to them than
  /// the lift.
  void blocked_before(const Vec3& from_world_m, const Vec3& normal_world, double lift_m,
                      std::span<const Vec3> to_world_m, std::span<std::uint8_t> blocked) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace luxrig
