// Scenery of MVR files as the scene of a rig: a real file, and small ones made here.
#include "core/rig/mvr/mvr_scenery.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "core/rig/mvr/mvr_rig.h"
#include "core/rig/rig_file.h"
#include "core/tasks/scene_builder.h"
#include "tests/core/scene/mesh/mesh_maker.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

/// A zip archive with stored (uncompressed) files.
std::string zip_of(const std::vector<std::pair<std::string, std::string>>& files) {
  const auto crc_of = [](const std::string& bytes) {
    std::uint32_t crc = 0xffffffff;
    for (const char c : bytes) {
      crc ^= static_cast<unsigned char>(c);
      for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0u);
    }
    return ~crc;
  };
  std::string out, directory;
  const auto u16 = [](std::string& to, std::size_t value) { test::put_bytes(to, static_cast<std::uint16_t>(value)); };
  const auto u32 = [](std::string& to, std::size_t value) { test::put_bytes(to, static_cast<std::uint32_t>(value)); };
  for (const auto& [name, bytes] : files) {
    const std::size_t at = out.size();
    std::string common;
    for (int i = 0; i < 5; ++i) u16(common, i == 0 ? 20 : i == 4 ? 33 : 0);  // version, flags, stored, time, date
    u32(common, crc_of(bytes)), u32(common, bytes.size()), u32(common, bytes.size());
    u16(common, name.size()), u16(common, 0);
    out += "PK\3\4" + common + name + bytes;
    directory += std::string("PK\1\2") + std::string("\24\0", 2) + common;
    for (int i = 0; i < 3; ++i) u16(directory, 0);
    u32(directory, 0), u32(directory, at);
    directory += name;
  }
  const std::size_t begin = out.size();
  out += directory + std::string("PK\5\6\0\0\0\0", 8);
  u16(out, files.size()), u16(out, files.size()), u32(out, directory.size()), u32(out, begin), u16(out, 0);
  return out;
}

std::string mvr_of(const std::string& auxiliary, const std::string& children,
                   std::vector<std::pair<std::string, std::string>> files) {
  files.emplace_back("GeneralSceneDescription.xml",
                     R"(<GeneralSceneDescription verMajor="1" verMinor="6"><Scene><AUXData>)" + auxiliary +
                         R"(</AUXData><Layers><Layer name="l"><ChildList>)" + children +
                         "</ChildList></Layer></Layers></Scene></GeneralSceneDescription>");
  return zip_of(files);
}

/// The rig that an import of these bytes produces, and its scene.
struct Imported {
  ImportedRig rig;
  Scene scene;
};
Imported imported_from(const std::string& bytes) {
  Imported out;
  const auto mvr = read_mvr(bytes, "test.mvr");
  EXPECT_TRUE(mvr) << mvr.error().front().text();
  if (!mvr) return out;
  out.rig = rig_of_mvr(*mvr, "test");
  const auto folder = std::filesystem::temp_directory_path() / ("luxrig_scenery_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  for (const ImportedRig::File& file : out.rig.files) std::ofstream(folder / file.name, std::ios::binary) << file.bytes;
  std::ofstream(folder / "rig.toml") << out.rig.rig_toml;
  const auto rig = load_rig(folder);
  EXPECT_TRUE(rig) << rig.error().front().text();
  if (rig) {
    auto scene = build_scene(*rig);
    EXPECT_TRUE(scene) << scene.error().front().text();
    if (scene) out.scene = std::move(*scene);
  }
  std::filesystem::remove_all(folder);
  return out;
}

Eigen::AlignedBox3d bounds_of_scene(const Scene& scene) {
  Eigen::AlignedBox3d bounds;
  for (const auto& triangle : scene.triangles)
    for (const std::uint32_t index : triangle) bounds.extend(scene.vertex_world_m(index));
  return bounds;
}

const std::string kFixture = R"(<Fixture name="par"/>)";

TEST(MvrScenery, ModelsOf3dStudioUseMillimetresAndTheirMatrices) {
  // 1 by 2 m in x and y, turned by a quarter about z, at (5, 0, 3), in a group that stands 1 m higher.
  const Imported got = imported_from(
      mvr_of("",
             R"(<GroupObject><Matrix>{1,0,0}{0,1,0}{0,0,1}{0,0,1000}</Matrix><ChildList><SceneObject name="deck">
<Matrix>{0,1,0}{-1,0,0}{0,0,1}{5000,0,3000}</Matrix><Geometries><Geometry3D fileName="deck"/></Geometries>
</SceneObject></ChildList></GroupObject>)" +
                 kFixture,
             {{"deck.3ds", test::triangle_3ds()}}));
  ASSERT_EQ(got.scene.triangles.size(), 1u);
  const auto bounds = bounds_of_scene(got.scene);
  EXPECT_LT((bounds.min() - Vec3(3, 0, 4)).norm(), 1e-5);
  EXPECT_LT((bounds.max() - Vec3(5, 1, 4)).norm(), 1e-5);
  EXPECT_EQ(got.scene.materials[0].name, "oak");
  EXPECT_NEAR(got.scene.materials[0].luminous_reflectance(), 0.2159, 1e-4);
}

