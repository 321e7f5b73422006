#pragma once
/// What hangs where and how it is patched, from a My Virtual Rig file. Source: DIN SPEC 15801 (MVR 1.5, 1.6).
///
/// Its matrices (node `Matrix`) are {u}{v}{w}{o}: where x, y and z of the object point in the frame around it, then its
/// origin, in millimetres; right-handed, z up. A fixture's own frame is that of its GDTF file: origin in the middle of
/// its base, hanging (personality/gdtf_geometry.h has the pivot).

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
  Pose world_from_base;  ///< metres; layers and groups around it counted in
  std::optional<Vec3> focus_world_m;
  std::vector<MvrAddress> addresses;  ///< those that are patched
  bool inverts_pan = false, inverts_tilt = false;
  int line = 0;
};

/// A model of a thing that is no fixture (scenery, truss, screen …), in one of its places.
struct MvrGeometry {
  std::string object;                  ///< its name, plain text
  std::string file;                    ///< of the model, by its name in the archive; without an extension: .3ds
  Eigen::Affine3d world_from_model_m;  ///< metres; of a model in metres with +Z up
};

struct MvrScene {
  std::vector<MvrFixture> fixtures;
  std::vector<MvrGeometry> geometries;
  std::vector<std::string> notes;  ///< what was left out, or odd
};

/// GeneralSceneDescription.xml alone; at most 10 000 fixtures, and 100 000 models of other things. `file` is for the
/// messages.
[[nodiscard]] Checked<MvrScene> parse_mvr_scene(std::string_view xml, const std::string& file);

struct MvrFile {
  MvrScene scene;
  /// Content of the GDTF files that fixtures name, by that name; those that are not in the archive are absent.
  std::map<std::string, std::string> gdtf_files;
  std::optional<ZipArchive> archive = std::nullopt;  ///< for the models
};

/// A whole .mvr file (a zip archive).
[[nodiscard]] Checked<MvrFile> read_mvr(std::string bytes, const std::string& file);

}  // namespace luxrig
