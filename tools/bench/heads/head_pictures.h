#pragma once
/// Pictures of one head's beam: its direct light, its light by one diffuse reflection from where it falls, the light
/// that a mirror throws into the room and what is seen in it, the room's own light, and a sensor's noise. Cheap enough
/// for tens of thousands of them.

#include <cstdint>
#include <optional>
#include <vector>

#include "core/photometry/intensity.h"
#include "core/picture/picture.h"
#include "core/scene/ray_scene.h"

namespace luxrig {

class HeadPictures {
 public:
  /// camera_turn: how the true camera is turned off `camera`, in world. rays must outlive it.
  HeadPictures(const RayScene& rays, const Camera& camera, const Mat3& camera_turn, std::uint64_t seed);

  struct Beam {
    Pose world_from_lamp;
    const IntensityDistribution* intensity = nullptr;
  };
  /// Exposed for the brightest pixel, or for the dark room. Each picture has noise of its own.
  [[nodiscard]] Picture take(const std::optional<Beam>& beam);

 private:
  struct Seen {
    Vec3 position_m, normal;
    float reflectance = 0, share = 1;  ///< share: of its luminance that reaches the camera
  };
  struct Mirror {
    Vec3 corner_m, along_m, up_m, normal;  ///< a parallelogram, towards the room
  };
  [[nodiscard]] std::optional<Seen> seen_along(const Vec3& from_m, const Vec3& direction, float share) const;
  void find_mirror();
  [[nodiscard]] double direct_lx(const Seen& at, const Beam& beam) const;
  [[nodiscard]] double by_mirror_lx(const Seen& at, const Beam& beam) const;

  const RayScene& rays_;
  int width_px_, height_px_;
  std::vector<std::optional<Seen>> seen_;
  std::vector<Mirror> mirrors_;
  std::vector<float> noise_;  ///< standard normal; each picture starts somewhere else
  std::uint64_t taken_;
};

}  // namespace luxrig
