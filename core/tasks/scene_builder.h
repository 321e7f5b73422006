#pragma once
/// The rig's scene: its mesh and objects loaded, placed, given reflectances and re-centred.

#include "core/result.h"
#include "core/rig/rig.h"
#include "core/scene/scene.h"

namespace luxrig {

/// Problems name the rig file and the place of the scene or object. A rig with neither gives an empty Scene.
[[nodiscard]] Checked<Scene> build_scene(const Rig& rig);

}  // namespace luxrig
