#pragma once
/// Positions and patch of fixtures from a My Virtual Rig file. Source: DIN SPEC 15801 (MVR 1.5, 1.6).
///
/// Its matrices (node `Matrix`) are {u}{v}{w}{o}: the object's x, y and z axes in the frame around it, then its origin
/// in millimetres; right-handed, z up. A fixture's own frame is that of its GDTF file: origin in the middle of its
/// base, hanging (for the pivot, see personality/gdtf_geometry.h).

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry.h"
#include "core/result.h"
#include "core/rig/personality/zip_archive.h"

namespace luxrig {

struct MvrAddress {
  int dmx_break = 0;  ///< which of the fixture's addresses, from 0
  int universe = 1;
  int address = 1;  ///< 1…512
};

struct MvrFixture {
  std::string name;
  std::string gdtf_file, gdtf_mode;
  Pose world_from_base;  ///< metres; includes the layers and groups around it
  std::optional<Vec3> focus_world_m;
  std::vector<MvrAddress> addresses;  ///< patched ones only
  bool inverts_pan = false, inverts_tilt = false;
  int line = 0;
};

/// A model of an object that is not a fixture (scenery, truss, screen …), at one of its places.
struct MvrGeometry {
  std::string object;                  ///< its name, plain text
  std::string file;                    ///< of the model, name in the archive; without an extension: .3ds
  Eigen::Affine3d world_from_model_m;  ///< metres; for a model in metres with +Z up
};

struct MvrScene {
  std::vector<MvrFixture> fixtures;
  std::vector<MvrGeometry> geometries;
  std::vector<std::string> notes;  ///< things left out, or odd
};

/// Reads GeneralSceneDescription.xml alone. At most 10 000 fixtures and 100 000 other models. `file` is for messages.
[[nodiscard]] Checked<MvrScene> parse_mvr_scene(std::string_view xml, const std::string& file);

struct MvrFile {
  MvrScene scene;
  /// Content of the GDTF files that fixtures name, by that name. Without those missing in the archive.
  std::map<std::string, std::string> gdtf_files;
  std::optional<ZipArchive> archive = std::nullopt;  ///< for the models
};

/// Reads a whole .mvr file (a zip archive).
[[nodiscard]] Checked<MvrFile> read_mvr(std::string bytes, const std::string& file);

}  // namespace luxrig
