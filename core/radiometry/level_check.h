#pragma once
/// Whether a camera's pictures say how much light there was, from a series of known dimmer levels at one exposure.
///
/// What a sample is, is the camera's curve of light, and that the dimmer's curve of its level. Places of a scene that
/// get more or less of one light take the two apart: whatever the dimmer does, it does to all places alike, so a camera
/// that is linear has them grow in proportion to one another. What is left over is the camera's; what all places do
/// together is the dimmer's. Except for a power: of light to a power all places grow in proportion again, so a power of
/// the camera and one of the dimmer are the same to this check. Exposures (camera_check.h) tell them apart.

#include <vector>

#include "core/radiometry/camera_check.h"
#include "core/radiometry/exposure_series.h"

namespace luxrig {

struct LevelStep {
  double level = 0;                        ///< 0…1, of full light by the dimmer's stated curve
  std::vector<std::vector<float>> frames;  ///< light as the camera says it, shares of what fills a sample
};

struct LevelSeries {
  int full_scale_counts = 255;
  LevelStep dark;                ///< level 0: light that is not the dimmer's, and the camera's dark level
  std::vector<LevelStep> steps;  ///< levels rising, above 0
};

struct SeenLevel {
  double level = 0, light = 0, standard_error = 0;  ///< of the light at the highest level
};

struct LevelCheck {
  std::vector<SeenLevel> seen;
  bool camera_told = false;                 ///< places differ enough in light to take camera and dimmer apart
  double camera_rms = 0, camera_worst = 0;  ///< what places are off growing in proportion; requires camera_told
  double line_rms = 0, line_worst = 0;      ///< what light is off a straight line through none at level 0, relative
  double exponent = 1, exponent_error = 0;  ///< light as it is seen grows as the level to this power
  double power_rms = 0;                     ///< what light is off that power
  double other_light = 0;                   ///< share of light, at the highest level, that is there at level 0
  double flicker = 0;                       ///< of frames at one level, relative standard deviation
  bool camera_linear = false;               ///< apart from a power; requires camera_told
  bool good = false;  ///< that, and light grows as the level: neither has a curve, unless they undo one another
  std::vector<CameraFinding> findings;
};

/// Cause::invalid: a series that group_samples() refuses, no frames at level 0 or of another size, levels outside
/// 0…1, or too little light that two levels see without clipping.
[[nodiscard]] Result<LevelCheck> check_by_levels(const LevelSeries& series);

}  // namespace luxrig
