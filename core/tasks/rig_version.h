#pragma once
/// Fingerprints of a rig: whether a plan or a saved state was made for the rig as its file has it now. Of values, not
/// of text: a comment or another order of keys changes nothing, another mesh under the same name does.

#include "core/plan/plan.h"
#include "core/rig/rig.h"
#include "core/scene/scene.h"

namespace luxrig {

/// Where moving heads look at present does not count: a plan sets it.
[[nodiscard]] RigVersion version_of(const Rig& rig, const Scene& scene);

}  // namespace luxrig
