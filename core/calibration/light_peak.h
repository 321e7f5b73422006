#pragma once
/// The aim at which a luxmeter reads most of a head's light, from aims around it.
///
/// About that aim, the direct light falls as exp(−k/2 · |q − q₀ ∓ b/2|²), so that aims around it, some from each side of
/// the joints, tell the middle q₀ and the play b of the gears; the lamp's exact shape and the meter's gain do not matter,
/// as opposite aims share them. What the room throws back does matter at a far meter, since it grows towards the nearer
/// wall. It is traced in the scene as stated, and its share is fitted with the rest, as paint is known only roughly.

#include <optional>
#include <span>

#include "core/calibration/head_pose.h"
#include "core/photometry/intensity.h"
#include "core/scene/ray_scene.h"

namespace luxrig {

struct HeadMeter {
  Vec3 position_world_m = Vec3::Zero();
  Vec3 normal_world = Vec3::UnitZ();
  double noise = 0.02;  ///< of a reading, relative
};

/// One aim around a maximum.
struct PeakSample {
  Joints sent;
  Approach from;
  double lux = 0;        ///< without the dark
  double reflected = 0;  ///< as traced, over the direct light of the maximum
};
/// The aim at which a meter reads most.
struct LightPeak {
  Joints middle;                  ///< without play
  Joints half_play;               ///< ≥ 0; beam_rad unused
  double standard_error_rad = 0;  ///< of the beam's direction, per axis
  double off_rad = 0;             ///< of the middle, from the samples' centre
  int used = 0;                   ///< samples that were bright enough to tell
};
/// How the logarithm of a beam's light falls where it is aimed beside a meter.
struct BeamFall {
  double radius_rad = 0;  ///< half angle at which the beam has a third of its peak
  double per_rad2 = 0;    ///< k above, there
};
/// By the lamp's file.
[[nodiscard]] BeamFall fall_of(const IntensityDistribution& intensity, double radius_rad);
/// None if the samples have no maximum.
[[nodiscard]] std::optional<LightPeak> light_peak(std::span<const PeakSample> samples, const Joints& centre,
                                                  const BeamFall& fall, double noise, double play_rad);

/// How fast the beam moves with its pan, over its tilt; at least a tenth.
[[nodiscard]] double pan_share(const Joints& joints);

/// Light that reaches the meter after one reflection, the room as its file says, over the direct light of a beam that
/// points at it. world_from_lamp: the beam.
[[nodiscard]] double reflected_over_peak(const RayScene& rays, const HeadMeter& meter,
                                         const IntensityDistribution& intensity, const Pose& world_from_lamp);

}  // namespace luxrig
