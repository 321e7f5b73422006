#pragma once
/// The scene as a rig file states it.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry.h"
#include "core/scene/mesh/mesh_file.h"

namespace luxrig {

/// Position in the rig file, for problems found later.
struct FilePosition {
  int line = 0;
  int column = 0;
};

struct ReflectanceRule {
  std::string material_pattern;  ///< shell pattern: * and ?
  Vec3 reflectance_rgb = Vec3::Constant(0.5);
  FilePosition in_file;
  double specular = 0;     ///< gloss: reflectance of the coat at normal incidence, 0…0.95
  double roughness = 0.3;  ///< of the coat, 0.05…1
};

/// An object placed in the scene: a mesh file, or a box.
struct SceneObject {
  std::string name;
  std::optional<MeshFile> mesh;          ///< else box_m
  Vec3 box_m = Vec3::Zero();             ///< width (x), depth (y), height (z)
  Vec3 position_world_m = Vec3::Zero();  ///< position of the middle of its underside (bounding box)
  double turn_rad = 0;                   ///< about +Z, counter-clockwise from above
  std::optional<double> height_m;        ///< mesh scaled evenly to this height
  std::optional<Vec3> reflectance_rgb;   ///< of all its materials; if not given, rules and file colours apply
  std::optional<double> transmittance;   ///< of each face, at normal incidence; set = glass (core/scene/panes.h)
  FilePosition in_file;
};

struct SceneSpec {
  std::optional<MeshFile> mesh;
  Vec3 default_reflectance_rgb = Vec3::Constant(0.5);  ///< if neither a rule nor the file gives one
  std::vector<ReflectanceRule> reflectances;           ///< first match wins, before the file's own colour
  std::vector<SceneObject> objects;
  /// By a calibration: true over stated reflectance of materials, by their names.
  std::vector<std::pair<std::string, double>> paint{};
  FilePosition in_file;
};

}  // namespace luxrig
