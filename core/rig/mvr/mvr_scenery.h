#pragma once
/// Objects of an MVR file that are not fixtures, as a mesh that a rig reads as its scene.

#include <string>
#include <vector>

#include "core/rig/mvr/mvr_file.h"

namespace luxrig {

struct MvrScenery {
  std::string obj;  ///< metres, +Z up, one object per model; names scene.mtl. Empty if there is none
  std::string mtl;  ///< material colours; a picture becomes the mean of the texels used
  std::size_t models = 0, triangles = 0;
  std::vector<std::string> notes;  ///< things left out, and why
};

/// Reads models in .3ds (millimetres, +Z up), .glb and .gltf (metres, +Y up; DIN SPEC 15801, "Geometry3D"), each placed
/// as the scene states. At most five million triangles.
[[nodiscard]] MvrScenery scenery_of_mvr(const MvrFile& mvr);

}  // namespace luxrig
