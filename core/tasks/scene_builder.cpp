#include "core/tasks/scene_builder.h"

#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/scene/large_faces.h"
#include "core/scene/mesh/mesh_reading.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

/// A scene that extends no farther than this from its middle has the middle as origin: float resolves 8 µm there.
constexpr double kFarFromMiddle_m = 100;

/// A closed box about the origin, normals outwards; its one material has the object's name.
PlacedMesh box(const std::string& name, const Vec3& size_m) {
  PlacedMesh part;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 sign((corner & 1) ? 0.5 : -0.5, (corner & 2) ? 0.5 : -0.5, (corner & 4) ? 0.5 : -0.5);
    part.vertices_world_m.push_back(sign.cwiseProduct(size_m));
  }
  part.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  part.material_of_triangle.assign(part.triangles.size(), 0);
  part.materials.resize(1);
  part.materials.front().name = name;
  return part;
}

class Builder {
 public:
  explicit Builder(const Rig& rig) : rig_(rig), rule_used_(rig.scene.reflectances.size(), false) {}

  Checked<Scene> build() {
    scene_.object_names.emplace_back("scene");
    if (rig_.scene.mesh) {
      if (auto part = load(*rig_.scene.mesh, "scene", rig_.scene.in_file)) {
        set_reflectances(*part, "scene", std::nullopt);
        parts_.emplace_back(0, std::move(*part));
      }
    }
    for (const SceneObject& object : rig_.scene.objects) add(object);
    if (!problems_.empty()) return tl::unexpected(std::move(problems_));
    warn_of_idle_rules();
    join();
    if (!problems_.empty()) return tl::unexpected(std::move(problems_));
    return std::move(scene_);
  }

 private:
  void problem(const FilePosition& in_file, std::string what, std::string mend) {
    problems_.push_back({rig_.file.string(), in_file.line, in_file.column, std::move(what), std::move(mend)});
  }

  std::optional<PlacedMesh> load(const MeshFile& file, const std::string& name, const FilePosition& in_file) {
    auto mesh = load_placed_mesh(file);
    if (!mesh) {
      for (Problem& one : mesh.error()) {
        std::string where = one.line > 0 ? ", line " + std::to_string(one.line) : "";
        if (one.line > 0 && one.column > 0) where += ", column " + std::to_string(one.column);
        problem(in_file, name + ": " + one.file + where + " " + one.what, std::move(one.mend));
      }
      return std::nullopt;
    }
    for (const std::string& warning : mesh->warnings) scene_.warnings.push_back(name + ": " + warning);
    return std::move(*mesh);
  }

  void add(const SceneObject& object) {
    const auto index = static_cast<std::uint32_t>(scene_.object_names.size());
    scene_.object_names.push_back(object.name);
    if (!object.position_world_m.allFinite() || !std::isfinite(object.turn_rad)) {
      problem(object.in_file, "object '" + object.name + "' stands nowhere", "give a finite position and turn");
      return;
    }
    std::optional<PlacedMesh> part;
    if (object.mesh) {
      part = load(*object.mesh, "object '" + object.name + "'", object.in_file);
    } else if (object.box_m.allFinite() && object.box_m.minCoeff() > 0) {
      part = box(object.name, object.box_m);
    } else {
      problem(object.in_file, "object '" + object.name + "' is a box without volume", "give three lengths above 0");
    }
    if (!part || !place(object, *part)) return;
    if (object.transmittance) return glaze(*part, *object.transmittance, index);
    set_reflectances(*part, "object '" + object.name + "'", object.reflectance_rgb);
    parts_.emplace_back(index, std::move(*part));
  }

  void glaze(const PlacedMesh& part, double transmittance, std::uint32_t object) {
    for (const auto& [a, b, c] : part.triangles)
      scene_.panes.push_back(
          {{part.vertices_world_m[a], part.vertices_world_m[b], part.vertices_world_m[c]}, transmittance, object});
  }

  /// Scales evenly to the wanted height, then puts the middle of its underside at the object's position.
  bool place(const SceneObject& object, PlacedMesh& part) {
    const Eigen::AlignedBox3d bounds = bounds_of(part);
    double scale = 1;
    if (object.height_m) {
      const double height_m = bounds.sizes().z();
      scale = *object.height_m / height_m;
      if (!(height_m > 0) || !std::isfinite(scale) || !(scale > 0)) {
        problem(object.in_file, "object '" + object.name + "' is flat and cannot be scaled to a height",
                "leave height_m out, or correct up_axis");
        return false;
      }
    }
    const Vec3 foot(bounds.center().x(), bounds.center().y(), bounds.min().z());
    const Mat3 turn = Eigen::AngleAxisd(object.turn_rad, Vec3::UnitZ()).toRotationMatrix();
    for (Vec3& vertex : part.vertices_world_m) {
      vertex = object.position_world_m + turn * (scale * (vertex - foot));
    }
    return true;
  }

