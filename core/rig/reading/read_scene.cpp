#include <fmt/format.h>

#include <array>

#include "core/rig/reading/rig_reader.h"

namespace luxrig {

void RigReader::read_mesh(Section& s, std::optional<MeshFile>& out) {
  if (!s.has("file")) {
    for (const char* key : {"unit", "up_axis"}) {
      s.refuse(key, fmt::format("{} has no effect without a file", key), "add the mesh file, or remove this key");
    }
    return;
  }
  static constexpr std::array kMetresPerUnit = {1.0, 0.01, 0.001, 0.0254, 0.3048};  // order of the schema's choices
  MeshFile mesh;
  std::size_t unit = 0;
  s.read_choice("unit", unit);
  mesh.metres_per_unit = kMetresPerUnit[unit];
  s.read_choice("up_axis", mesh.up_axis);
  if (const auto path = read_file(s, "file")) mesh.path = *path;
  out = std::move(mesh);
}

void RigReader::read_box_or_mesh(Section& s, SceneObject& object) {
  const bool box = s.has("box_m"), mesh = s.has("file");
  if (box == mesh) {
    problems.add(s.in_file(),
                 fmt::format("[[scene.object]] has {} box_m {} file", box ? "both" : "neither", box ? "and" : "nor"),
                 "give it either a box_m = [width, depth, height] or a mesh file");
  }
  if (box && !mesh) s.refuse("height_m", "height_m has no effect on a box", "the third number of box_m is the height");
  s.read("box_m", object.box_m);
  read_mesh(s, object.mesh);
  s.read("height_m", object.height_m);
}

void RigReader::read_scene() {
  each(root, "scene", [&](Section& scene) {
    rig.scene.in_file = scene.in_file();
    read_mesh(scene, rig.scene.mesh);
    scene.read("default_reflectance", rig.scene.default_reflectance_rgb);
    const Member* member = luxrig::find(root, "scene");
    const auto& table = std::get<NodeTable>(member->node.value);
    each(table, "scene.reflectance", [&](Section& s) {
      ReflectanceRule rule;
      rule.in_file = s.in_file();
      s.read("material", rule.material_pattern);
      s.read("reflectance", rule.reflectance_rgb);
      s.read("specular", rule.specular);
      s.read("roughness", rule.roughness);
      rig.scene.reflectances.push_back(std::move(rule));
    });
    each(table, "scene.object", [&](Section& s) {
      SceneObject object;
      object.in_file = s.in_file();
      if (s.read("name", object.name)) {
        objects.add(object.name, rig.scene.objects.size(), s.place_of("name"), problems);
      }
      read_box_or_mesh(s, object);
      s.read("position_m", object.position_world_m);
      s.read_deg("turn_deg", object.turn_rad);
      s.read("transmittance", object.transmittance);
      if (object.transmittance)
        s.refuse("reflectance", "reflectance has no effect on glass", "remove it, or transmittance");
      s.read("reflectance", object.reflectance_rgb);
      rig.scene.objects.push_back(std::move(object));
    });
  });
}

}  // namespace luxrig
