#pragma once
/// Cameras that show an object, and where in their picture a place is seen.

#include <optional>
#include <span>

#include "core/geometry.h"
#include "core/picture/picture.h"
#include "core/scene/ray_scene.h"

namespace luxrig {

struct PicturePlace {
  double x_px, y_px;  ///< from the top left corner, as for ray_direction
  double ahead_m;     ///< along the camera's axis, > 0
};

/// Where a camera sees a place; nothing for one that is not before it. The inverse of ray_direction.
[[nodiscard]] std::optional<PicturePlace> place_in_picture(const Camera& camera, const Vec3& place_world_m);

/// The camera that looks against towards_eye and sees these points as large as they fit: their rectangle in the picture
/// takes `fill` (above 0, at most 1) of its width or of its height, whichever is reached first, and lies in its middle
/// that way (and nearly so the other way). Exact, in closed form.
/// points          at least one; where all are one, it is seen from 1 m
/// towards_eye     need not be unit; not zero (asserted)
[[nodiscard]] Camera camera_that_shows(std::span<const Vec3> points_world_m, const Vec3& towards_eye, double fill,
                                       double vertical_fov_rad, int width_px, int height_px);

/// Something that is worth seeing in a picture.
struct Sight {
  Vec3 position_world_m;
  Vec3 normal = Vec3::Zero();  ///< unit: seen from this side only, best from straight before it; zero: from all
  double weight = 1;
};

struct CutAwayCamera {
  Camera camera;
  double near_m = 0;  ///< nothing that is shown is nearer; what is may be left away (walls between eye and room)
  double seen = 0;    ///< share of the wanted weight that is in sight then
};

/// Of cameras that show all these points (camera_that_shows) from sixteen sides and heights of 22.5°, 5°, 45° and -15°,
/// in this order, the one that has most of what is wanted in sight past the scene, things nearer than near_m left away.
/// A later one must show 0.01 more to be taken.
/// shown   at least one (asserted); wanted may be none
[[nodiscard]] CutAwayCamera camera_that_sees(const RayScene& scene, std::span<const Vec3> shown_world_m,
                                             std::span<const Sight> wanted, double fill, double vertical_fov_rad,
                                             int width_px, int height_px);

}  // namespace luxrig
