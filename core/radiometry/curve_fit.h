#pragma once
/// The response of a camera from a series of exposures, and its linearity.
///
/// Source of the fit: T. Mitsunaga and S. Nayar, Radiometric self calibration (1999), with known exposures and a cubic
/// spline instead of their polynomial; least squares with a penalty on the change of its curvature.

#include "core/radiometry/exposure_series.h"
#include "core/radiometry/sample_curve.h"

namespace luxrig {

struct LinearityFit {
  double dark_share = 0;           ///< sample without light, extrapolated to zero exposure
  double dark_standard_error = 0;  ///< of that
  double rms_residual = 0;  ///< relative deviation of samples from the straight line, over levels of the used range
  double worst_residual = 0;
  double used_from = 0, used_to = 0;  ///< shares of full scale
  double step_residual = 0;           ///< worst common deviation of all light at one exposure
};

/// Fits a straight line to samples, or to light if there is a `curve`. Cause::invalid if too little of the series is
/// usable.
[[nodiscard]] Result<LinearityFit> fit_line(const SampleGroups& groups, const SampleCurve* curve = nullptr);

/// Monotone; light 1 at saturation. Cause::invalid as above.
[[nodiscard]] Result<SampleCurve> fit_curve(const SampleGroups& groups);

/// Shape of a curve over its upper nine tenths.
struct CurveShape {
  double exponent = 1;         ///< light grows as (sample above dark) to this power
  const char* name = "power";  ///< "linear", "srgb", "bt709" or "power", whichever is nearest
  double rms = 0;              ///< relative difference of light from that shape
};
[[nodiscard]] CurveShape shape_of(const SampleCurve& curve, double saturation);

}  // namespace luxrig
