#pragma once
/// How a picture of light becomes a photograph: the luminance and the colour of white.

#include <optional>
#include <span>
#include <string>

#include "core/picture/picture.h"

namespace luxrig {

/// Settings of a photograph. Middle grey (0.18 on a linear scale) is then white_cd_m2 · 0.03.
struct PhotographLook {
  double white_cd_m2 = 100;       ///< luminance from which on everything is white
  Vec3 white_rgb = Vec3::Ones();  ///< light of this colour looks neutral; linear Rec. 709, luminance 1
};

/// Value of `--exposure`.
struct Exposure {
  double stops = 0;                   ///< +1 is twice as bright as metered
  std::optional<double> white_cd_m2;  ///< instead of metering
};
/// "+1", "-0.5": stops. "300cd/m2": luminance of white. Nothing for any other text.
[[nodiscard]] std::optional<Exposure> exposure_of(const std::string& text);

/// Value of `--white-balance`.
struct WhiteBalance {
  bool of_lamps = true;  ///< else cct_k, or white (D65)
  std::optional<double> cct_k;
};
/// "lamps", "daylight", "2700" or "2700K". Nothing for any other text.
[[nodiscard]] std::optional<WhiteBalance> white_balance_of(const std::string& text);

/// Metered as a person would: middle grey is the log-average of the visible surfaces without their darkest and
/// brightest 1 %. But lit surfaces (above 1/50 of the brightest) must not burn out: all but 2 % of them stay below a
/// third of white, so a small object before a dark backdrop keeps its modelling. 100/3 if nothing shines.
[[nodiscard]] double metered_white_cd_m2(const Picture& picture);

struct LampWhite {
  Vec3 rgb = Vec3::Ones();
  std::optional<double> cct_k;  ///< none: daylight, coloured light or no light; white is then D65
};
/// The black body nearest in colour to the light of all lamps together, weighted by lumens at these levels.
[[nodiscard]] LampWhite white_of_lamps(std::span<const Emitter> emitters, std::span<const double> levels);

}  // namespace luxrig
