#pragma once
/// Our PLY reader in the place of assimp's, so that its splitting of polygons serves both. Internal to mesh_file.cpp.

#include <assimp/Importer.hpp>

#include "core/scene/ply_file.h"

namespace luxrig {

/// Takes every reader out of `importer` and puts in one that gives `mesh` for whatever file it is asked.
void give_ply(Assimp::Importer& importer, PlyMesh mesh);

}  // namespace luxrig
