#pragma once
/// Levels of the emitters of one housing at which their light together has a wanted colour.

#include <vector>

#include "core/geometry.h"

namespace luxrig {

/// Of one emitter at full level.
struct EmitterLight {
  double lumens = 0;        ///< ≥ 0
  Vec3 rgb = Vec3::Ones();  ///< linear Rec. 709 with a luminance of 1
};

struct EmitterMix {
  std::vector<double> levels;  ///< one each, 0…1, the highest is 1
  double flux_share = 1;       ///< of the flux of all emitters at full level
  double off_uv = 0;           ///< distance from the wanted colour in CIE 1976 u'v'; 0.003 is just seen side by side
};

/// The brightest mix of at most three emitters that has the colour, or else the one next to it: three colours reach
/// every chromaticity that any number of them reaches. All emitters alike if none gives light.
[[nodiscard]] EmitterMix mix_of_colour(const std::vector<EmitterLight>& emitters, const Vec3& wanted_rgb);

}  // namespace luxrig
