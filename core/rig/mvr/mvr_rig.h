#pragma once
/// Makes a rig file from an MVR file, for a person to complete.

#include <string>
#include <vector>

#include "core/rig/mvr/mvr_file.h"

namespace luxrig {

struct ImportedRig {
  struct File {
    std::string name;  ///< plain letters, no folder
    std::string bytes;
  };
  std::string rig_toml;  ///< passes load_rig in a folder with `files`
  std::vector<File> files;
  std::vector<std::string> remarks;  ///< points for a person to check; the rig file repeats each at its place
  std::size_t fixtures = 0, luminaires = 0;
  std::size_t models = 0;  ///< of scenery, in scene.obj
};

/// Makes one luminaire per kind of fixture (GDTF file and mode) from its beams, and one fixture each, with position,
/// orientation, focus and address. A fixture without a usable address gets a free one. One without a usable GDTF mode
/// gets a single dimmer slot. Comments in the file say so. Scenery becomes scene.obj and scene.mtl. The person adds
/// goals and meters.
[[nodiscard]] ImportedRig rig_of_mvr(const MvrFile& mvr, const std::string& rig_name);

/// Yaw, pitch and roll of `mount_deg` for a rotation.
[[nodiscard]] Vec3 mount_deg_of(const Mat3& rotation);

}  // namespace luxrig
