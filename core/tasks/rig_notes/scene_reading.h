#pragma once
/// Was the scene's file read as it was meant? Private to rig_notes.

#include "core/scene/scene.h"
#include "core/tasks/rig_notes/placed_things.h"

namespace luxrig {

/// The note on a wrong `unit` or `up_axis`: with another reading nearly everything that the rig places would be within
/// the scene, and now it is not; or the scene is as high as no building. Nothing when there is no such doubt, or no
/// mesh file.
[[nodiscard]] std::optional<Problem> doubt_of_reading(const Rig& rig, const Scene& scene);

}  // namespace luxrig
