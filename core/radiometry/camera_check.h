#pragma once
/// Whether a camera's pictures measure light: a verdict with figures, from a series of exposures.

#include <optional>
#include <string>
#include <vector>

#include "core/radiometry/curve_fit.h"
#include "core/radiometry/photon_transfer.h"

namespace luxrig {

/// What is wrong, and how to mend it.
struct CameraFinding {
  std::string what, mend;
};

struct CameraCheck {
  LinearityFit as_it_is;             ///< of its raw samples
  std::optional<SampleCurve> curve;  ///< measured; none if the series does not determine it
  CurveShape shape;                  ///< of the curve
  LinearityFit through_curve;        ///< of samples converted to light by that curve; requires curve
  LinearityFit as_configured;        ///< of samples converted to light by the configured curve
  std::optional<PhotonTransfer> noise;
  double saturation = 1;  ///< share of full scale
  bool saturates = false;
  double clipped_share = 0;  ///< share of samples that are full at the shortest exposure
  double flicker = 0;        ///< between frames at one exposure, relative standard deviation
  bool linear = false;       ///< samples are proportional to light above dark
  bool usable = false;       ///< linear, or the measured curve makes samples linear
  bool good = false;         ///< the configured curve makes samples proportional to light
  std::vector<CameraFinding> findings;
};

/// configured: the camera's present conversion of samples to light. Cause::invalid if the series cannot be judged at
/// all (group_samples), or too little of it is usable.
[[nodiscard]] Result<CameraCheck> check_camera(const ExposureSeries& series, const SampleCurve& configured);

}  // namespace luxrig
