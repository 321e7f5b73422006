#pragma once
/// A camera as many luxmeters: places on matt surfaces that it sees, as receivers of the rig's light. What a picture shows
/// there, over the surface's reflectance, is the light there, but for one factor per material: its true reflectance, and
/// the camera's scale. LightUnknowns takes that factor as the gain of an instrument of its own.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/calibration/light_unknowns.h"
#include "core/picture/picture.h"
#include "core/rig/rig.h"
#include "core/scene/ray_scene.h"

namespace luxrig {

struct SeenPlace {
  Vec3 position_world_m = Vec3::Zero();
  Vec3 normal_world = Vec3::UnitZ();
  std::size_t material = 0;  ///< of the scene
  double reflectance = 0;    ///< luminous, as stated
  int x_px = 0, y_px = 0;    ///< its middle, from the top left corner
};

/// Side of the square of pixels that a place is [px].
inline constexpr int kPlaceSide_px = 5;

/// At most `count` places, evenly over the picture, each wholly on one matt surface that is not seen aslant.
[[nodiscard]] std::vector<SeenPlace> seen_places(const RayScene& rays, const Camera& camera, int count);

/// The rig with a point without goal or limit at each place, after its own.
[[nodiscard]] Rig with_places(Rig rig, std::span<const SeenPlace> places);

/// Light there by two pictures of the same camera, with a lamp on and off. standard_error_lx: of its pixels' scatter.
struct SeenLight {
  double lux = 0, standard_error_lx = 0;
};
/// Both pictures have the size of the camera of seen_places (asserted).
[[nodiscard]] SeenLight seen_light(const Picture& lit, const Picture& dark, const SeenPlace& place);

}  // namespace luxrig
