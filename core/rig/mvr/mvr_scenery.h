#pragma once
/// What is no fixture in an MVR file, as a mesh that a rig reads as its scene.

#include <string>
#include <vector>

#include "core/rig/mvr/mvr_file.h"

namespace luxrig {

struct MvrScenery {
  std::string obj;  ///< metres, +Z up, an object for each model; names scene.mtl. Empty: nothing to show
  std::string mtl;  ///< the materials' colours, pictures as the mean of what they cover
  std::size_t models = 0, triangles = 0;
  std::vector<std::string> notes;  ///< what was left out, and why
};

/// Models in .3ds (millimetres, +Z up), .glb and .gltf (metres, +Y up; DIN SPEC 15801, "Geometry3D"), each placed where
/// the scene says. At most five million triangles.
[[nodiscard]] MvrScenery scenery_of_mvr(const MvrFile& mvr);

}  // namespace luxrig
