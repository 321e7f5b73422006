#pragma once
/// Whether a camera's pictures measure light, from a series of known dimmer levels at one exposure.
///
/// A sample is the camera's curve of light, and light is the dimmer's curve of its level. Places of a scene that
/// receive different shares of one light separate the two. The dimmer affects all places alike, so with a linear camera
/// they grow in proportion to one another. Deviations from that are the camera's; what all places share is the
/// dimmer's. Powers are an exception: with light to a power, all places still grow in proportion. So this check cannot
/// tell a power of the camera from one of the dimmer. Exposures can (camera_check.h).

#include <vector>

#include "core/radiometry/camera_check.h"
#include "core/radiometry/exposure_series.h"

namespace luxrig {

struct LevelStep {
  double level = 0;                        ///< 0…1, of full light by the dimmer's stated curve
  std::vector<std::vector<float>> frames;  ///< light as the camera reports it, share of the light that fills a sample
};

struct LevelSeries {
  int full_scale_counts = 255;
  LevelStep dark;                ///< level 0: other light, and the camera's dark level
  std::vector<LevelStep> steps;  ///< levels rising, above 0
};

struct SeenLevel {
  double level = 0, light = 0, standard_error = 0;  ///< relative to the light at the highest level
};

struct LevelCheck {
  std::vector<SeenLevel> seen;
  bool camera_told = false;                 ///< places differ enough in light to separate camera and dimmer
  double camera_rms = 0, camera_worst = 0;  ///< deviation of places from growing in proportion; requires camera_told
  double line_rms = 0, line_worst = 0;      ///< relative deviation of light from proportion to level
  double exponent = 1, exponent_error = 0;  ///< observed light grows as the level to this power
  double power_rms = 0;                     ///< deviation of light from that power
  double other_light = 0;                   ///< light at level 0, as a share of that at the highest level
  double flicker = 0;                       ///< between frames at one level, relative standard deviation
  bool camera_linear = false;               ///< except for a power; requires camera_told
  bool good = false;  ///< camera_linear, and light proportional to level: neither has a curve, unless they cancel
  std::vector<CameraFinding> findings;
};

/// Cause::invalid: a series that group_samples() refuses, no frames at level 0 or of another size, levels outside 0…1,
/// or too little light seen at two levels without clipping.
[[nodiscard]] Result<LevelCheck> check_by_levels(const LevelSeries& series);

}  // namespace luxrig
