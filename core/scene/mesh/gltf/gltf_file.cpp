#include "core/scene/mesh/gltf/gltf_file.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/scene/mesh/gltf/gltf_accessors.h"
#include "core/scene/mesh/gltf/gltf_materials.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxGltfVertices = 3 * kMaxTriangles, kMaxNodes = 10'000'000, kMaxInstances = 10'000'000;

/// Extensions that may be required and do no harm: supported here, or irrelevant to light.
bool is_known(std::string_view extension) {
  if (extension == "KHR_mesh_quantization" || extension == "EXT_mesh_gpu_instancing" || extension == "KHR_xmp_json_ld")
    return true;
  for (const std::string_view family : {"KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_",
                                        "KHR_lights_", "EXT_lights_", "KHR_animation_"})
    if (extension.starts_with(family)) return true;
  return false;
}

Eigen::Matrix4d matrix_of_node(const nlohmann::json& node) {
  Eigen::Matrix4d out = Eigen::Matrix4d::Identity();
  if (const auto m = numbers_member(node, "matrix", 16)) {  // column by column
    out = Eigen::Map<const Eigen::Matrix4d>(m->data());
    return out;
  }
  if (const auto q = numbers_member(node, "rotation", 4)) {
    const Eigen::Quaterniond rotation((*q)[3], (*q)[0], (*q)[1], (*q)[2]);
    if (rotation.norm() > 0) out.topLeftCorner<3, 3>() = rotation.normalized().toRotationMatrix();
  }
  if (const auto s = numbers_member(node, "scale", 3))
    for (Eigen::Index i = 0; i < 3; ++i) out.col(i) *= (*s)[static_cast<std::size_t>(i)];
  if (const auto t = numbers_member(node, "translation", 3)) out.col(3).head<3>() = Vec3((*t)[0], (*t)[1], (*t)[2]);
  return out;
}

class GltfReader {
 public:
  GltfReader(GltfDocument document, const std::string& file, const FilesBeside& beside)
      : document_(std::move(document)), file_(file), materials_(document_, beside) {}

  Checked<PolygonMesh> read() {
    if (!check_extensions() || !read_scene()) {
      return tl::unexpected(std::vector<Problem>{{file_, 0, 0, std::move(refusal_.what), std::move(refusal_.mend)}});
    }
    if (!mesh_.colours.empty()) mesh_.colours.resize(mesh_.vertices.size(), Vec3f::Ones());
    if (!mesh_.corner_uvs.empty()) mesh_.corner_uvs.resize(mesh_.corners.size(), kNoIndex);
    return std::move(mesh_);
  }

 private:
  bool refuse(GltfRefusal why) {
    refusal_ = std::move(why);
    return false;
  }
  void warn(std::string text) {
    if (mesh_.warnings.size() < 100) mesh_.warnings.push_back(std::move(text));
  }

  bool check_extensions() {
    const nlohmann::json* const required = member_of(document_.root(), "extensionsRequired");
    if (required == nullptr || !required->is_array()) return true;
    for (const nlohmann::json& one : *required) {
      if (one.is_string() && !is_known(one.get_ref<const std::string&>()))
        return refuse(unread_extension(one.get<std::string>()));
    }
    return true;
  }

  bool read_scene() {
    const auto wanted = index_member(document_.root(), "scene");
    const nlohmann::json* const scene = document_.entry("scenes", wanted.value_or(0));
    const nlohmann::json* const all = member_of(document_.root(), "nodes");
    const std::size_t count = all != nullptr && all->is_array() ? all->size() : 0;
    if (count > kMaxNodes) return refuse({"has more than ten million nodes", "give a simplified scene"});
    std::vector<std::pair<std::size_t, Eigen::Matrix4d>> open;
    std::vector<bool> seen(count);
    const auto push = [&](const nlohmann::json* list, const Eigen::Matrix4d& parent) {
      if (list == nullptr || !list->is_array()) return;
      for (auto one = list->rbegin(); one != list->rend(); ++one) {  // last first: popped in file order
        const std::size_t node = one->is_number_unsigned() ? one->get<std::size_t>() : count;
        if (node >= count) {
          warn("a node that is not there is left out");
        } else if (seen[node]) {
          warn("node " + std::to_string(node) + " hangs in two places: it is taken once");
        } else {
          seen[node] = true;
          open.emplace_back(node, parent);
        }
      }
    };
    const Eigen::Matrix4d world = Eigen::Matrix4d::Identity();
    if (scene != nullptr) {
      push(member_of(*scene, "nodes"), world);
    } else {  // no scene: take all nodes without a parent
      std::vector<bool> child(count);
      for (std::size_t i = 0; i < count; ++i) {
        const nlohmann::json* const children = member_of((*all)[i], "children");
        if (children == nullptr || !children->is_array()) continue;
        for (const nlohmann::json& one : *children)
          if (one.is_number_unsigned() && one.get<std::size_t>() < count) child[one.get<std::size_t>()] = true;
      }
      for (std::size_t i = count; i-- > 0;) {
        if (child[i]) continue;
        seen[i] = true;
        open.emplace_back(i, world);
      }
    }
    while (!open.empty()) {
      const auto [index, parent] = open.back();
      open.pop_back();
      const nlohmann::json& node = (*all)[index];
      const Eigen::Matrix4d root_from_node = parent * matrix_of_node(node);
      if (!read_node(node, root_from_node)) return false;
      push(member_of(node, "children"), root_from_node);
    }
    return true;
  }

