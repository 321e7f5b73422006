#pragma once
/// Light stated by a maker's file, for values missing in the rig file. Private to core/rig.

#include "core/rig/personality/personality.h"

namespace luxrig {

/// Whether the file states a value that a rig file could have, within the rig file's ranges.
[[nodiscard]] bool states_lumens(const BeamGeometry& light);
[[nodiscard]] bool states_spot(const BeamGeometry& light);
[[nodiscard]] bool states_cct(const BeamGeometry& light);
[[nodiscard]] bool states_watts(const BeamGeometry& light);

}  // namespace luxrig
