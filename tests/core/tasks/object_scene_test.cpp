#include "core/scene/object_scene.h"

#include <gtest/gtest.h>

#include "core/scene/ray_scene.h"
#include "core/tasks/scene_builder.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

SceneObject box_called(const std::string& name, const Vec3& size_m, const Vec3& position_m, double reflectance) {
  SceneObject object;
  object.name = name;
  object.box_m = size_m;
  object.position_world_m = position_m;
  object.reflectance_rgb = Vec3::Constant(reflectance);
  return object;
}

/// A room with a table and a box on it.
Scene room_with_two() {
  Rig rig;
  rig.file = "rig.toml";
  rig.scene.mesh = MeshFile{test::source_folder() / "tests/rigs/room/room.obj", 1.0, UpAxis::z};
  rig.scene.objects = {box_called("table", {1.4, 0.8, 0.7}, {1.0, 2.0, 0}, 0.4),
                       box_called("vase", {0.2, 0.1, 0.4}, {1.1, 2.1, 0.7}, 0.25)};
  const auto scene = build_scene(rig);
  EXPECT_TRUE(scene.has_value());
  return scene.value_or(Scene{});
}

TEST(ObjectScene, HoldsOnlyTheObjectInItsPlace) {
  const Scene scene = room_with_two();
  const auto vase = object_scene(scene, "vase");
  ASSERT_TRUE(vase.has_value());
  EXPECT_EQ(vase->triangles.size(), 12u);
  EXPECT_EQ(vase->vertices_m.size(), 8u);
  EXPECT_EQ(vase->object_names, std::vector<std::string>{"vase"});
  ASSERT_EQ(vase->materials.size(), 1u);
  EXPECT_EQ(vase->materials[0].name, "vase");
  EXPECT_DOUBLE_EQ(vase->materials[0].reflectance_rgb.x(), 0.25);
  const Eigen::AlignedBox3d bounds = RayScene(*vase).bounds_world_m();
  EXPECT_LT((bounds.min() - Vec3(1.0, 2.05, 0.7)).norm(), 1e-6);
  EXPECT_LT((bounds.max() - Vec3(1.2, 2.15, 1.1)).norm(), 1e-6);
  EXPECT_LT((vase->origin_world_m - bounds.center()).norm(), 1e-6);
}

TEST(ObjectScene, TogetherWithTheRestIsTheWhole) {
  const Scene scene = room_with_two();
  for (const std::string& name : scene.object_names) {
    const auto object = object_scene(scene, name), rest = scene_without_object(scene, name);
    ASSERT_TRUE(object.has_value() && rest.has_value());
    EXPECT_EQ(object->triangles.size() + rest->triangles.size(), scene.triangles.size());
    EXPECT_EQ(rest->material_of_triangle.size(), rest->triangles.size());
    EXPECT_EQ(rest->object_of_triangle.size(), rest->triangles.size());
    // Each triangle is in one of them, in its order, at its position and with its material.
    std::size_t in_object = 0, in_rest = 0;
    for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
      const bool of_it = scene.object_names[scene.object_of_triangle[t]] == name;
      const Scene& part = of_it ? *object : *rest;
      const std::size_t i = of_it ? in_object++ : in_rest++;
      for (std::size_t corner = 0; corner < 3; ++corner)
        EXPECT_LT(
            (part.vertex_world_m(part.triangles[i][corner]) - scene.vertex_world_m(scene.triangles[t][corner])).norm(),
            1e-6);
      EXPECT_EQ(part.materials[part.material_of_triangle[i]].name, scene.materials[scene.material_of_triangle[t]].name);
    }
  }
}

TEST(ObjectScene, SuggestsTheNearestNameForAnUnknownOne) {
  const Scene scene = room_with_two();
  const auto none = object_scene(scene, "vace");
  ASSERT_FALSE(none.has_value());
  EXPECT_EQ(none.error().detail, "there is no object \"vace\": did you mean \"vase\"?");
  const auto far = scene_without_object(scene, "elephant");
  ASSERT_FALSE(far.has_value());
  EXPECT_EQ(far.error().detail, "there is no object \"elephant\": known: table, vase");
}

TEST(ObjectScene, WithoutTrianglesIsEmpty) {
  Scene scene;
  scene.object_names = {"scene", "cloud"};
  scene.vertices_m = {Vec3f(1, 2, 3), Vec3f(2, 2, 3)};
  const auto cloud = object_scene(scene, "cloud");
  ASSERT_TRUE(cloud.has_value());
  EXPECT_TRUE(cloud->triangles.empty());
  EXPECT_TRUE(cloud->vertices_m.empty());
}

}  // namespace
}  // namespace luxrig
