#pragma once
/// Cameras that show an object, and the image position of a point.

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

/// Image position of a point; empty if it is not in front of the camera. The inverse of ray_direction.
[[nodiscard]] std::optional<PicturePlace> place_in_picture(const Camera& camera, const Vec3& place_world_m);

/// The camera that looks from the side `towards_eye` and shows these points as large as possible: their rectangle takes
/// `fill` (above 0, at most 1) of the picture's width or height, whichever is reached first. It is centred in that
/// direction, and nearly so in the other. Exact, in closed form.
/// points          at least one; if all coincide, they are seen from 1 m
/// towards_eye     need not be unit; not zero (asserted)
[[nodiscard]] Camera camera_that_shows(std::span<const Vec3> points_world_m, const Vec3& towards_eye, double fill,
                                       double vertical_fov_rad, int width_px, int height_px);

/// A point that is worth seeing in a picture.
struct Sight {
  Vec3 position_world_m;
  Vec3 normal = Vec3::Zero();  ///< unit: seen from this side only, best from straight ahead; zero = from all sides
  double weight = 1;
};

struct CutAwayCamera {
  Camera camera;
  double near_m = 0;  ///< everything shown is at least this far; nearer things may be omitted (walls before the eye)
  double seen = 0;    ///< share of the wanted weight then in sight
};

/// Tries cameras that show all these points (camera_that_shows) from sixteen sides and heights of 22.5°, 5°, 45° and
/// -15°, in this order. Returns the one with most of the wanted weight in sight past the scene, without things nearer
/// than near_m. A later one must show 0.01 more to win.
/// shown   at least one (asserted); wanted may be empty
[[nodiscard]] CutAwayCamera camera_that_sees(const RayScene& scene, std::span<const Vec3> shown_world_m,
                                             std::span<const Sight> wanted, double fill, double vertical_fov_rad,
                                             int width_px, int height_px);

}  // namespace luxrig
