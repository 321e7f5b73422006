#pragma once
/// How much of an object's relief a camera sees: local contrast of a picture, independent of exposure.

#include <span>

#include "core/highlight/shadow/shadow_edges.h"
#include "core/picture/picture.h"
#include "core/scene/ray_scene.h"

namespace luxrig {

struct PictureContrast {
  std::size_t seen = 0;       ///< points in the picture, unobstructed, that face the camera
  double local_contrast = 0;  ///< mean over these
  double mean_cd_m2 = 0;      ///< mean luminance there
};

/// Position of a point in the camera's picture; empty if it is outside, turned away or hidden.
[[nodiscard]] std::optional<PixelPlace> seen_place(const Camera& camera, const RayScene& scene,
                                                   const OrientedPoint& point);

/// Per point: the standard deviation of luminance over its mean (RMS contrast; Peli, JOSA A 7, 1990) in a square
/// window. Its half side is the relief's scale at that distance, at least a pixel. 0 in the dark. Sampling scale and
/// noise matter: a camera's noise adds to the contrast of dark places.
/// points    interest points of an object in the scene; scale_m > 0 (asserted)
/// camera    that took the picture and has its size (asserted)
[[nodiscard]] PictureContrast picture_contrast(const Picture& picture, const Camera& camera, const RayScene& scene,
                                               std::span<const OrientedPoint> points, double scale_m);

}  // namespace luxrig
