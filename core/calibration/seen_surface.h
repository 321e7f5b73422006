#pragma once
/// What each pixel of a camera sees: a piece of surface, with its place, its size and its paint.

#include <cstddef>
#include <vector>

#include "core/picture/picture.h"
#include "core/scene/ray_scene.h"

namespace luxrig {

struct SurfacePixel {
  Vec3f position_m = Vec3f::Zero();  ///< off the camera's eye
  Vec3f normal = Vec3f::Zero();      ///< towards the camera; zero = no surface, or one that shows no light: see below
  float area_m2 = 0;                 ///< of the surface that the pixel sees
  float reflectance = 0;             ///< luminous, as stated
  std::uint32_t material = 0;        ///< of the scene
  std::uint32_t plane = 0;           ///< pixels of one number touch, and lie on one plane and one material

  [[nodiscard]] bool seen() const { return area_m2 > 0; }
};

/// Rows from the top, pixels from the left.
struct SeenSurface {
  Camera camera;
  std::vector<SurfacePixel> pixels;
  std::vector<std::size_t> plane_pixels;  ///< how many each plane has

  [[nodiscard]] const SurfacePixel& at(int x_px, int y_px) const {
    return pixels[static_cast<std::size_t>(y_px) * static_cast<std::size_t>(camera.width_px) +
                  static_cast<std::size_t>(x_px)];
  }
  /// Of a wall or a floor, whose place is surer than that of a thing that stands there.
  [[nodiscard]] bool is_large(std::uint32_t plane) const { return 25 * plane_pixels[plane] > pixels.size(); }
  [[nodiscard]] Vec3 position_world_m(const SurfacePixel& pixel) const {
    return camera.eye_world_m + pixel.position_m.cast<double>();
  }
};

/// Dark, glossy and aslant surfaces are left out: they show mirror images, noise and streaks rather than light.
[[nodiscard]] SeenSurface seen_surface(const RayScene& rays, const Camera& camera, int threads = 0);

}  // namespace luxrig
