#include "core/rig/zoom.h"

namespace luxrig {

Intensity intensity_at_beam(const Luminaire& luminaire, double beam_rad) {
  if (!luminaire.zoom_beam_rad || !(beam_rad > 0) || beam_rad == luminaire.beam_angle_rad) return luminaire.intensity;
  const double field_rad = beam_rad / luminaire.beam_angle_rad * luminaire.field_angle_rad;
  return make_spot(luminaire.intensity->flux_lm(), beam_rad, field_rad);
}

}  // namespace luxrig
