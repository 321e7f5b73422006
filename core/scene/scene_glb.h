#pragma once
/// A scene as one binary glTF file, to be shown elsewhere. Source: Khronos glTF 2.0.0.

#include <string>

#include "core/scene/scene.h"

namespace luxrig {

/// The scene as GLB, in metres and +Y up (world x, y, z is written as x, z, -y): positions float32 about the scene's
/// origin, which is the translation of the root node; indices uint32. Node 0 has one primitive per material in use, in
/// their order, its triangles in theirs; the material has reflectance_rgb as base colour, is two-sided, and rough as in
/// the scene. A node after it has the panes, if any: blended, alpha = 1 - transmittance of the clearest.
/// Empty if the scene has no triangle and no pane, or the file would exceed `max_bytes`. The same scene gives the same
/// bytes.
[[nodiscard]] std::string scene_glb(const Scene& scene, std::size_t max_bytes = std::size_t{64} << 20);

}  // namespace luxrig
