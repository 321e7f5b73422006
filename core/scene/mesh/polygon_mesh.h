#pragma once
/// Content of a mesh file before units, splitting and cleaning: the result of every format's reader. Internal to
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
inline constexpr std::size_t kMaxCorners = 1000;  ///< of one face; the cost of splitting grows with the square
inline constexpr std::size_t kMaxTriangles = 50'000'000;
inline constexpr const char* kUnnamedMaterial = "DefaultMaterial";  ///< for faces without a material in the file

struct FileMaterial {
  std::string name = kUnnamedMaterial;
  std::optional<Vec3> colour;              ///< diffuse, linear; multiplies the texture
  std::shared_ptr<const Texture> texture;  ///< null = no readable one
  bool unknown = false;                    ///< the file states a look that cannot be read: the rig's default is used
};

struct PolygonMesh {
  std::vector<Vec3> vertices;                 ///< in the file's unit and axes; may be NaN
  std::vector<Vec3f> colours;                 ///< linear, per vertex; empty if the file has none
  std::vector<std::array<float, 2>> uvs;      ///< from the picture's upper left
  std::vector<std::uint32_t> corners;         ///< vertex indices, face after face; may point past the vertices
  std::vector<std::uint32_t> corner_uvs;      ///< into `uvs`, kNoIndex = none; empty, or one per corner
  std::vector<std::uint32_t> corner_counts;   ///< per face, at most kMaxCorners
  std::vector<std::uint32_t> face_materials;  ///< into `materials`; empty = all use the first
  std::vector<FileMaterial> materials;        ///< empty = one without a name
  std::vector<std::string> warnings;          ///< data left out, or read differently from the file
};

}  // namespace luxrig
