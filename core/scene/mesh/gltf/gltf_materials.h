#pragma once
/// Surface materials of a glTF. Internal to core/scene.

#include <array>
#include <map>
#include <string>
#include <vector>

#include "core/scene/mesh/gltf/gltf_accessors.h"
#include "core/scene/mesh/polygon_mesh.h"

namespace luxrig {

/// Placement of a material's picture on the mesh.
struct GltfPicture {
  int coordinates = 0;  ///< TEXCOORD_…
  std::array<double, 2> offset{0, 0}, scale{1, 1};
  double rotation_rad = 0;
};

class GltfMaterials {
 public:
  /// Both must outlive this.
  GltfMaterials(GltfDocument& document, const FilesBeside& beside) : document_(document), textures_(beside) {}

  /// The material of a primitive, read once, as an index into `mesh.materials`.
  std::uint32_t of_primitive(const nlohmann::json& primitive, PolygonMesh& mesh);
  /// For a material returned by of_primitive().
  [[nodiscard]] const GltfPicture& picture_of(std::uint32_t material) const { return pictures_[material]; }

 private:
  FileMaterial read(const nlohmann::json& from, GltfPicture& picture, std::vector<std::string>& warnings);
  std::shared_ptr<const Texture> texture_of(const nlohmann::json& info, GltfPicture& picture,
                                            std::vector<std::string>& warnings);

  GltfDocument& document_;
  TextureShelf textures_;
  std::map<std::size_t, std::uint32_t> known_;
  std::vector<GltfPicture> pictures_;
};

}  // namespace luxrig
