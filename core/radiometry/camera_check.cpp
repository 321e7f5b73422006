#include "core/radiometry/camera_check.h"

#include <fmt/format.h>

#include <cmath>

namespace luxrig {
namespace {

constexpr double kLinearRms = 0.01, kLinearWorst = 0.03;   ///< of light
constexpr double kCurveRms = 0.02, kCurveWorst = 0.06;     ///< deviation allowed after a measured curve
constexpr double kDarkOff = 0.005;                         ///< of full light
constexpr double kFlickers = 0.005, kStepOff = 0.01;       ///< of light
constexpr double kFollowsTooLittle = 0.5;                  ///< of the power of the exposures' ratio that is expected
constexpr double kTooMuchClipped = 0.02, kTooDark = 0.25;  ///< of samples; of full scale

/// If samples grow only as the exposure to the power of a quarter or less, something adapts and holds them down.
bool adapts(const SampleGroups& groups) {
  const double ratio = groups.exposures_s.back() / groups.exposures_s.front();
  return groups.follows > 0 && ratio > 2 && std::log(groups.follows) < kFollowsTooLittle * 0.5 * std::log(ratio);
}

}  // namespace

Result<CameraCheck> check_camera(const ExposureSeries& series, const SampleCurve& configured) {
  const auto groups = group_samples(series);
  if (!groups) return tl::unexpected(groups.error());
  CameraCheck out;
  out.saturation = groups->saturation;
  out.saturates = groups->saturates;
  out.clipped_share = groups->clipped_share;
  out.flicker = groups->flicker;
  const auto note = [&](std::string what, std::string mend) {
    out.findings.push_back({std::move(what), std::move(mend)});
  };
  if (adapts(*groups)) {
    note(fmt::format("samples grow {:.2f} times while the exposure grows {:.1f} times", groups->follows,
                     groups->exposures_s.back() / groups->exposures_s.front()),
         "switch automatic exposure, gain and backlight compensation off in the camera; or the dark is too bright to "
         "judge it: cover stray light");
    return out;
  }
  const auto line = fit_line(*groups);
  if (!line) return tl::unexpected(line.error());
  out.as_it_is = *line;
  out.linear = line->rms_residual <= kLinearRms && line->worst_residual <= kLinearWorst;
  if (const auto fit = fit_line(*groups, &configured)) {
    out.as_configured = *fit;
    out.good = fit->rms_residual <= kLinearRms && fit->worst_residual <= kLinearWorst;
  }
  SampleCurve through = SampleCurve::linear(std::clamp(line->dark_share, 0.0, 0.9));
  if (auto curve = fit_curve(*groups)) {
    out.shape = shape_of(*curve, groups->saturation);
    if (const auto straightened = fit_line(*groups, &*curve)) {
      out.through_curve = *straightened;
      const bool good = straightened->rms_residual <= kCurveRms && straightened->worst_residual <= kCurveWorst;
      out.usable = out.linear || good;
      if (!out.linear && good) {
        through = *curve;
      }
      if (!out.linear && good && !out.good) {
        note(
            fmt::format("the camera is not linear: {:.1f} % rms off a straight line, light grows as the sample to the "
                        "power {:.2f}{}",
                        100 * line->rms_residual, out.shape.exponent,
                        std::string_view(out.shape.name) == "power" ? "" : fmt::format(", as by {}", out.shape.name)),
            "switch gamma, contrast and tone curves off in the camera; or give [[camera]] response_file the curve that "
            "this check measured");
      }
      if (!out.linear && !good) {
        note(fmt::format("no response curve explains the samples: {:.1f} % rms are left",
                         100 * straightened->rms_residual),
             "hold the scene, its light and the camera still; switch everything automatic off in the camera");
      }
    }
    out.curve = std::move(*curve);
  } else {
    out.usable = out.linear;
    if (!out.linear)
      note(fmt::format("{:.1f} % rms off a straight line, and no curve could be measured: {}", 100 * line->rms_residual,
                       curve.error().detail),
           "use more exposures, of a scene with bright and dark places");
  }
  if (out.good && std::abs(out.as_configured.dark_share) > kDarkOff)
    note(fmt::format("without light the camera still gives {:.1f} % of full light", 100 * out.as_configured.dark_share),
         out.linear ? fmt::format("write dark_level = {:.4f}", std::max(0.0, line->dark_share))
                    : "give [[camera]] response_file the curve that this check measured");
  if (out.linear && !out.good)
    note(fmt::format("samples are linear, but the response that the rig file states makes them {:.1f} % rms off",
                     100 * out.as_configured.rms_residual),
         "write response = \"linear\"");
  const double step_off = out.linear || !out.curve ? line->step_residual : out.through_curve.step_residual;
  if (out.flicker > kFlickers) {
    note(fmt::format("the light flickers: pictures of one exposure differ by {:.1f} %", 100 * out.flicker),
         "expose for a multiple of the mains' half period (10 ms at 50 Hz, 8.33 ms at 60 Hz), or use steady light");
  } else if (step_off > kStepOff) {
    note(fmt::format("all light of one exposure is off by {:.1f} %", 100 * step_off),
         "the camera does not keep its exposure times exactly: hold one exposure, and calibrate it");
  }
  if (!out.saturates)
    note(fmt::format("full samples were not seen: the brightest is {:.0f} % of full scale", 100 * out.saturation),
         out.saturation < kTooDark ? "use longer exposures or more light"
                                   : "a longer exposure would show where it clips");
  if (out.clipped_share > kTooMuchClipped)
    note(fmt::format("{:.0f} % of the pixels are full at the shortest exposure", 100 * out.clipped_share),
         "use shorter exposures or less light");
  out.noise = photon_transfer(*groups, series.full_scale_counts, through);
  return out;
}

}  // namespace luxrig
