#pragma once
/// What can be seen of an object from one place: a small picture of surface samples. Light reaches samples, not pixels,
/// so any number of lights is added up without another ray.

#include <span>
#include <vector>

#include "core/highlight/shadow/shadow_edges.h"
#include "core/result.h"
#include "core/run.h"
#include "core/scene/ray_scene.h"

namespace luxrig {

struct SeenViewOptions : Run {
  int across_px = 96;         ///< longer side of the picture; 16 … 1024
  bool surroundings = false;  ///< also what is around it: the object takes half of the picture
};

/// Rows from the top. A pixel sees the object, something behind it, or nothing.
struct SeenView {
  static constexpr std::uint32_t kNothing = ~0u;

  int width_px = 0, height_px = 0;
  std::vector<OrientedPoint> samples;  ///< one per pixel: of the object, then of what borders on it or is around it
  std::size_t object_samples = 0;      ///< number of the object's, which come first
  std::vector<float> reflectance;      ///< of each sample, luminous
  std::vector<std::uint32_t> sample_of_pixel;  ///< kNothing = no sample there
  [[nodiscard]] bool of_object(std::size_t pixel) const { return sample_of_pixel[pixel] < object_samples; }
};

/// The object as it fills the picture, seen past everything in the room. Samples beside it are kept where they border
/// on it, or, with `surroundings`, all over the picture.
/// room     everything, including the object; panes are seen through
/// object   the object alone (object_scene), in the same world
/// Refuses: an eye that is not finite or within 1 mm of the object's middle, an object without triangles, and an object
/// of which nothing is in sight from there.
[[nodiscard]] Result<SeenView> see_object(const RayScene& room, const RayScene& object, const Vec3& eye_world_m,
                                          const SeenViewOptions& options);

/// Places of a visitor's eyes: that of `eye`, and 40° to either side around the vertical through the object's middle.
[[nodiscard]] std::vector<Vec3> eyes_around(const RayScene& object, const Vec3& eye_world_m);

}  // namespace luxrig
