#include "core/scene/mesh/gltf/gltf_materials.h"

#include <algorithm>

#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr std::size_t kNoMaterial = static_cast<std::size_t>(-1);

const nlohmann::json* extension_of_gltf(const nlohmann::json& object, const char* name) {
  const nlohmann::json* const all = member_of(object, "extensions");
  return all != nullptr ? member_of(*all, name) : nullptr;
}

}  // namespace

std::uint32_t GltfMaterials::of_primitive(const nlohmann::json& primitive, PolygonMesh& mesh) {
  const std::size_t index = index_member(primitive, "material").value_or(kNoMaterial);
  const auto [at, is_new] = known_.try_emplace(index, static_cast<std::uint32_t>(mesh.materials.size()));
  if (!is_new) return at->second;
  const nlohmann::json* const from = index == kNoMaterial ? nullptr : document_.entry("materials", index);
  pictures_.emplace_back();
  mesh.materials.push_back(from != nullptr ? read(*from, pictures_.back(), mesh.warnings) : FileMaterial{});
  return at->second;
}

FileMaterial GltfMaterials::read(const nlohmann::json& from, GltfPicture& picture, std::vector<std::string>& warnings) {
  static const nlohmann::json kNone = nlohmann::json::object();
  FileMaterial material;
  material.name = made_plain(text_member(from, "name"));
  const std::string name = "material " + in_quotes(material.name);
  const auto warn = [&](const std::string& text) {
    if (warnings.size() < 100) warnings.push_back(name + text);
  };
  // The older form stands beside the newer one, for programs that support it, and takes precedence.
  const nlohmann::json* const older = extension_of_gltf(from, "KHR_materials_pbrSpecularGlossiness");
  const nlohmann::json* const newer = member_of(from, "pbrMetallicRoughness");
  const nlohmann::json& look = older != nullptr ? *older : newer != nullptr ? *newer : kNone;
  const auto factor = numbers_member(look, older != nullptr ? "diffuseFactor" : "baseColorFactor", 4);
  material.colour = factor ? Vec3((*factor)[0], (*factor)[1], (*factor)[2]) : Vec3(Vec3::Ones());
  if (older != nullptr) {
    const auto specular = numbers_member(look, "specularFactor", 3);
    if (!specular || std::max({(*specular)[0], (*specular)[1], (*specular)[2]}) > 0.05 ||
        member_of(look, "specularGlossinessTexture") != nullptr)
      warn(" has a specular colour (KHR_materials_pbrSpecularGlossiness): left out, the diffuse one is taken");
  }
  const nlohmann::json* const info = member_of(look, older != nullptr ? "diffuseTexture" : "baseColorTexture");
  if (info != nullptr) {
    material.texture = texture_of(*info, picture, warnings);
    material.unknown = material.texture == nullptr;
  }
  const std::string alpha = text_member(from, "alphaMode");
  const nlohmann::json* const passes = extension_of_gltf(from, "KHR_materials_transmission");
  if ((passes != nullptr && number_member(*passes, "transmissionFactor", 0) > 0) ||
      (alpha == "BLEND" && factor && (*factor)[3] < 1)) {
    warn(" is transparent: taken as opaque; a pane is a [[scene.object]] with transmittance");
  } else if (alpha == "MASK" || alpha == "BLEND") {
    warn(" may have holes in its picture (alphaMode " + alpha + "): taken as opaque");
  }
  const auto glow = numbers_member(from, "emissiveFactor", 3);
  if (glow && std::max({(*glow)[0], (*glow)[1], (*glow)[2]}) > 0)
    warn(" gives light (emissiveFactor): left out, light comes from [[fixture]] entries");
  return material;
}

std::shared_ptr<const Texture> GltfMaterials::texture_of(const nlohmann::json& info, GltfPicture& picture,
                                                         std::vector<std::string>& warnings) {
  picture.coordinates = static_cast<int>(std::min<std::size_t>(index_member(info, "texCoord").value_or(0), 1000));
  if (const nlohmann::json* const moved = extension_of_gltf(info, "KHR_texture_transform")) {
    if (const auto offset = numbers_member(*moved, "offset", 2)) picture.offset = {(*offset)[0], (*offset)[1]};
    if (const auto scale = numbers_member(*moved, "scale", 2)) picture.scale = {(*scale)[0], (*scale)[1]};
    picture.rotation_rad = number_member(*moved, "rotation", 0);
    picture.coordinates = static_cast<int>(std::min<std::size_t>(
        index_member(*moved, "texCoord").value_or(static_cast<std::size_t>(picture.coordinates)), 1000));
  }
  const auto index = index_member(info, "index");
  const nlohmann::json* const texture = index ? document_.entry("textures", *index) : nullptr;
  if (texture == nullptr) return nullptr;
  auto source = index_member(*texture, "source");
  for (const char* const other : {"KHR_texture_basisu", "EXT_texture_webp", "MSFT_texture_dds"}) {
    const nlohmann::json* const extension = source ? nullptr : extension_of_gltf(*texture, other);
    if (extension != nullptr) source = index_member(*extension, "source");
  }
  const nlohmann::json* const image = source ? document_.entry("images", *source) : nullptr;
  if (image == nullptr) return nullptr;
  const std::string uri = text_member(*image, "uri");
  std::string name = text_member(*image, "name");
  if (name.empty()) name = "image " + std::to_string(*source);
  name += ", no. " + std::to_string(*source);  // two may share a name
  if (const auto data = GltfDocument::data_of_uri(uri)) return textures_.of_bytes(name, *data, warnings);
  if (!uri.empty() && !uri.starts_with("data:")) return textures_.of_file(GltfDocument::name_of_uri(uri), warnings);
  const auto in = index_member(*image, "bufferView");
  if (!in) return nullptr;
  const auto bytes = document_.view(*in);
  return bytes ? textures_.of_bytes(name, *bytes, warnings) : nullptr;
}

}  // namespace luxrig