TEST(MvrScenery, ModelsOfGltfUseMetresWithYUpAndSymbolsRepeat) {
  test::GltfMaker gltf = test::GltfMaker::square();  // 1 m in x and in y, which is up
  gltf.root["materials"][0]["pbrMetallicRoughness"] = {{"baseColorFactor", {0.3, 0.3, 0.3, 1}}};
  const Imported got = imported_from(mvr_of(
      R"(<Symdef uuid="s" name="flat"><ChildList><Geometry3D fileName="flat.glb">
<Matrix>{1,0,0}{0,1,0}{0,0,1}{0,0,500}</Matrix></Geometry3D></ChildList></Symdef>)",
      R"(<Truss name="left"><Matrix>{1,0,0}{0,1,0}{0,0,1}{-2000,0,0}</Matrix><Geometries><Symbol symdef="s"/></Geometries></Truss>
<VideoScreen name="right"><Geometries><Symbol symdef="s"><Matrix>{1,0,0}{0,1,0}{0,0,1}{2000,7000,0}</Matrix></Symbol>
<Geometry3D fileName="missing.3ds"/></Geometries></VideoScreen>
<Support name="hoist"/>)" +
          kFixture,
      {{"flat.glb", gltf.glb()}}));
  ASSERT_EQ(got.scene.triangles.size(), 4u);
  const auto bounds = bounds_of_scene(got.scene);
  EXPECT_LT((bounds.min() - Vec3(-2, 0, 0.5)).norm(), 1e-5);
  EXPECT_LT((bounds.max() - Vec3(3, 7, 1.5)).norm(), 1e-5);
  EXPECT_EQ(got.rig.models, 2u);
  const auto told = [&](const std::string& text) {
    return std::any_of(got.rig.remarks.begin(), got.rig.remarks.end(),
                       [&](const std::string& remark) { return remark.find(text) != std::string::npos; });
  };
  EXPECT_TRUE(told("\"missing.3ds\" is not in the archive"));
  EXPECT_TRUE(told("1 objects that are no fixtures"));
}

TEST(MvrScenery, ATheatreByAnotherProgramIsImportedWhole) {
  std::ifstream in(test::source_folder() / "tests/data/fixtures/scene_objects.mvr", std::ios::binary);
  const Imported got = imported_from(std::string((std::istreambuf_iterator<char>(in)), {}));
  EXPECT_EQ(got.rig.fixtures, 72u);
  EXPECT_EQ(got.rig.models, 28u) << "72 more are bodies of fixtures";
  EXPECT_GT(got.scene.triangles.size(), 10'000u);
  // A house of tens of metres, with fixtures inside.
  const auto bounds = bounds_of_scene(got.scene);
  EXPECT_GT(bounds.sizes().minCoeff(), 5);
  EXPECT_LT(bounds.sizes().maxCoeff(), 100);
  bool textured = false;
  for (const Material& material : got.scene.materials)
    textured = textured ||
               (material.name.starts_with("Texture-1") && material.coloured && material.luminous_reflectance() < 0.9);
  EXPECT_TRUE(textured);
}

TEST(MvrScenery, ARecursiveSymbolTerminates) {
  const Imported got = imported_from(mvr_of(
      R"(<Symdef uuid="s"><ChildList><Symbol symdef="s"/><Symbol symdef="s"/><Geometry3D fileName="deck.3ds"/></ChildList></Symdef>)",
      R"(<SceneObject name="a"><Geometries><Symbol symdef="s"/></Geometries></SceneObject>)" + kFixture,
      {{"deck.3ds", test::triangle_3ds()}}));
  EXPECT_GT(got.scene.triangles.size(), 1u);
}

}  // namespace
}  // namespace luxrig