  bool read_node(const nlohmann::json& node, const Eigen::Matrix4d& root_from_node) {
    const auto index = index_member(node, "mesh");
    if (!index) return true;
    const nlohmann::json* const mesh = document_.entry("meshes", *index);
    if (mesh == nullptr)
      return refuse({"names mesh " + std::to_string(*index) + ", which is not there", "export it again"});
    if (member_of(node, "skin") != nullptr && !skins_++) warn("skins are read as they are bound, without a pose");
    const auto places = instances(node, root_from_node);
    if (!places) return false;
    const nlohmann::json* const primitives = member_of(*mesh, "primitives");
    if (primitives == nullptr || !primitives->is_array()) return true;
    for (const nlohmann::json& primitive : *primitives)
      if (!read_primitive(primitive, *places)) return false;
    return true;
  }

  /// Places where a node shows its mesh: one, or those of EXT_mesh_gpu_instancing.
  std::optional<std::vector<Eigen::Matrix4d>> instances(const nlohmann::json& node, const Eigen::Matrix4d& here) {
    const nlohmann::json* const extensions = member_of(node, "extensions");
    const nlohmann::json* const many =
        extensions != nullptr ? member_of(*extensions, "EXT_mesh_gpu_instancing") : nullptr;
    if (many == nullptr) return std::vector<Eigen::Matrix4d>{here};
    const nlohmann::json* const attributes = member_of(*many, "attributes");
    std::array<std::optional<Accessor>, 3> parts;
    static constexpr std::array kNames = {"TRANSLATION", "ROTATION", "SCALE"};
    std::optional<std::size_t> count;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto index = attributes != nullptr ? index_member(*attributes, kNames[i]) : std::nullopt;
      if (!index) continue;
      auto accessor = document_.accessor(*index);
      if (!accessor) {
        refuse(accessor.error());
        return std::nullopt;
      }
      if (accessor->components() != (i == 1 ? 4u : 3u) || (count && *count != accessor->count())) {
        refuse({"has instances (EXT_mesh_gpu_instancing) whose places do not fit together", "export it again"});
        return std::nullopt;
      }
      count = accessor->count();
      parts[i] = std::move(*accessor);
    }
    if (!count) return std::vector<Eigen::Matrix4d>{here};
    instances_ += *count;
    if (instances_ > kMaxInstances) {
      refuse({"has more than ten million instances", "give a simplified scene"});
      return std::nullopt;
    }
    std::vector<Eigen::Matrix4d> places;
    for (std::size_t i = 0; i < *count; ++i) {
      Eigen::Matrix4d own = Eigen::Matrix4d::Identity();
      if (parts[1]) {
        const Accessor& q = *parts[1];
        const Eigen::Quaterniond rotation(q.at(i, 3), q.at(i, 0), q.at(i, 1), q.at(i, 2));
        if (rotation.norm() > 0) own.topLeftCorner<3, 3>() = rotation.normalized().toRotationMatrix();
      }
      if (parts[2])
        for (Eigen::Index axis = 0; axis < 3; ++axis) own.col(axis) *= parts[2]->at(i, static_cast<std::size_t>(axis));
      if (parts[0]) own.col(3).head<3>() = Vec3(parts[0]->at(i, 0), parts[0]->at(i, 1), parts[0]->at(i, 2));
      places.push_back(here * own);
    }
    return places;
  }

  std::optional<Accessor> attribute(const nlohmann::json& primitive, const std::string& name, bool& failed) {
    const nlohmann::json* const attributes = member_of(primitive, "attributes");
    const auto index = attributes != nullptr ? index_member(*attributes, name.c_str()) : std::nullopt;
    if (!index) return std::nullopt;
    auto accessor = document_.accessor(*index);
    if (accessor) return std::move(*accessor);
    failed = true;
    refuse(accessor.error());
    return std::nullopt;
  }

  /// Draco's data replaces that of the accessors, unless the exporter wrote both.
  bool check_draco(const nlohmann::json& primitive) {
    const nlohmann::json* const attributes = member_of(primitive, "attributes");
    const auto position = attributes != nullptr ? index_member(*attributes, "POSITION") : std::nullopt;
    const nlohmann::json* const accessor = position ? document_.entry("accessors", *position) : nullptr;
    const nlohmann::json* const extensions = member_of(primitive, "extensions");
    if (accessor == nullptr || extensions == nullptr || index_member(*accessor, "bufferView")) return true;
    const char* const draco = "KHR_draco_mesh_compression";
    return member_of(*extensions, draco) == nullptr || refuse(unread_extension(draco));
  }

  bool read_primitive(const nlohmann::json& primitive, const std::vector<Eigen::Matrix4d>& places) {
    const double mode = number_member(primitive, "mode", 4);
    if (mode != 4 && mode != 5 && mode != 6) return true;  // points and lines reflect no light
    if (!check_draco(primitive)) return false;
    bool failed = false;
    const auto positions = attribute(primitive, "POSITION", failed);
    if (failed) return false;
    if (!positions || positions->components() != 3) return true;
    const std::uint32_t material = materials_.of_primitive(primitive, mesh_);
    const auto colours = attribute(primitive, "COLOR_0", failed);
    std::optional<Accessor> uvs;
    if (mesh_.materials[material].texture)
      uvs = attribute(primitive, "TEXCOORD_" + std::to_string(materials_.picture_of(material).coordinates), failed);
    std::optional<Accessor> indices;
    if (const auto index = index_member(primitive, "indices")) {
      auto accessor = document_.accessor(*index);
      if (!accessor) return refuse(accessor.error());
      if (!accessor->is_index()) return refuse({"has indices that are no whole numbers", "export it again"});
      indices = std::move(*accessor);
    }
    if (failed) return false;
    const std::size_t rows = positions->count(), corners = indices ? indices->count() : rows;
    const std::size_t triangles = mode == 4 ? corners / 3 : corners < 3 ? 0 : corners - 2;
    if (rows > 0 && (places.size() > (kMaxGltfVertices - mesh_.vertices.size()) / rows))
      return refuse({"has more than 150 million vertices", "give a simplified mesh"});
    if (triangles > 0 && places.size() > (kMaxTriangles - mesh_.corner_counts.size()) / triangles)
      return refuse({"has more than 50 million triangles", "give a simplified mesh"});
    const std::size_t uv_base = mesh_.uvs.size();
    if (uvs && uvs->components() == 2 && uvs->count() == rows) {
      add_uvs(*uvs, materials_.picture_of(material));
      mesh_.corner_uvs.resize(mesh_.corners.size(), kNoIndex);
    } else {
      uvs.reset();
    }
    for (const Eigen::Matrix4d& place : places) {
      const std::size_t base = mesh_.vertices.size();
      for (std::size_t i = 0; i < rows; ++i) {
        const Eigen::Vector4d at(positions->at(i, 0), positions->at(i, 1), positions->at(i, 2), 1);
        mesh_.vertices.emplace_back((place * at).head<3>());
      }
      if (colours && colours->components() >= 3 && colours->count() == rows) add_colours(*colours, base);
      const auto corner = [&](std::size_t i) {
        const std::size_t row = indices ? indices->index_at(i) : i;
        mesh_.corners.push_back(row < rows ? static_cast<std::uint32_t>(base + row) : kNoIndex);
        if (uvs) mesh_.corner_uvs.push_back(row < rows ? static_cast<std::uint32_t>(uv_base + row) : kNoIndex);
      };
      for (std::size_t i = 0; i < triangles; ++i) {
        if (mode == 4) {
          corner(3 * i), corner(3 * i + 1), corner(3 * i + 2);
        } else if (mode == 5) {  // a strip: every second triangle has the opposite winding
          corner(i), corner(i + 1 + i % 2), corner(i + 2 - i % 2);
        } else {
          corner(0), corner(i + 1), corner(i + 2);
        }
        mesh_.corner_counts.push_back(3);
        mesh_.face_materials.push_back(material);
      }
    }
    return true;
  }

  void add_uvs(const Accessor& uvs, const GltfPicture& picture) {
    const double cosine = std::cos(picture.rotation_rad), sine = std::sin(picture.rotation_rad);
    for (std::size_t i = 0; i < uvs.count(); ++i) {
      const double u = picture.scale[0] * uvs.at(i, 0), v = picture.scale[1] * uvs.at(i, 1);
      mesh_.uvs.push_back({static_cast<float>(cosine * u + sine * v + picture.offset[0]),
                           static_cast<float>(-sine * u + cosine * v + picture.offset[1])});
    }
  }

  void add_colours(const Accessor& colours, std::size_t base) {
    mesh_.colours.resize(base, Vec3f::Ones());
    for (std::size_t i = 0; i < colours.count(); ++i) {
      Vec3f colour;
      for (std::size_t part = 0; part < 3; ++part)
        colour[static_cast<Eigen::Index>(part)] = static_cast<float>(std::clamp(colours.at(i, part), 0.0, 1.0));
      mesh_.colours.push_back(colour.allFinite() ? colour : Vec3f(Vec3f::Ones()));
    }
  }

  GltfDocument document_;
  const std::string& file_;
  GltfMaterials materials_;
  PolygonMesh mesh_;
  GltfRefusal refusal_;
  std::size_t instances_ = 0;
  int skins_ = 0;
};

}  // namespace

Checked<PolygonMesh> read_gltf(std::string bytes, const std::string& file, const FilesBeside& beside) {
  auto document = GltfDocument::open(std::move(bytes), file, beside);
  if (!document) return tl::unexpected(std::move(document.error()));
  return GltfReader(std::move(*document), file, beside).read();
}

}  // namespace luxrig
