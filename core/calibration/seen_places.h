#pragma once
/// A camera as many luxmeters: places on matt surfaces that it sees, as receivers of the rig's light. What a picture
/// shows there, over the surface's reflectance, is the light there, but for what is not known of paint, lens and
/// camera: camera_instrument.h.

#include <Eigen/Core>
#include <optional>
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
  double x_px = 0, y_px = 0;  ///< its middle, from the top left corner
};

/// Side of the square of pixels that a place is [px].
inline constexpr int kPlaceSide_px = 5;

/// Places wholly on one matt surface that is not seen aslant: points of the rig that lie on such a surface, then at most
/// `count` evenly over the picture. What is seen at a point needs no model of how light changes from place to place.
[[nodiscard]] std::vector<SeenPlace> seen_places(const RayScene& rays, const Camera& camera,
                                                 std::span<const Point> points, int count);

/// The same places as another camera shows them, such as the one that was found (camera_pose.h); none = it does not see
/// that place wholly.
[[nodiscard]] std::vector<std::optional<SeenPlace>> places_by(const RayScene& rays, const Camera& camera,
                                                              std::span<const SeenPlace> places);

/// The rig with a point without goal or limit at each place, after its own.
[[nodiscard]] Rig with_places(Rig rig, std::span<const SeenPlace> places);

/// Light at a place by two pictures of the same camera, with a lamp on and off.
struct SeenLight {
  double lux = 0, standard_error_lx = 0;  ///< by the stated reflectance; error: of its pixels' scatter
  /// So much more there would be if all light were spread evenly over the picture, or around each pixel
  /// (halo_reach_px()): stray light adds a share of these.
  double veil_lx = 0, halo_lx = 0;
};
/// Standard deviation of the spread that halo_lx stands for; halos of half and twice that are much alike.
[[nodiscard]] double halo_reach_px(int height_px);
/// Both pictures are of the camera that the places are of (sizes asserted).
[[nodiscard]] std::vector<std::optional<SeenLight>> seen_light(const Picture& lit, const Picture& dark,
                                                               std::span<const std::optional<SeenPlace>> places);

}  // namespace luxrig
