#include "core/tasks/scene_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "core/scene/ray_scene.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

std::filesystem::path source_file(const std::string& name) { return test::source_folder() / name; }

MeshFile room() { return {source_file("tests/rigs/room/room.obj"), 1.0, UpAxis::z}; }

Rig rig_with_room() {
  Rig rig;
  rig.file = "rig.toml";
  rig.scene.mesh = room();
  rig.scene.in_file = {4, 1};
  return rig;
}

SceneObject box_object(const std::string& name, const Vec3& size_m, const Vec3& position_m, double turn_rad = 0) {
  SceneObject object;
  object.name = name;
  object.box_m = size_m;
  object.position_world_m = position_m;
  object.turn_rad = turn_rad;
  object.in_file = {20, 3};
  return object;
}

Eigen::AlignedBox3d bounds_of_object(const Scene& scene, std::uint32_t object) {
  Eigen::AlignedBox3d bounds;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    if (scene.object_of_triangle[i] != object) continue;
    for (const std::uint32_t index : scene.triangles[i]) bounds.extend(scene.vertex_world_m(index));
  }
  return bounds;
}

const Material* material_named(const Scene& scene, const std::string& name) {
  const auto found = std::find_if(scene.materials.begin(), scene.materials.end(),
                                  [&](const Material& material) { return material.name == name; });
  return found == scene.materials.end() ? nullptr : &*found;
}

bool warns_of(const Scene& scene, const std::string& part) {
  return std::any_of(scene.warnings.begin(), scene.warnings.end(),
                     [&](const std::string& text) { return text.find(part) != std::string::npos; });
}

TEST(SceneBuilder, AnEmptyRigGivesAnEmptyScene) {
  const auto scene = build_scene(Rig());
  ASSERT_TRUE(scene.has_value());
  EXPECT_TRUE(scene->triangles.empty());
  EXPECT_EQ(scene->object_names, std::vector<std::string>{"scene"});
  EXPECT_TRUE(RayScene(*scene).bounds_world_m().isEmpty());
}

TEST(SceneBuilder, PlacesTheRoomAsItsFileStates) {
  const auto scene = build_scene(rig_with_room());
  ASSERT_TRUE(scene.has_value());
  EXPECT_EQ(scene->triangles.size(), 12u);
  const auto bounds = bounds_of_object(*scene, 0);
  EXPECT_NEAR((bounds.min() - Vec3(-3, -2.5, 0)).norm(), 0, 1e-6);
  EXPECT_NEAR((bounds.max() - Vec3(3, 2.5, 3)).norm(), 0, 1e-6);
  EXPECT_NEAR((scene->origin_world_m - Vec3(0, 0, 1.5)).norm(), 0, 1e-6);
}

TEST(SceneBuilder, PlacesABoxByTheCentreOfItsUndersideAndRotatesIt) {
  Rig rig = rig_with_room();
  rig.scene.objects = {box_object("plinth", {0.4, 0.2, 1}, {1, 0.5, 0.1}, rad_from_deg(90))};
  const auto scene = build_scene(rig);
  ASSERT_TRUE(scene.has_value());
  const auto bounds = bounds_of_object(*scene, 1);
  EXPECT_NEAR((bounds.min() - Vec3(0.9, 0.3, 0.1)).norm(), 0, 1e-6);
  EXPECT_NEAR((bounds.max() - Vec3(1.1, 0.7, 1.1)).norm(), 0, 1e-6);
  EXPECT_EQ(scene->object_names[1], "plinth");
}

TEST(SceneBuilder, ABoxIsClosedAndItsNormalsPointOutwards) {
  Rig rig;
  rig.scene.objects = {box_object("cube", {2, 3, 4}, {0, 0, 0}, 0.3)};
  const auto scene = build_scene(rig);
  ASSERT_TRUE(scene.has_value());
  double volume = 0;  // by the divergence theorem: right only if closed and outward
  for (const auto& triangle : scene->triangles) {
    const Vec3 a = scene->vertex_world_m(triangle[0]);
    volume += a.dot(scene->vertex_world_m(triangle[1]).cross(scene->vertex_world_m(triangle[2]))) / 6;
  }
  EXPECT_NEAR(volume, 24, 1e-5);
}

