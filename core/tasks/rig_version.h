#pragma once
/// Fingerprints of a rig, to check if a plan or a saved state was made for the rig as its file is now. They cover
/// values, not text: comments and the order of keys change nothing, another mesh under the same name does.

#include "core/plan/plan.h"
#include "core/rig/rig.h"
#include "core/scene/scene.h"

namespace luxrig {

/// Present aims of moving heads do not count: a plan sets them.
[[nodiscard]] RigVersion version_of(const Rig& rig, const Scene& scene);

}  // namespace luxrig
