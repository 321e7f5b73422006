#pragma once
/// Finds the closed object that a place is in. Private to rig_notes.

#include <optional>

#include "core/scene/ray_scene.h"
#include "core/scene/scene.h"

namespace luxrig {

/// The object of the rig file around a place: rays from the place leave it an odd number of times, in nearly every
/// direction. Never the scene's own mesh, nor an object as large as a room. Index into Scene::object_names.
class ClosedObjects {
 public:
  ClosedObjects(const Scene& scene, const RayScene& rays);
  [[nodiscard]] std::optional<std::uint32_t> around(const Vec3& position_world_m) const;

 private:
  /// Per object: the ray crosses its surface an odd number of times.
  [[nodiscard]] std::vector<bool> crossed_oddly(const Vec3& from_world_m, const Vec3& direction_world) const;

  const Scene& scene_;
  const RayScene& rays_;
  std::vector<Eigen::AlignedBox3d> bounds_;  ///< per object
  double room_m3_ = 0;
};

}  // namespace luxrig
