#pragma once
/// What a mesh file says, before units, splitting and cleaning: what every reader of a format gives. Internal to
/// core/scene, and to the import of MVR scenery.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "core/scene/texture.h"

namespace luxrig {

inline constexpr std::uint32_t kNoIndex = 0xffffffff;
inline constexpr std::size_t kMaxCorners = 1000;  ///< of one face; splitting it takes the square of this
inline constexpr std::size_t kMaxTriangles = 50'000'000;
inline constexpr const char* kUnnamedMaterial = "DefaultMaterial";  ///< of faces for which a file names none

struct FileMaterial {
  std::string name = kUnnamedMaterial;
  std::optional<Vec3> colour;              ///< diffuse, linear; what the texture is multiplied by
  std::shared_ptr<const Texture> texture;  ///< null: none that can be read
  bool unknown = false;                    ///< the file states a look that cannot be read: the rig's default serves
};

struct PolygonMesh {
  std::vector<Vec3> vertices;                 ///< in the file's unit and axes; may be NaN
  std::vector<Vec3f> colours;                 ///< linear, of each vertex; empty when the file has none
  std::vector<std::array<float, 2>> uvs;      ///< from the picture's upper left
  std::vector<std::uint32_t> corners;         ///< vertex indices, face after face; may point past the vertices
  std::vector<std::uint32_t> corner_uvs;      ///< into `uvs`, kNoIndex: none; empty, or one for each corner
  std::vector<std::uint32_t> corner_counts;   ///< of each face, at most kMaxCorners
  std::vector<std::uint32_t> face_materials;  ///< into `materials`; empty: all the first
  std::vector<FileMaterial> materials;        ///< empty: one without a name
  std::vector<std::string> warnings;          ///< what was left out, or taken otherwise than the file says
};

}  // namespace luxrig
