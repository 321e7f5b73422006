#pragma once
/// What of a rig file a running daemon cannot take: outputs, whose drivers go on as they are.

#include <vector>

#include "core/result.h"
#include "core/rig/rig.h"

namespace luxrig {

/// Problems at their places in the new file, empty when it can be taken. same_light: scene, photometry and places are
/// the same.
[[nodiscard]] std::vector<Problem> needs_a_restart(const Rig& running, const Rig& changed, bool same_light);

}  // namespace luxrig
