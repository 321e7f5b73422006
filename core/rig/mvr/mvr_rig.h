#pragma once
/// A rig file made from an MVR file, for a person to complete.

#include <string>
#include <vector>

#include "core/rig/mvr/mvr_file.h"

namespace luxrig {

struct ImportedRig {
  struct File {
    std::string name;  ///< plain letters, no folder
    std::string bytes;
  };
  std::string rig_toml;  ///< passes load_rig beside its files
  std::vector<File> files;
  std::vector<std::string> remarks;  ///< what a person must look at; the rig file says the same in its place
  std::size_t fixtures = 0, luminaires = 0;
  std::size_t models = 0;  ///< of scenery, in scene.obj
};

/// A luminaire for each kind of fixture (GDTF file and mode) by its beams, and a fixture for each, with position,
/// orientation, focus and address. A fixture without a usable address gets a free one, one without a usable GDTF mode a
/// single dimmer slot; comments say so. Scenery becomes scene.obj and scene.mtl; goals and meters are the person's to
/// add.
[[nodiscard]] ImportedRig rig_of_mvr(const MvrFile& mvr, const std::string& rig_name);

/// Yaw, pitch and roll of `mount_deg` that make up a rotation.
[[nodiscard]] Vec3 mount_deg_of(const Mat3& rotation);

}  // namespace luxrig
