#pragma once
/// An empty room, a camera in its corner, and pictures of a Gaussian beam in it, without noise.

#include <array>
#include <cmath>
#include <optional>

#include "core/calibration/head_pose.h"
#include "core/calibration/seen_surface.h"
#include "core/scene/ray_scene.h"

namespace luxrig {

struct BeamRoom {
  static inline const Vec3 kSize_m{8, 7, 3.5};
  static constexpr double kReflectance = 0.5;
  double width_rad = rad_from_deg(4);  ///< standard deviation of the beam

  Scene scene = walls();
  RayScene rays{scene};
  Camera camera = in_corner();
  SeenSurface surface = seen_surface(rays, camera, 1);

  static Scene walls() {
    Scene scene;
    scene.materials.resize(1);
    scene.materials[0].reflectance_rgb.setConstant(kReflectance);
    scene.object_names = {"scene"};
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) {
        const auto first = static_cast<std::uint32_t>(scene.vertices_m.size());
        for (const auto& [a, b] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)}) {
          Vec3 corner_m;
          corner_m[axis] = side * kSize_m[axis];
          corner_m[(axis + 1) % 3] = a * kSize_m[(axis + 1) % 3];
          corner_m[(axis + 2) % 3] = b * kSize_m[(axis + 2) % 3];
          scene.vertices_m.push_back(corner_m.cast<float>());
        }
        scene.triangles.push_back({first, first + 1, first + 2});
        scene.triangles.push_back({first, first + 2, first + 3});
      }
    scene.material_of_triangle.assign(scene.triangles.size(), 0);
    scene.object_of_triangle.assign(scene.triangles.size(), 0);
    return scene;
  }
  static Camera in_corner() {
    Camera camera;
    camera.eye_world_m = Vec3(0.3, 0.3, 2.9);
    camera.target_world_m = Vec3(5, 4.5, 0.6);
    camera.vertical_fov_rad = rad_from_deg(60);
    camera.width_px = 320;
    camera.height_px = 200;
    return camera;
  }

  [[nodiscard]] Picture dark(double lux = 20) const {
    Picture picture;
    picture.width_px = camera.width_px;
    picture.height_px = camera.height_px;
    picture.luminance_cd_m2.assign(surface.pixels.size(),
                                   Vec3f::Constant(static_cast<float>(lux * kReflectance / kPi)));
    return picture;
  }
  void add_beam(Picture& picture, const Vec3& from_m, const Vec3& beam, double peak_cd = 2e4) const {
    for (std::size_t i = 0; i < surface.pixels.size(); ++i) {
      if (!surface.pixels[i].seen()) continue;
      const Vec3 to_m = surface.position_world_m(surface.pixels[i]) - from_m;
      const double angle_rad = std::atan2(to_m.cross(beam).norm(), to_m.dot(beam));
      const double cosine = std::max(0.0, -to_m.normalized().dot(surface.pixels[i].normal.cast<double>()));
      const double lux = peak_cd * std::exp(-0.5 * std::pow(angle_rad / width_rad, 2)) * cosine / to_m.squaredNorm();
      picture.luminance_cd_m2[i] += Vec3f::Constant(static_cast<float>(lux * kReflectance / kPi));
    }
  }
  [[nodiscard]] Picture lit(const Vec3& from_m, const Vec3& beam) const {
    Picture picture = dark();
    add_beam(picture, from_m, beam);
    return picture;
  }
};

}  // namespace luxrig
