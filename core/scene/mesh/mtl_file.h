#pragma once
/// Material files of OBJ (.mtl). Source: Wavefront Advanced Visualizer, appendix B1. Internal to core/scene.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry.h"
#include "core/result.h"

namespace luxrig {

struct MtlMaterial {
  std::string name;            ///< plain text
  std::optional<Vec3> colour;  ///< Kd, as linear light
  std::string texture;         ///< of map_Kd; empty = none
};

struct MtlFile {
  std::vector<MtlMaterial> materials;
  std::vector<std::string> warnings;
};

/// Parses a text in any encoding. Skips statements before the first newmtl (with a warning) and those that light does
/// not need. Refuses a colour that is not a number, with line and column. `file` is for messages.
[[nodiscard]] Checked<MtlFile> parse_mtl(std::string bytes, const std::string& file);

}  // namespace luxrig
