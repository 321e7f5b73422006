#pragma once
/// Shared by the tests of cameras: a room with boxes, and a camera in it.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "core/picture/picture.h"
#include "core/scene/ray_scene.h"
#include "core/scene/scene.h"

namespace luxrig::box_room {

/// A box, seen from within or without; each its own material.
inline void add_box(Scene& scene, const Vec3& from_m, const Vec3& to_m, double reflectance) {
  const auto first = static_cast<std::uint32_t>(scene.vertices_m.size());
  for (int corner = 0; corner < 8; ++corner)
    scene.vertices_m.push_back(Vec3((corner & 1) ? to_m.x() : from_m.x(), (corner & 2) ? to_m.y() : from_m.y(),
                                    (corner & 4) ? to_m.z() : from_m.z())
                                   .cast<float>());
  constexpr std::uint32_t kFaces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                          {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  Material paint;
  paint.reflectance_rgb = Vec3::Constant(reflectance);
  scene.materials.push_back(paint);
  for (const auto& face : kFaces)
    for (const int half : {1, 2}) {
      scene.triangles.push_back({first + face[0], first + face[half], first + face[half + 1]});
      scene.material_of_triangle.push_back(static_cast<std::uint32_t>(scene.materials.size() - 1));
      scene.object_of_triangle.push_back(0);
    }
}

inline Scene room_with_boxes() {
  Scene scene;
  scene.object_names = {"scene"};
  add_box(scene, {-4, -3, 0}, {4, 3, 3}, 0.6);
  add_box(scene, {-3, 2.94, 1}, {-1.8, 3, 2}, 0.25);
  add_box(scene, {0.2, 2.94, 0.8}, {1.6, 3, 1.9}, 0.35);
  add_box(scene, {2.5, 0.5, 0}, {3, 1.0, 1.1}, 0.8);
  add_box(scene, {-1.5, 0.2, 0}, {-1, 0.7, 1.0}, 0.3);
  add_box(scene, {0.6, -0.6, 0}, {1.1, -0.1, 0.7}, 0.7);
  return scene;
}

inline Camera stated_camera() {
  Camera camera;
  camera.eye_world_m = {-0.5, -2.6, 1.9};
  camera.target_world_m = {0.2, 2, 1.0};
  camera.vertical_fov_rad = 1.0;
  camera.width_px = 320;
  camera.height_px = 200;
  return camera;
}

/// Light from the middle of the ceiling, as cosine and square of distance have it, and some from everywhere. What falls
/// on a pixel is the mean over it; `noise`: of its logarithm.
inline Picture seen_by(const RayScene& rays, const Camera& camera, double noise, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const Vec3 lamp_m(0.3, -0.5, 2.9);
  Picture picture;
  picture.width_px = camera.width_px;
  picture.height_px = camera.height_px;
  constexpr int kAcross = 3;
  for (int y = 0; y < camera.height_px; ++y)
    for (int x = 0; x < camera.width_px; ++x) {
      double light = 0;
      for (int k = 0; k < kAcross * kAcross; ++k) {
        const double x_px = x + (k % kAcross + 0.5) / kAcross, y_px = y + (k / kAcross + 0.5) / kAcross;
        const auto hit = rays.nearest(camera.eye_world_m, ray_direction(camera, x_px, y_px), Vec3::Zero());
        if (!hit) continue;
        const Vec3 to_lamp_m = lamp_m - hit->position_world_m;
        const double cosine = std::max(0.0, hit->normal_world.dot(to_lamp_m.normalized()));
        light += rays.material_of(hit->triangle).luminous_reflectance() * (0.2 + cosine / to_lamp_m.squaredNorm());
      }
      picture.luminance_cd_m2.push_back(Vec3f::Constant(static_cast<float>(light * std::exp(noise * normal(random)))));
    }
  return picture;
}

}  // namespace luxrig::box_room
