#pragma once
/// Checks whether the scene's file was read as meant. Private to rig_notes.

#include "core/scene/scene.h"
#include "core/tasks/rig_notes/placed_things.h"

namespace luxrig {

/// The note on a wrong `unit` or `up_axis`: another reading would put nearly everything that the rig places within the
/// scene, and this one does not; or the scene is higher than any building. None without such a doubt, or without a mesh
/// file.
[[nodiscard]] std::optional<Problem> doubt_of_reading(const Rig& rig, const Scene& scene);

}  // namespace luxrig
