#pragma once
/// Changes in a rig file that a running daemon cannot take: those of outputs, whose drivers keep running.

#include <vector>

#include "core/result.h"
#include "core/rig/rig.h"

namespace luxrig {

/// Problems at their places in the new file; empty if it can be taken. same_light: scene, photometry and positions are
/// unchanged.
[[nodiscard]] std::vector<Problem> needs_a_restart(const Rig& running, const Rig& changed, bool same_light);

}  // namespace luxrig
