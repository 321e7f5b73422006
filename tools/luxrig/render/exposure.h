#pragma once
/// How a picture of light becomes a photograph: which luminance is white, and which colour.

#include <optional>
#include <span>
#include <string>

#include "core/picture/picture.h"

namespace luxrig {

/// Of a photograph. Middle grey (0.18 of a linear scale) is then white_cd_m2 · 0.03.
struct PhotographLook {
  double white_cd_m2 = 100;       ///< from this luminance on all is white
  Vec3 white_rgb = Vec3::Ones();  ///< light of this colour is shown neutral; linear Rec. 709, luminance 1
};

/// What `--exposure` says.
struct Exposure {
  double stops = 0;                   ///< above 0: brighter than metered, twice for each
  std::optional<double> white_cd_m2;  ///< instead of metering
};
/// "+1", "-0.5": stops; "300cd/m2": luminance of white. Nothing for any other text.
[[nodiscard]] std::optional<Exposure> exposure_of(const std::string& text);

/// What `--white-balance` says.
struct WhiteBalance {
  bool of_lamps = true;  ///< else cct_k, or white (D65)
  std::optional<double> cct_k;
};
/// "lamps", "daylight", "2700" or "2700K". Nothing for any other text.
[[nodiscard]] std::optional<WhiteBalance> white_balance_of(const std::string& text);

/// Metered as a person would: middle grey is the log-average of what is seen without its darkest and brightest 1 %; but
/// never so bright that what is lit (surfaces of more than 1/50 of the brightest) burns: all but 2 % of it stay below a
/// third of white, so a small thing before a dark backdrop keeps its modelling. 100/3 where nothing shines.
[[nodiscard]] double metered_white_cd_m2(const Picture& picture);

struct LampWhite {
  Vec3 rgb = Vec3::Ones();
  std::optional<double> cct_k;  ///< none: daylight shines in, lights are coloured, or none is on: white is D65
};
/// Colour of black body nearest to the light of all lamps together, by their lumens at these levels.
[[nodiscard]] LampWhite white_of_lamps(std::span<const Emitter> emitters, std::span<const double> levels);

}  // namespace luxrig
