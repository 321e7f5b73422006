#pragma once
/// What a task's role and set-up ask of its lights: where they may stand, what they shall light, and how bright.
///
/// Key light is the light that stays, where it is at or above its mean over the seen object. A place is dark where it is
/// below half of that mean (at least the darkest kLeastDark of the object). Each role's own light:
///   key         with a ratio: its mean over the object is ratio × the mean of all other light
///   fill        lifts the dark places to key light / ratio, with what light they have (kFillRatio if none is given)
///   rim         from behind: key light / ratio along the outline (kRimRatio), little of it on what faces the camera
///   background  lights what is behind the object evenly: key light / ratio (kBackgroundRatio), little on the object
/// Without key light, rim and background are as bright as the limits allow.
///
/// Sources: 3:1 to 4:1 is the standard portrait ratio (focusonlens.com, lighting ratio calculator), 2:1 television's
/// (cybercollege.com, TV production, module 33). Ratios of rim and background, and spill, are ours.

#include "core/highlight/lights/set_up.h"
#include "core/highlight/seen/seen_role.h"
#include "core/highlight/shadow/contrast_samples.h"
#include "core/highlight/surface/feature_clusters.h"
#include "core/result.h"

namespace luxrig {

inline constexpr double kFillRatio = 3, kRimRatio = 1, kBackgroundRatio = 2;
inline constexpr double kRimSpill = 0.25, kBackgroundSpill = 0.1;  ///< SeenRole::max_spill
inline constexpr double kLeastDark = 0.1;

struct AskedOfLight {
  SeenRole role;
  double other_lx = 0;  ///< mean of the light that the ratio is to; 0 without
  double there_lx = 0;  ///< of a fill: mean of the light that stays on the dark places
};

/// What is seen counts for it so. Of a rim light only the outline.
[[nodiscard]] SeenWishes wishes_of(const ReliefSpec& relief);

/// Refuses a ratio to light that is not there, a fill where the light that stays is ratio enough, and a background
/// that the camera does not see.
/// seen       its surroundings, too, for a background; of one eye, unless the role is any, key or fill
/// fixed_lux  light that stays, at its samples
[[nodiscard]] Result<AskedOfLight> asked_of_light(const ReliefSpec& relief, const SeenContrast& seen,
                                                  const Vec3& middle_world_m, const Vec3& eye_world_m,
                                                  std::span<const float> fixed_lux);

/// Key to this role's light, or of the key to all other.
[[nodiscard]] std::optional<double> ratio_of(LightRole role, const AskedOfLight& asked, double own_lx);

/// The places that a role wants lit, to aim at; without neighbours, so without contrast. At most `most` of them.
struct WantedPlaces {
  ContrastSamples samples;
  FeatureClusters features;
};
[[nodiscard]] WantedPlaces wanted_places(const SeenContrast& seen, const SeenRole& role, std::size_t most);

}  // namespace luxrig
