#include "tools/luxrig/room_view.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/tasks/rig_transport.h"
#include "core/transport/sobol.h"

namespace luxrig {
namespace {

constexpr std::uint32_t kRaysPerLamp = 32;
constexpr std::size_t kMaxLampsAsked = 256;

/// Places where the lamps' light falls first.
std::vector<Receiver> lit_places(const RayScene& scene, const std::vector<Emitter>& lamps) {
  std::vector<Receiver> places;
  const SobolSequence samples(mixed(1, 0x711e));
  for (std::size_t e = 0; e < std::min(lamps.size(), kMaxLampsAsked); ++e)
    for (std::uint32_t i = 0; i < kRaysPerLamp; ++i) {
      const auto [u, v] = samples.pair(i, 0, 0);
      const DirectionSample drawn = lamps[e].intensity->sample(u, v);
      if (!(drawn.density_per_sr > 0)) continue;
      const Pose& pose = lamps[e].world_from_lamp;
      if (const auto hit = scene.nearest(pose.translation_m, pose.rotation * drawn.direction, Vec3::Zero()))
        places.push_back({hit->position_world_m, hit->normal_world});
    }
  return places;
}

/// Open places below a grid at half the scene's height.
std::vector<Receiver> floor_places(const RayScene& scene) {
  std::vector<Receiver> places;
  constexpr int kGrid = 12;
  const Eigen::AlignedBox3d box = scene.bounds_world_m();
  for (int j = 0; j < kGrid && !box.isEmpty(); ++j)
    for (int i = 0; i < kGrid; ++i) {
      const Vec3 share((i + 0.5) / kGrid, (j + 0.5) / kGrid, 0.5);
      if (const auto hit = scene.nearest(box.min() + share.cwiseProduct(box.sizes()), -Vec3::UnitZ(), Vec3::Zero()))
        places.push_back({hit->position_world_m, hit->normal_world});
    }
  return places;
}

/// Share of `wanted` in the picture with nothing in front. A place nearer than 0.3 m does not count; one seen from
/// behind counts as 0.3.
double seen_share(const RayScene& scene, const Camera& camera, const std::vector<Receiver>& wanted) {
  const Vec3 ahead = (camera.target_world_m - camera.eye_world_m).normalized();
  const double half_fov_rad = camera.vertical_fov_rad / 2;
  double seen = 0;
  for (const Receiver& wish : wanted) {
    const Vec3 to_m = wish.position_world_m - camera.eye_world_m;
    if (to_m.norm() < 0.3 || to_m.normalized().dot(ahead) < std::cos(1.2 * half_fov_rad)) continue;
    if (scene.occluded(wish.position_world_m, wish.normal_world, camera.eye_world_m)) continue;
    seen += wish.normal_world.dot(to_m) < 0 ? 1.0 : 0.3;  // its lit side faces the camera
  }
  return wanted.empty() ? 0 : seen / static_cast<double>(wanted.size());
}

/// Mean visible distance over a coarse grid of the picture, bounded: a view of a near wall shows nothing.
double openness(const RayScene& scene, const Camera& camera, double far_m) {
  double sum = 0;
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < 8; ++i) {
      const auto hit = scene.nearest(
          camera.eye_world_m, ray_direction(camera, (i + 0.5) * camera.width_px / 8, (j + 0.5) * camera.height_px / 6),
          Vec3::Zero());
      if (hit) sum += std::min(hit->distance_m / far_m, 1.0) / 48;
    }
  return sum;
}

}  // namespace

Camera automatic_camera(const RayScene& scene, const Rig& rig, std::span<const Joints> joints, int width_px,
                        int height_px, double vertical_fov_rad) {
  std::vector<Receiver> wanted;
  for (const Point& point : rig.points) wanted.push_back({point.position_world_m, point.normal_world});
  Eigen::AlignedBox3d room = scene.bounds_world_m();
  if (wanted.empty()) {
    const std::vector<Emitter> lamps = emitters_of(rig, joints);
    wanted = lit_places(scene, lamps);
    if (!wanted.empty()) {
      // Ground that goes on for a kilometre, and things behind the walls, are not the room.
      Eigen::AlignedBox3d lit;
      for (const Receiver& wish : wanted) lit.extend(wish.position_world_m);
      for (const Emitter& lamp : lamps) lit.extend(lamp.world_from_lamp.translation_m);
      const Vec3 around_m = 0.25 * lit.sizes();
      room = room.intersection(Eigen::AlignedBox3d(lit.min() - around_m, lit.max() + around_m));
    } else {
      wanted = floor_places(scene);
    }
  }
  for (const Receiver& wish : wanted) room.extend(wish.position_world_m);
  if (room.isEmpty()) room = Eigen::AlignedBox3d(Vec3::Constant(-1), Vec3::Constant(1));
  Vec3 centre_m = room.center();
  if (!wanted.empty()) {
    centre_m.setZero();
    for (const Receiver& wish : wanted) centre_m += wish.position_world_m / static_cast<double>(wanted.size());
  }
  const double far_m = std::max(room.diagonal().norm() / 2, 1e-6);
  Camera best;
  double best_score = -1;
  for (const double high : {0.55, 0.75})
    for (const double out : {0.35, 0.45})
      for (int side = 0; side < 8; ++side) {
        const double angle_rad = kPi / 4 * side;
        // On the rim of the room's rectangle, seen from its middle.
        const Vec3 rim(std::clamp(1.5 * std::cos(angle_rad), -1.0, 1.0),
                       std::clamp(1.5 * std::sin(angle_rad), -1.0, 1.0), 0);
        Camera camera;
        camera.eye_world_m = room.center() + out * rim.cwiseProduct(room.sizes());
        camera.eye_world_m.z() = room.min().z() + high * room.sizes().z();
        camera.target_world_m = centre_m;
        camera.vertical_fov_rad = vertical_fov_rad;
        camera.width_px = width_px;
        camera.height_px = height_px;
        if ((camera.target_world_m - camera.eye_world_m).norm() < 1e-6 * far_m) continue;
        const double score = seen_share(scene, camera, wanted) + 0.5 * openness(scene, camera, far_m);
        if (score > best_score) {
          best_score = score;
          best = camera;
        }
      }
  return best;
}

}  // namespace luxrig
