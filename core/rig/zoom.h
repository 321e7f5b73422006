#pragma once
/// Luminaires that zoom: their light at beam angles other than the one in the rig file.

#include "core/rig/equipment.h"

namespace luxrig {

/// Distribution at rated flux with the zoom at this beam angle [rad]: a spot of the same flux, with the stated ratio of
/// field angle to beam angle. At 0, or for a luminaire that does not zoom: as stated.
[[nodiscard]] Intensity intensity_at_beam(const Luminaire& luminaire, double beam_rad);

}  // namespace luxrig
