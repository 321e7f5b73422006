#pragma once
/// The light that a maker's file states, where the rig file states none. Private to core/rig.

#include "core/rig/personality/personality.h"

namespace luxrig {

/// Whether it states what a rig file could have: within what the rig file allows.
[[nodiscard]] bool states_lumens(const BeamGeometry& light);
[[nodiscard]] bool states_spot(const BeamGeometry& light);
[[nodiscard]] bool states_cct(const BeamGeometry& light);
[[nodiscard]] bool states_watts(const BeamGeometry& light);

}  // namespace luxrig
