#include "core/rig/mvr/mvr_scenery.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>

#include "core/scene/mesh/mesh_reading.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxSceneryTriangles = 5'000'000, kMaxModelBytes = std::size_t{256} << 20;
constexpr std::size_t kMaxSceneryNotes = 50;

/// The archive's root, as the folder that holds the model.
class ArchiveBeside final : public FilesBeside {
 public:
  explicit ArchiveBeside(const ZipArchive& archive) : archive_(archive) {}
  std::optional<std::string> read(const std::string& name, std::size_t max_bytes) const override {
    const std::string* const entry = archive_.find(name);
    if (entry == nullptr) return std::nullopt;
    auto content = archive_.read(*entry, max_bytes);
    return content ? std::optional(std::move(*content)) : std::nullopt;
  }

 private:
  const ZipArchive& archive_;
};

class SceneryWriter {
 public:
  explicit SceneryWriter(const MvrFile& mvr) : mvr_(mvr) {}

  MvrScenery write() {
    if (!mvr_.archive || mvr_.scene.geometries.empty()) return {};
    obj_ = "# Scenery of an MVR file: metres, +Z up\nmtllib scene.mtl\n";
    mtl_ = "# Colours as linear light\n";
    for (const MvrGeometry& geometry : mvr_.scene.geometries) {
      if (out_.triangles > kMaxSceneryTriangles) {
        note("FILL IN: the scenery has more than five million triangles: the rest is left out");
        break;
      }
      const PolygonMesh* const model = model_of(geometry);
      if (model != nullptr) add(geometry, *model);
    }
    if (out_.triangles == 0) return {"", "", 0, 0, std::move(out_.notes)};
    out_.obj = std::move(obj_);
    out_.mtl = std::move(mtl_);
    return std::move(out_);
  }

 private:
  void note(std::string text) {
    if (out_.notes.size() < kMaxSceneryNotes) out_.notes.push_back(std::move(text));
  }

  /// Read once; null and one note if it cannot be read.
  const PolygonMesh* model_of(const MvrGeometry& geometry) {
    const auto [at, is_new] = models_.try_emplace(geometry.file);
    if (is_new) at->second = read_model(geometry);
    return at->second ? &*at->second : nullptr;
  }

  std::optional<PolygonMesh> read_model(const MvrGeometry& geometry) {
    const std::string* const entry = mvr_.archive->find(geometry.file, ".3ds");
    const std::string what = fmt::format("FILL IN: {}: model {}", in_quotes(geometry.object), in_quotes(geometry.file));
    if (entry == nullptr) {
      note(what + " is not in the archive: it is left out");
      return std::nullopt;
    }
    auto bytes = mvr_.archive->read(*entry, kMaxModelBytes);
    if (!bytes) {
      note(what + ": " + bytes.error().front().what + ": it is left out");
      return std::nullopt;
    }
    const ArchiveBeside beside(*mvr_.archive);
    auto mesh = read_mesh(std::move(*bytes), extension_of(*entry), *entry, beside);
    if (!mesh) {
      note(what + " " + mesh.error().front().what + ": it is left out");
      return std::nullopt;
    }
    for (const std::string& warning : mesh->warnings)
      note(fmt::format("model {}: {}", in_quotes(geometry.file), warning));
    mesh->warnings.clear();
    return std::move(*mesh);
  }

  void add(const MvrGeometry& geometry, const PolygonMesh& model) {
    Eigen::Affine3d metres_from_model = Eigen::Affine3d::Identity();
    const std::string extension = extension_of(geometry.file);
    if (extension == "glb" || extension == "gltf") {
      metres_from_model.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // +Y up to +Z up
    } else {
      metres_from_model.linear() *= 0.001;
    }
    const PlacedMesh placed = place_mesh(model, geometry.world_from_model_m * metres_from_model);
    if (placed.triangles.empty()) return;
    ++out_.models;
    out_.triangles += placed.triangles.size();
    obj_ += fmt::format("o {}\n", geometry.object.empty() ? "object" : geometry.object);
    for (const Vec3& at : placed.vertices_world_m)
      obj_ += fmt::format("v {:.6f} {:.6f} {:.6f}\n", at.x(), at.y(), at.z());
    std::vector<std::string> names;
    for (const Material& material : placed.materials) names.push_back(name_of_material(material));
    std::uint32_t current = kNoIndex;
    for (std::size_t i = 0; i < placed.triangles.size(); ++i) {
      const std::uint32_t material = placed.material_of_triangle[i];
      if (material != current) obj_ += fmt::format("usemtl {}\n", names[current = material]);
      const auto& [a, b, c] = placed.triangles[i];
      obj_ += fmt::format("f {} {} {}\n", vertices_ + a + 1, vertices_ + b + 1, vertices_ + c + 1);
    }
    vertices_ += placed.vertices_world_m.size();
  }

  /// Materials with the same name and colour are one. A second colour under the same name is called "NAME 2".
  std::string name_of_material(const Material& material) {
    std::array<long, 3> colour = {-1, -1, -1};
    if (material.coloured)
      for (std::size_t i = 0; i < 3; ++i)
        colour[i] = std::lround(1e4 * material.reflectance_rgb[static_cast<Eigen::Index>(i)]);
    const auto [at, is_new] = materials_.try_emplace({material.name, colour});
    if (!is_new) return at->second;
    const std::string base = material.name.empty() ? "unnamed" : material.name;
    std::string name = base;
    int& count = counts_[base];
    while (!taken_.insert(name).second) name = fmt::format("{} {}", base, ++count + 1);
    mtl_ += fmt::format("newmtl {}\n", name);
    if (material.coloured) {
      const Vec3& rgb = material.reflectance_rgb;
      mtl_ += fmt::format("Kd {:.4f} {:.4f} {:.4f}\n", rgb.x(), rgb.y(), rgb.z());
    }
    at->second = name;
    return name;
  }

  const MvrFile& mvr_;
  MvrScenery out_;
  std::string obj_, mtl_;
  std::size_t vertices_ = 0;
  std::map<std::string, std::optional<PolygonMesh>> models_;
  std::map<std::pair<std::string, std::array<long, 3>>, std::string> materials_;
  std::set<std::string> taken_;
  std::map<std::string, int> counts_;
};

}  // namespace

MvrScenery scenery_of_mvr(const MvrFile& mvr) { return SceneryWriter(mvr).write(); }

}  // namespace luxrig
