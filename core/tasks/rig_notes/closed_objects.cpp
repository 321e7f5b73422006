#include "core/tasks/rig_notes/closed_objects.h"

#include <array>

namespace luxrig {
namespace {

/// Oblique directions: along no edge of anything built straight.
const std::array<Vec3, 5> kDirections = {Vec3(0.31, 0.47, 0.83).normalized(), Vec3(-0.53, 0.29, 0.79).normalized(),
                                         Vec3(0.23, -0.71, -0.67).normalized(), Vec3(-0.43, -0.37, 0.82).normalized(),
                                         Vec3(0.61, 0.59, -0.53).normalized()};
constexpr int kEnough = 4;
constexpr int kMaxCrossings = 1000;
/// An object with this share of the scene's volume may be the room itself.
constexpr double kRoomShare = 0.5;

}  // namespace

ClosedObjects::ClosedObjects(const Scene& scene, const RayScene& rays)
    : scene_(scene), rays_(rays), bounds_(scene.object_names.size()), room_m3_(rays.bounds_world_m().volume()) {
  for (std::size_t t = 0; t < scene.triangles.size(); ++t)
    for (const std::uint32_t vertex : scene.triangles[t])
      bounds_[scene.object_of_triangle[t]].extend(scene.vertex_world_m(vertex));
}

std::vector<bool> ClosedObjects::crossed_oddly(const Vec3& from_world_m, const Vec3& direction_world) const {
  std::vector<bool> odd(bounds_.size(), false);
  Vec3 from_m = from_world_m, leaving = Vec3::Zero();
  for (int crossings = 0; crossings < kMaxCrossings; ++crossings) {
    const auto hit = rays_.nearest(from_m, direction_world, leaving);
    if (!hit) break;
    const std::uint32_t object = scene_.object_of_triangle[hit->triangle];
    odd[object] = !odd[object];
    from_m = hit->position_world_m;
    leaving = -hit->normal_world;
  }
  return odd;
}

std::optional<std::uint32_t> ClosedObjects::around(const Vec3& position_world_m) const {
  std::vector<std::uint32_t> candidates;
  for (std::uint32_t object = 1; object < bounds_.size(); ++object)
    if (bounds_[object].contains(position_world_m) && bounds_[object].volume() < kRoomShare * room_m3_)
      candidates.push_back(object);
  if (candidates.empty()) return std::nullopt;
  std::vector<int> votes(bounds_.size(), 0);
  for (const Vec3& direction : kDirections) {
    const std::vector<bool> odd = crossed_oddly(position_world_m, direction);
    for (const std::uint32_t object : candidates) votes[object] += odd[object] ? 1 : 0;
  }
  for (const std::uint32_t object : candidates)
    if (votes[object] >= kEnough) return object;
  return std::nullopt;
}

}  // namespace luxrig
