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
  std::string texture;         ///< of map_Kd; empty: none
};

struct MtlFile {
  std::vector<MtlMaterial> materials;
  std::vector<std::string> warnings;
};

/// The text in whatever encoding. What stands before the first newmtl, and what light does not need, is left out, the
/// former with a warning. A colour that is no number is refused, with line and column. `file` is for the messages.
[[nodiscard]] Checked<MtlFile> parse_mtl(std::string bytes, const std::string& file);

}  // namespace luxrig
