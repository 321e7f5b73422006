#pragma once
/// The response of a camera from a series of exposures, and how linear it is.
///
/// Source of the fit: T. Mitsunaga and S. Nayar, Radiometric self calibration (1999), with exposures that are known and
/// a cubic spline in place of their polynomial; least squares with a penalty on its curvature's change.

#include "core/radiometry/exposure_series.h"
#include "core/radiometry/sample_curve.h"

namespace luxrig {

struct LinearityFit {
  double dark_share = 0;           ///< sample without light, by extrapolation to no exposure
  double dark_standard_error = 0;  ///< of that
  double rms_residual = 0;  ///< of what samples are off the straight line, relative, over levels of the used range
  double worst_residual = 0;
  double used_from = 0, used_to = 0;  ///< shares of full scale
  double step_residual = 0;           ///< what all light of one exposure is off by together, worst
};

/// Through `curve`: the straight line is fitted to light instead of samples. Cause::invalid when too little of the
/// series is usable.
[[nodiscard]] Result<LinearityFit> fit_line(const SampleGroups& groups, const SampleCurve* curve = nullptr);

/// Monotone; light 1 at saturation. Cause::invalid as above.
[[nodiscard]] Result<SampleCurve> fit_curve(const SampleGroups& groups);

/// What a curve is like, over its upper nine tenths.
struct CurveShape {
  double exponent = 1;         ///< light grows as sample above dark to this power
  const char* name = "power";  ///< "linear", "srgb", "bt709" or "power", the one that is nearest
  double rms = 0;              ///< relative difference of light to that
};
[[nodiscard]] CurveShape shape_of(const SampleCurve& curve, double saturation);

}  // namespace luxrig