  void set_reflectances(PlacedMesh& part, const std::string& whose, const std::optional<Vec3>& of_object) {
    for (Material& material : part.materials) {
      const Vec3* stated = of_object ? &*of_object : nullptr;
      for (std::size_t i = 0; i < rig_.scene.reflectances.size(); ++i) {
        const ReflectanceRule& rule = rig_.scene.reflectances[i];
        if (fnmatch(rule.material_pattern.c_str(), material.name.c_str(), 0) != 0) continue;
        rule_used_[i] = true;
        if (stated != nullptr) continue;
        stated = &rule.reflectance_rgb;
        material.specular_reflectance = rule.specular;
        material.roughness = rule.roughness;
      }
      if (stated != nullptr) {
        material.coloured = true;
      } else if (!material.coloured) {
        stated = &rig_.scene.default_reflectance_rgb;
      }
      if (stated == nullptr) {  // the file's value counts
        if (material.too_bright) {
          scene_.warnings.push_back(whose + ": material " + in_quotes(material.name) +
                                    ": its colour above 0.95 is taken as 0.95");
        }
        continue;
      }
      material.reflectance_rgb = stated->cwiseMax(0.0).cwiseMin(kMaxReflectance);
      if (stated->maxCoeff() > kMaxReflectance) {
        scene_.warnings.push_back("material '" + material.name + "': reflectance above 0.95 is taken as 0.95");
      }
    }
    for (Material& material : part.materials)
      for (const auto& [name, ratio] : rig_.scene.paint)
        if (name == material.name)
          material.reflectance_rgb = (ratio * material.reflectance_rgb).cwiseMin(kMaxReflectance);
  }

  void warn_of_idle_rules() {
    for (std::size_t i = 0; i < rule_used_.size(); ++i) {
      if (rule_used_[i]) continue;
      const ReflectanceRule& rule = rig_.scene.reflectances[i];
      scene_.warnings.push_back("line " + std::to_string(rule.in_file.line) + ": reflectance rule '" +
                                rule.material_pattern + "' matches no material");
    }
  }

  /// Joins the parts around an origin that keeps floats small where it matters.
  void join() {
    Eigen::AlignedBox3d bounds;
    for (const auto& [object, part] : parts_) bounds.extend(bounds_of(part));
    if (bounds.isEmpty()) return;
    const bool reaches_far = bounds.sizes().maxCoeff() > 2 * kFarFromMiddle_m;
    scene_.origin_world_m = reaches_far ? middle_of_use(bounds) : bounds.center();
    for (auto& [object, part] : parts_) {
      if (reaches_far && !cut_large_faces(scene_.origin_world_m, part))
        return problem(place_of(object), in_quotes(scene_.object_names[object]) + " has too many faces of over 50 m",
                       "give a mesh without what lies far around the venue");
      append_rounded(part, object, scene_);
    }
  }

  /// The median of all that the rig hangs and measures. Without any, the median of all triangle corners: they are many
  /// where a venue is modelled and few in the ground around. A single far-off thing does not move a median.
  [[nodiscard]] Vec3 middle_of_use(const Eigen::AlignedBox3d& bounds) const {
    std::vector<Vec3> places;
    for (const Fixture& fixture : rig_.fixtures) places.push_back(fixture.world_from_lamp().translation_m);
    for (const Point& point : rig_.points) places.push_back(point.position_world_m);
    for (const Luxmeter& meter : rig_.luxmeters) places.push_back(meter.position_world_m);
    if (places.empty())
      for (const auto& [object, part] : parts_)
        for (const auto& triangle : part.triangles)
          for (const std::uint32_t vertex : triangle) places.push_back(part.vertices_world_m[vertex]);
    const auto half = places.begin() + static_cast<std::ptrdiff_t>(places.size() / 2);
    Vec3 middle;
    for (int axis = 0; axis < 3; ++axis) {
      std::nth_element(places.begin(), half, places.end(),
                       [axis](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; });
      middle[axis] = (*half)[axis];
    }
    return middle.cwiseMax(bounds.min()).cwiseMin(bounds.max());
  }

  [[nodiscard]] const FilePosition& place_of(std::uint32_t object) const {
    return object == 0 ? rig_.scene.in_file : rig_.scene.objects[object - 1].in_file;
  }

  const Rig& rig_;
  Scene scene_;
  std::vector<std::pair<std::uint32_t, PlacedMesh>> parts_;  // with the index of their object
  std::vector<bool> rule_used_;
  std::vector<Problem> problems_;
};

}  // namespace

Checked<Scene> build_scene(const Rig& rig) { return Builder(rig).build(); }

}  // namespace luxrig
