#pragma once
/// Luminaires that zoom: their light at other beam angles than the one that the rig file states.

#include "core/rig/rig.h"

namespace luxrig {

/// Its distribution at rated flux with its zoom at this beam angle [rad]: a spot of the same flux whose field angle is
/// to its beam angle as stated. 0, or a luminaire that does not zoom: as stated.
[[nodiscard]] Intensity intensity_at_beam(const Luminaire& luminaire, double beam_rad);

}  // namespace luxrig
