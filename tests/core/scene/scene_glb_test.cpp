#include "core/scene/scene_glb.h"

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <random>

#include "core/scene/mesh/mesh_file.h"
#include "core/scene/mesh/mesh_reading.h"

namespace luxrig {
namespace {

class GlbNothingBeside final : public FilesBeside {
 public:
  [[nodiscard]] std::optional<std::string> read(const std::string&, std::size_t) const override { return {}; }
};

/// As load_mesh() reads it: by world, from the bytes.
PlacedMesh read_again(const std::string& glb) {
  auto mesh = read_mesh(glb, "glb", "scene.glb", GlbNothingBeside{});
  EXPECT_TRUE(mesh) << (mesh ? "" : mesh.error()[0].text());
  Eigen::Affine3d world_from_mesh = Eigen::Affine3d::Identity();
  world_from_mesh.linear() = Eigen::AngleAxisd(kPi / 2, Vec3::UnitX()).toRotationMatrix();
  return mesh ? place_mesh(std::move(*mesh), world_from_mesh) : PlacedMesh{};
}

Scene random_scene(unsigned seed, std::size_t triangles, std::size_t materials) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-20, 20);
  std::uniform_real_distribution<double> share(0.02, 0.94);
  Scene scene;
  for (std::size_t m = 0; m < materials; ++m) {
    Material material;
    material.name = "paint \"" + std::to_string(m) + "\" ä";
    material.reflectance_rgb = {share(random), share(random), share(random)};
    scene.materials.push_back(material);
  }
  for (std::size_t v = 0; v < triangles + 2; ++v)
    scene.vertices_m.emplace_back(place(random), place(random), place(random));
  for (std::uint32_t t = 0; t < triangles; ++t) {
    scene.triangles.push_back({t, t + 1, t + 2});
    scene.material_of_triangle.push_back(static_cast<std::uint32_t>(random() % materials));
    scene.object_of_triangle.push_back(0);
  }
  return scene;
}

TEST(SceneGlb, IsReadAgainAsTheSameTrianglesAndMaterials) {
  for (const Vec3& origin : {Vec3(0, 0, 0), Vec3(3.5e6, -5.25e6, 412)}) {
    Scene scene = random_scene(7, 500, 4);
    scene.origin_world_m = origin;
    const PlacedMesh again = read_again(scene_glb(scene));
    EXPECT_EQ(again.cleaning.total(), 0u);
    ASSERT_EQ(again.triangles.size(), scene.triangles.size());
    ASSERT_EQ(again.materials.size(), scene.materials.size());
    std::size_t at = 0;  // triangles are grouped by material, in order
    for (std::uint32_t m = 0; m < scene.materials.size(); ++m) {
      EXPECT_EQ(again.materials[m].name, scene.materials[m].name);
      EXPECT_EQ(again.materials[m].reflectance_rgb, scene.materials[m].reflectance_rgb);
      for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
        if (scene.material_of_triangle[t] != m) continue;
        ASSERT_EQ(again.material_of_triangle[at], m);
        for (std::size_t corner = 0; corner < 3; ++corner) {
          const Vec3 read = again.vertices_world_m[again.triangles[at][corner]];
          const Vec3 meant = scene.vertex_world_m(scene.triangles[t][corner]);
          ASSERT_LE((read - meant).norm(), 1e-9 * (1 + meant.norm())) << "triangle " << t;
        }
        ++at;
      }
    }
  }
}

TEST(SceneGlb, LeavesOutAMaterialThatNothingHas) {
  Scene scene = random_scene(3, 40, 3);
  for (auto& m : scene.material_of_triangle) m = m == 1 ? 2 : m;
  const PlacedMesh again = read_again(scene_glb(scene));
  ASSERT_EQ(again.materials.size(), 2u);
  EXPECT_EQ(again.materials[1].name, scene.materials[2].name);
}

TEST(SceneGlb, HasThePanesApart) {
  Scene scene = random_scene(5, 10, 1);
  scene.panes.push_back({{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, 2)}, 0.8, 1});
  const PlacedMesh again = read_again(scene_glb(scene));
  ASSERT_EQ(again.triangles.size(), 11u);
  ASSERT_EQ(again.materials.size(), 2u);
  EXPECT_EQ(again.materials[1].name, "glass");
  EXPECT_LE((again.vertices_world_m[again.triangles[10][2]] - Vec3(0, 0, 2)).norm(), 1e-12);
}

/// What Khronos's validator asks of a container and its positions.
TEST(SceneGlb, KeepsTheContainersRules) {
  const Scene scene = random_scene(11, 33, 3);
  const std::string glb = scene_glb(scene);
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, glb.data() + at, sizeof value);
    return value;
  };
  EXPECT_EQ(glb.substr(0, 4), "glTF");
  EXPECT_EQ(word(4), 2u);
  EXPECT_EQ(word(8), glb.size());
  const std::size_t text_bytes = word(12);
  EXPECT_EQ(text_bytes % 4, 0u);
  const auto root = nlohmann::json::parse(glb.substr(20, text_bytes));
  EXPECT_EQ(word(20 + text_bytes), root["buffers"][0]["byteLength"]);
  EXPECT_EQ(28 + text_bytes + word(20 + text_bytes), glb.size());
  std::size_t end = 0;
  for (const auto& view : root["bufferViews"]) {
    EXPECT_EQ(view["byteOffset"], end);
    end += view["byteLength"].get<std::size_t>();
  }
  EXPECT_EQ(end, root["buffers"][0]["byteLength"]);
  const std::size_t positions = root["meshes"][0]["primitives"][0]["attributes"]["POSITION"];
  for (int axis = 0; axis < 3; ++axis) {
    const int of_world = axis == 0 ? 0 : 3 - axis;
    float least = 1e9f;
    for (const Vec3f& v : scene.vertices_m) least = std::min(least, axis == 2 ? -v[of_world] : v[of_world]);
    EXPECT_EQ(root["accessors"][positions]["min"][static_cast<std::size_t>(axis)].get<float>(), least);
  }
}

TEST(SceneGlb, IsEmptyOfNothingAndOfWhatIsTooLarge) {
  EXPECT_EQ(scene_glb(Scene{}), "");
  const Scene scene = random_scene(2, 100, 1);
  const std::string glb = scene_glb(scene);
  EXPECT_EQ(scene_glb(scene, glb.size()), glb);
  EXPECT_EQ(scene_glb(scene, glb.size() - 1), "");
}

}  // namespace
}  // namespace luxrig
