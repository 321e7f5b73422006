#pragma once
/// What a picture shows of an object, measured in its pixels: shares no code with core/highlight/seen, which it judges.

#include <span>

#include "core/highlight/shadow/shadow_edges.h"
#include "core/picture/picture.h"
#include "core/scene/ray_scene.h"

namespace luxrig {

struct PictureReading {
  double contrast = 0;  ///< standard deviation of L* / 100 in a window around each relief point in sight, mean
  double lit = 0;       ///< share of these points with at least a quarter of the object's mean luminance
  double clipped = 0;   ///< share of the object's pixels above white or below 1 % of it
};

/// Exposed so that the object's mean luminance is 18 % of white, clipped, as CIE 1976 lightness.
/// relief    points of the object; window_m: half the window's side
[[nodiscard]] PictureReading read_picture(const Picture& picture, const Camera& camera, const RayScene& room,
                                          const RayScene& object, std::span<const OrientedPoint> relief,
                                          double window_m);

}  // namespace luxrig
