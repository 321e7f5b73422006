#pragma once
/// Places in a camera's picture that a head can be aimed at to see where its beam truly falls, and the joints to begin
/// with.

#include <functional>
#include <span>
#include <vector>

#include "core/calibration/head_fit.h"
#include "core/calibration/seen_surface.h"
#include "core/rig/rig.h"
#include "core/scene/ray_scene.h"

namespace luxrig {

struct HeadPlace {
  Vec3 position_world_m = Vec3::Zero();
  Vec3 normal_world = Vec3::UnitZ();
  bool on_one_plane = false;  ///< the whole beam, and a large one; else its middle is less certain
};

/// What a head is, as far as it is stated.
struct HeadSetup {
  Pose stated;  ///< world_from_mount
  JointRange range;
  double pan_speed_rad_s = 1, tilt_speed_rad_s = 1;
  double beam_radius_rad = 0;  ///< half angle within which its light is above a third of its peak
  HeadPriors priors;
  std::function<bool(const Joints&)> barred{};  ///< sent there, it would be refused (keep-out zones); empty = nowhere
};

/// Of a head of the rig, as its file states it.
[[nodiscard]] HeadSetup head_setup(const Rig& rig, std::size_t fixture, const HeadPriors& priors);

/// Evenly over the picture: places that the lamp sees, and whose beam the camera sees wholly.
[[nodiscard]] std::vector<HeadPlace> head_places(const SeenSurface& surface, const RayScene& rays,
                                                 const HeadSetup& setup);

/// Joints at which the beam is likely to be seen, whichever kind of head it is; the likeliest first, none twice.
[[nodiscard]] std::vector<Joints> search_aims(const SeenSurface& surface, const RayScene& rays, const HeadSetup& setup,
                                              std::span<const HeadPlace> places);

/// Of the joints, so that every aim can be come to from both sides.
[[nodiscard]] JointRange with_run_up(const JointRange& range);
/// Longer than the play of any gear.
inline constexpr double kRunUp_rad = rad_from_deg(3);
/// Where a head is sent first, so that it comes to its aim from the wanted side, through all play.
[[nodiscard]] inline Joints run_up_to(const Joints& aim, const Approach& from) {
  return {aim.pan_rad - from.pan * kRunUp_rad, aim.tilt_rad - from.tilt * kRunUp_rad, aim.beam_rad};
}
/// Neither the aim nor its run-up is barred.
[[nodiscard]] bool may_aim(const HeadSetup& setup, const Joints& aim, const Approach& from);

}  // namespace luxrig
