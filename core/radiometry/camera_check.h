#pragma once
/// Whether a camera's pictures say how much light there was: a verdict with numbers, from a series of exposures.

#include <optional>
#include <string>
#include <vector>

#include "core/radiometry/curve_fit.h"
#include "core/radiometry/photon_transfer.h"

namespace luxrig {

/// What is wrong, and what would mend it.
struct CameraFinding {
  std::string what, mend;
};

struct CameraCheck {
  LinearityFit as_it_is;             ///< of its samples
  std::optional<SampleCurve> curve;  ///< measured; nothing when the series does not tell
  CurveShape shape;                  ///< of the curve
  LinearityFit through_curve;        ///< of light that the curve makes of samples; requires curve
  LinearityFit as_configured;        ///< of light that the configured curve makes of samples
  std::optional<PhotonTransfer> noise;
  double saturation = 1;  ///< share of full scale
  bool saturates = false;
  double clipped_share = 0;  ///< of samples at the shortest exposure that are full
  double flicker = 0;        ///< of frames at one exposure, relative standard deviation
  bool linear = false;       ///< samples can be taken as light above dark
  bool usable = false;       ///< that, or light made of them by the curve
  bool good = false;         ///< light made of them by the configured curve is in proportion to light
  std::vector<CameraFinding> findings;
};

/// configured: what makes light of this camera's samples now.
/// Cause::invalid when the series cannot be judged at all (group_samples), or too little of it is usable.
[[nodiscard]] Result<CameraCheck> check_camera(const ExposureSeries& series, const SampleCurve& configured);

}  // namespace luxrig