TEST(SceneBuilder, ScalesAMeshToItsHeightAndPlacesIt) {
  Rig rig;
  SceneObject model = box_object("model", Vec3::Zero(), {7, 8, 9}, rad_from_deg(90));
  model.mesh = room();
  model.height_m = 0.6;
  rig.scene.objects = {model};
  const auto scene = build_scene(rig);
  ASSERT_TRUE(scene.has_value());
  const auto bounds = bounds_of_object(*scene, 1);
  EXPECT_NEAR((bounds.sizes() - Vec3(1, 1.2, 0.6)).norm(), 0, 1e-6);  // 6 x 5 x 3 m at a fifth, turned
  EXPECT_NEAR((Vec3(bounds.center().x(), bounds.center().y(), bounds.min().z()) - Vec3(7, 8, 9)).norm(), 0, 1e-6);
}

TEST(SceneBuilder, KeepsMicrometresInMapCoordinates) {
  Rig rig;
  const Vec3 far(4.5e6, 5.6e6, 130);
  rig.scene.objects = {box_object("a", {1, 1, 1}, far), box_object("b", {1, 1, 1}, far + Vec3(2.000'01, 0, 0))};
  const auto scene = build_scene(rig);
  ASSERT_TRUE(scene.has_value());
  const double gap_m = bounds_of_object(*scene, 2).min().x() - bounds_of_object(*scene, 1).max().x();
  EXPECT_NEAR(gap_m, 1.000'01, 1e-6);
}

TEST(SceneBuilder, FirstMatchingReflectanceRuleWins) {
  Rig rig = rig_with_room();
  rig.scene.default_reflectance_rgb = Vec3::Constant(0.33);
  rig.scene.reflectances = {{"wa?l", Vec3::Constant(0.6), {8, 1}},
                            {"*l*", Vec3::Constant(0.2), {9, 1}},
                            {"carpet", Vec3::Constant(0.1), {10, 1}}};
  rig.scene.objects = {box_object("plinth", {1, 1, 1}, {0, 0, 0}), box_object("bust", {1, 1, 1}, {0, 0, 0})};
  rig.scene.objects[1].reflectance_rgb = Vec3(0.7, 0.7, 0.65);
  const auto scene = build_scene(rig);
  ASSERT_TRUE(scene.has_value());
  EXPECT_EQ(material_named(*scene, "wall")->reflectance_rgb, Vec3::Constant(0.6));
  EXPECT_EQ(material_named(*scene, "floor")->reflectance_rgb, Vec3::Constant(0.2));
  EXPECT_EQ(material_named(*scene, "ceiling")->reflectance_rgb, Vec3::Constant(0.2));
  EXPECT_EQ(material_named(*scene, "plinth")->reflectance_rgb, Vec3::Constant(0.2));
  EXPECT_EQ(material_named(*scene, "bust")->reflectance_rgb, Vec3(0.7, 0.7, 0.65));
  EXPECT_TRUE(warns_of(*scene, "line 10: reflectance rule 'carpet' matches no material"));
  EXPECT_EQ(scene->warnings.size(), 1u);
}

TEST(SceneBuilder, TakesGlossFromTheRuleOfTheReflectance) {
  Rig rig = rig_with_room();
  rig.scene.reflectances = {{"wa?l", Vec3::Constant(0.6), {8, 1}, 0.04, 0.2},
                            {"*l*", Vec3::Constant(0.2), {9, 1}, 0.5, 0.7}};
  rig.scene.objects = {box_object("wall", {1, 1, 1}, {0, 0, 0})};
  rig.scene.objects[0].reflectance_rgb = Vec3::Constant(0.3);
  const auto scene = build_scene(rig);
  ASSERT_TRUE(scene.has_value());
  int own = 0;
  for (const Material& material : scene->materials) {
    if (material.name == "wall" && material.reflectance_rgb == Vec3::Constant(0.3)) {
      EXPECT_EQ(material.specular_reflectance, 0);  // an object's own reflectance leaves the rules out
      ++own;
    } else if (material.name == "wall") {
      EXPECT_EQ(material.specular_reflectance, 0.04);
      EXPECT_EQ(material.roughness, 0.2);
    } else if (material.name == "floor") {
      EXPECT_EQ(material.specular_reflectance, 0.5);
      EXPECT_EQ(material.roughness, 0.7);
    }
  }
  EXPECT_EQ(own, 1);
}

TEST(SceneBuilder, FallsBackToTheDefaultAndClampsImpossibleReflectances) {
  Rig rig = rig_with_room();
  rig.scene.default_reflectance_rgb = Vec3::Constant(0.33);
  rig.scene.reflectances = {{"wall", Vec3::Constant(1.0), {8, 1}}};
  const auto scene = build_scene(rig);
  ASSERT_TRUE(scene.has_value());
  EXPECT_EQ(material_named(*scene, "floor")->reflectance_rgb, Vec3::Constant(0.33));
  EXPECT_EQ(material_named(*scene, "wall")->reflectance_rgb, Vec3::Constant(0.95));
  EXPECT_TRUE(warns_of(*scene, "material 'wall': reflectance above 0.95"));
}

TEST(SceneBuilder, NotesAMaterialColourTooBrightUnlessTheRigStatesIt) {
  std::string name = (std::filesystem::temp_directory_path() / "luxrig-builder-XXXXXX").string();
  const std::filesystem::path folder = mkdtemp(name.data());
  std::ofstream(folder / "p.mtl") << "newmtl snow\nKd 1 1 1\nnewmtl idle\nKd 1 1 1\n";
  std::ofstream(folder / "p.obj") << "mtllib p.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 1\nusemtl snow\nf 1 2 3\n";
  Rig rig;
  SceneObject object = box_object("bust", {1, 1, 1}, {0, 0, 0});
  object.mesh = MeshFile{folder / "p.obj", 1, UpAxis::z};
  rig.scene.objects = {object};
  const auto scene = build_scene(rig);
  rig.scene.objects[0].reflectance_rgb = Vec3::Constant(0.7);
  const auto stated = build_scene(rig);
  std::filesystem::remove_all(folder);
  ASSERT_TRUE(scene.has_value() && stated.has_value());
  EXPECT_EQ(scene->warnings,
            std::vector<std::string>{"object 'bust': material \"snow\": its colour above 0.95 is taken as 0.95"});
  EXPECT_EQ(stated->warnings, std::vector<std::string>{});
  EXPECT_EQ(scene->materials.size(), 1u);
}

TEST(SceneBuilder, NamesTheRigFileAndThePlaceOfEveryProblem) {
  Rig rig = rig_with_room();
  rig.scene.mesh->path = source_file("tests/rigs/room/missing.obj");
  SceneObject flat = box_object("flat", {1, 1, 0}, {0, 0, 0});
  SceneObject gone = box_object("gone", {1, 1, 1}, {0, 0, 0});
  gone.mesh = MeshFile{source_file("tests/rigs/room/rig.toml"), 1, UpAxis::z};
  SceneObject nowhere = box_object("nowhere", {1, 1, 1}, {0, std::nan(""), 0});
  rig.scene.objects = {flat, gone, nowhere};
  const auto scene = build_scene(rig);
  ASSERT_FALSE(scene.has_value());
  ASSERT_EQ(scene.error().size(), 4u);
  for (const Problem& problem : scene.error()) {
    EXPECT_EQ(problem.file, "rig.toml");
    EXPECT_FALSE(problem.mend.empty());
  }
  EXPECT_EQ(scene.error()[0].line, 4);
  EXPECT_EQ(scene.error()[1].line, 20);
  EXPECT_EQ(scene.error()[1].column, 3);
}

TEST(SceneBuilder, NoLightLeavesTheRoomThroughItsCorners) {
  Rig rig = rig_with_room();
  rig.scene.objects = {box_object("plinth", {0.4, 0.4, 1}, {1, 0.5, 0}, rad_from_deg(30))};
  const auto scene = build_scene(rig);
  ASSERT_TRUE(scene.has_value());
  const RayScene rays(*scene);
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner((i & 1) ? 3 : -3, (i & 2) ? 2.5 : -2.5, (i & 4) ? 3 : 0);
    EXPECT_TRUE(rays.nearest(Vec3(0, 0, 1.5), (corner - Vec3(0, 0, 1.5)).normalized(), Vec3::Zero()).has_value());
  }
  EXPECT_FALSE(rays.occluded(Vec3(1, 0.5, 1), Vec3::UnitZ(), Vec3(-1.5, 0, 2.9)));
  EXPECT_TRUE(rays.occluded(Vec3(1.5, 0.6, 0), Vec3::UnitZ(), Vec3(-1.5, 0, 1.0)));
}

}  // namespace
}  // namespace luxrig
