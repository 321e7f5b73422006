#include "core/scene/scene_glb.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

namespace luxrig {
namespace {

constexpr int kFloat = 5126, kUint32 = 5125, kVertices = 34962, kIndices = 34963;
constexpr std::size_t kContainerBytes = 28;  // header, and the heads of two chunks

Vec3f y_up(const Vec3f& v) { return {v.x(), v.z(), -v.y()}; }

nlohmann::json listed(const Vec3f& v) { return {v.x(), v.y(), v.z()}; }

template <class T>
void put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

class GlbWriter {
 public:
  explicit GlbWriter(const Scene& scene) : scene_(scene) {}

  std::string write() {
    nlohmann::json nodes = nlohmann::json::array();
    binary_.reserve(scene_.vertices_m.size() * sizeof(Vec3f) + scene_.triangles.size() * 12 + scene_.panes.size() * 48);
    if (!scene_.triangles.empty()) add_surfaces(nodes);
    if (!scene_.panes.empty()) add_panes(nodes);
    const Vec3& o = scene_.origin_world_m;
    for (auto& node : nodes)
      if (!o.isZero(0)) node["translation"] = {o.x(), o.z(), -o.y()};
    nlohmann::json shown = nlohmann::json::array();
    for (std::size_t i = 0; i < nodes.size(); ++i) shown.push_back(i);
    root_["nodes"] = std::move(nodes);
    root_["scenes"] = {{{"nodes", std::move(shown)}}};
    root_["scene"] = 0;
    root_["asset"] = {{"version", "2.0"}, {"generator", "luxrig"}};
    root_["buffers"] = {{{"byteLength", binary_.size()}}};
    std::string text = root_.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    while (text.size() % 4 != 0) text += ' ';
    std::string glb;
    glb.reserve(kContainerBytes + text.size() + binary_.size());
    glb += "glTF";
    put(glb, std::uint32_t{2});
    put(glb, static_cast<std::uint32_t>(kContainerBytes + text.size() + binary_.size()));
    put(glb, static_cast<std::uint32_t>(text.size()));
    glb += "JSON" + text;
    put(glb, static_cast<std::uint32_t>(binary_.size()));
    glb.append("BIN\0", 4);
    return glb += binary_;  // all of it is words of 4 bytes
  }

 private:
  std::size_t add_accessor(const std::string& bytes, int component, const char* type, std::size_t count, int target) {
    root_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes.size()}, {"target", target}});
    binary_ += bytes;
    root_["accessors"].push_back({{"bufferView", root_["bufferViews"].size() - 1},
                                  {"componentType", component},
                                  {"type", type},
                                  {"count", count}});
    return root_["accessors"].size() - 1;
  }

  std::size_t add_positions(const std::vector<Vec3f>& vertices_m) {
    std::string bytes;
    bytes.reserve(vertices_m.size() * sizeof(Vec3f));
    Vec3f least = y_up(vertices_m.front()), most = least;
    for (const Vec3f& vertex : vertices_m) {
      const Vec3f turned = y_up(vertex);
      least = least.cwiseMin(turned);
      most = most.cwiseMax(turned);
      for (int axis = 0; axis < 3; ++axis) put(bytes, turned[axis]);
    }
    const std::size_t at = add_accessor(bytes, kFloat, "VEC3", vertices_m.size(), kVertices);
    root_["accessors"][at]["min"] = listed(least);
    root_["accessors"][at]["max"] = listed(most);
    return at;
  }

  void add_mesh(nlohmann::json& nodes, const char* name, nlohmann::json primitives) {
    root_["meshes"].push_back({{"name", name}, {"primitives", std::move(primitives)}});
    nodes.push_back({{"name", name}, {"mesh", root_["meshes"].size() - 1}});
  }

  std::size_t add_material(const std::string& name, const Vec3& colour, double alpha, double roughness) {
    nlohmann::json material = {{"name", name},
                               {"doubleSided", true},
                               {"pbrMetallicRoughness",
                                {{"baseColorFactor", {colour.x(), colour.y(), colour.z(), alpha}},
                                 {"metallicFactor", 0},
                                 {"roughnessFactor", roughness}}}};
    if (alpha < 1) material["alphaMode"] = "BLEND";
    root_["materials"].push_back(std::move(material));
    return root_["materials"].size() - 1;
  }

  void add_surfaces(nlohmann::json& nodes) {
    const std::size_t positions = add_positions(scene_.vertices_m);
    std::vector<std::string> indices(scene_.materials.size());
    for (std::size_t i = 0; i < scene_.triangles.size(); ++i)
      for (const std::uint32_t index : scene_.triangles[i]) put(indices[scene_.material_of_triangle[i]], index);
    nlohmann::json primitives = nlohmann::json::array();
    for (std::size_t m = 0; m < indices.size(); ++m) {
      if (indices[m].empty()) continue;
      const Material& material = scene_.materials[m];
      const std::size_t count = indices[m].size() / sizeof(std::uint32_t);
      const std::size_t at = add_accessor(indices[m], kUint32, "SCALAR", count, kIndices);
      indices[m] = {};
      // glTF's roughness is the root of α.
      const double roughness = material.specular_reflectance > 0 ? std::sqrt(material.roughness) : 1;
      primitives.push_back({{"attributes", {{"POSITION", positions}}},
                            {"indices", at},
                            {"material", add_material(material.name, material.reflectance_rgb, 1, roughness)}});
    }
    add_mesh(nodes, "surfaces", std::move(primitives));
  }

  void add_panes(nlohmann::json& nodes) {
    std::vector<Vec3f> corners_m;
    std::string indices;
    double clearest = 0;
    for (const Pane& pane : scene_.panes) {
      clearest = std::max(clearest, pane.transmittance);
      for (const Vec3& corner : pane.corners_world_m) {
        put(indices, static_cast<std::uint32_t>(corners_m.size()));
        corners_m.emplace_back((corner - scene_.origin_world_m).cast<float>());
      }
    }
    const std::size_t positions = add_positions(corners_m);
    const std::size_t at = add_accessor(indices, kUint32, "SCALAR", corners_m.size(), kIndices);
    const std::size_t glass = add_material("glass", Vec3::Constant(0.9), std::clamp(1 - clearest, 0.05, 0.9), 0.1);
    add_mesh(nodes, "panes", {{{"attributes", {{"POSITION", positions}}}, {"indices", at}, {"material", glass}}});
  }

  const Scene& scene_;
  nlohmann::json root_ = nlohmann::json::object();
  std::string binary_;
};

}  // namespace

std::string scene_glb(const Scene& scene, std::size_t max_bytes) {
  if (scene.triangles.empty() && scene.panes.empty()) return {};
  const std::size_t numbers = scene.triangles.empty() ? 0 : 12 * (scene.vertices_m.size() + scene.triangles.size());
  if (numbers + 48 * scene.panes.size() > std::min<std::size_t>(max_bytes, std::size_t{4000} << 20)) return {};
  std::string glb = GlbWriter(scene).write();
  if (glb.size() > max_bytes) glb.clear();
  return glb;
}

}  // namespace luxrig
