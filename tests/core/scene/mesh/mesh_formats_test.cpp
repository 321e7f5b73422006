// Contents of real mesh files: text as Windows saves it, pictures, vertex colours, glTF's extensions, 3DS.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/scene/mesh/mesh_file.h"
#include "tests/core/scene/mesh/mesh_maker.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

using test::GltfMaker;

constexpr double kGrey = 0.21586;  // sRGB 128 in linear light

class FormatFiles : public testing::Test {
 protected:
  FormatFiles() {
    std::string name = (std::filesystem::temp_directory_path() / "luxrig-formats-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~FormatFiles() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }
  void picture(const std::string& name, const std::string& as) const {
    std::filesystem::copy_file(test::source_folder() / "tests/data/textures" / name, folder_ / as);
  }
  Checked<Scene> load(const std::string& name, const std::string& bytes, UpAxis up = UpAxis::z) const {
    write(name, bytes);
    return load_mesh({folder_ / name, 1, up});
  }
  /// "file:line:column: what" of the first problem.
  std::string refusal(const std::string& name, const std::string& bytes) const {
    const auto scene = load(name, bytes);
    if (scene) return "";
    const Problem& p = scene.error().front();
    EXPECT_FALSE(p.mend.empty());
    return std::filesystem::path(p.file).filename().string() + ":" + std::to_string(p.line) + ":" +
           std::to_string(p.column) + ": " + p.what;
  }

  std::filesystem::path folder_;
};

std::string utf16(const std::string& ascii, bool big_endian, bool mark = true) {
  std::string out = !mark ? "" : big_endian ? "\xfe\xff" : "\xff\xfe";
  for (const char c : ascii) {
    if (big_endian) out += '\0';
    out += c;
    if (!big_endian) out += '\0';
  }
  return out;
}

bool warns(const Scene& scene, const std::string& of) {
  for (const std::string& warning : scene.warnings)
    if (warning.find(of) != std::string::npos) return true;
  return false;
}

/// Mean reflectance by area.
double mean_reflectance(const Scene& scene) {
  double sum = 0, area = 0;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const auto& t = scene.triangles[i];
    const Vec3f a = scene.vertices_m[t[0]];
    const double own = (scene.vertices_m[t[1]] - a).cross(scene.vertices_m[t[2]] - a).norm();
    sum += own * scene.materials[scene.material_of_triangle[i]].luminous_reflectance();
    area += own;
  }
  return sum / area;
}

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
const std::string kFace = "f 1/1 2/2 3/3 4/4\n";

TEST_F(FormatFiles, MaterialsInUtf16AndWithByteOrderMarksAreRead) {
  const std::string mtl = "newmtl wall\r\nKd 0.25 0.5 0.75\r\n";
  for (const std::string& bytes :
       {utf16(mtl, false), utf16(mtl, true), utf16(mtl, false, false), "\xef\xbb\xbf" + mtl}) {
    write("a.mtl", bytes);
    const auto scene = load("a.obj", "mtllib a.mtl\nusemtl wall\n" + kSquare + kFace);
    ASSERT_TRUE(scene) << scene.error().front().text();
    ASSERT_EQ(scene->materials.size(), 1u);
    EXPECT_TRUE(scene->materials[0].coloured);
    EXPECT_EQ(scene->materials[0].reflectance_rgb, Vec3(0.25, 0.5, 0.75));
  }
}

TEST_F(FormatFiles, APictureBeforeTheFirstMaterialIsOmittedWithAWarning) {
  write("a.mtl", "map_Kd wall.png\nKd 1 1 1\nnewmtl wall\nKd 0.5 0.5 0.5\n");
  const auto scene = load("a.obj", "mtllib a.mtl\nusemtl wall\n" + kSquare + kFace);
  ASSERT_TRUE(scene) << scene.error().front().text();
  EXPECT_NEAR(mean_reflectance(*scene), 0.5, 1e-12);
  EXPECT_TRUE(warns(*scene, "a.mtl, line 1: map_Kd before the first newmtl"));
}

TEST_F(FormatFiles, UnicodeObjAndNumbersWithoutALeadingZeroAreRead) {
  const auto scene = load("A.OBJ", utf16("v .5 -.5 +1.\nv 1.5 -.5 1e0\nv .5 .5 1\nf 1 2 3\n", false));
  ASSERT_TRUE(scene) << scene.error().front().text();
  EXPECT_EQ(scene->vertices_m[0], Vec3f(0.5f, -0.5f, 1));
  EXPECT_EQ(scene->vertices_m[1], Vec3f(1.5f, -0.5f, 1));
}

TEST_F(FormatFiles, DecimalCommasAreRefusedWithLineAndColumn) {
  EXPECT_EQ(refusal("a.obj", "v 0 0 0\nv 1 2,5 0\nv 0 1 0\nf 1 2 3\n"), "a.obj:2:5: \"2,5\" has a decimal comma");
  EXPECT_EQ(refusal("b.obj", "v 0 0 0\nv 1 x 0\nf 1 2 3\n").substr(0, 10), "b.obj:2:5:");
  EXPECT_EQ(refusal("c.obj", "v 0 0 0\nv 1 0\nf 1 2 3\n").substr(0, 10), "c.obj:2:6:");
  EXPECT_EQ(refusal("d.obj", "v 0 0 0\nf 1 b 3\n"), "d.obj:2:5: \"b\" is no corner of a face");
  write("e.mtl", "newmtl wall\nKd 0,5 0,5 0,5\n");
  EXPECT_EQ(refusal("e.obj", "mtllib e.mtl\n" + kSquare + kFace), "e.mtl:2:4: \"0,5\" has a decimal comma");
  EXPECT_EQ(refusal("f.stl", "solid f\nfacet normal 0 0 1\nouter loop\nvertex 0 0,5 0\n"),
            "f.stl:4:10: \"0,5\" has a decimal comma");
}

TEST_F(FormatFiles, APictureCountsAsItsLinearMeanTimesTheColour) {
  for (const std::string name : {"grey.png", "grey.jpg", "progressive.jpg", "glass.png"}) {
    std::filesystem::remove(folder_ / "WALL.PNG");
    picture(name, "WALL.PNG");  // recognised by content, whatever its name or the capitals in the .mtl
    write("a.mtl", "newmtl wall\nKd 0.5 1 1\nmap_Kd -s 2 2 1 -o 0.5 C:\\textures\\wall.png\n");
    const auto scene = load("a.obj", "mtllib a.mtl\nusemtl wall\n" + kSquare + kFace);
    ASSERT_TRUE(scene) << scene.error().front().text();
    EXPECT_NEAR(scene->materials[0].reflectance_rgb.x(), 0.5 * kGrey, 0.002) << name;
    EXPECT_NEAR(scene->materials[0].reflectance_rgb.y(), kGrey, 0.003) << name;
    EXPECT_TRUE(scene->warnings.empty()) << scene->warnings.front();
  }
}

TEST_F(FormatFiles, EachTriangleTakesItsPartOfThePicture) {
  picture("black-over-white.png", "a.png");
  write("a.mtl", "newmtl wall\nmap_Kd a.png\n");
  // Two squares, one on the lower half of the picture, which is white, one on the upper, which is black.
  const auto scene = load("a.obj", "mtllib a.mtl\nusemtl wall\n" + kSquare +
                                       "v 2 0 0\nv 3 0 0\nv 3 1 0\nv 2 1 0\nvt 0 .45\nvt 1 .45\nvt 0 .55\nvt 1 .55\n"
                                       "f 1/1 2/2 3/6 4/5\nf 5/7 6/8 7/3 8/4\n");
  ASSERT_TRUE(scene) << scene.error().front().text();
  ASSERT_EQ(scene->triangles.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const Material& m = scene->materials[scene->material_of_triangle[i]];
    EXPECT_EQ(m.name, "wall");
    EXPECT_NEAR(m.luminous_reflectance(), i < 2 ? 0.95 : 0, 1e-6) << i;  // 1 is taken as 0.95
  }
}

TEST_F(FormatFiles, AnUnreadablePictureKeepsTheRigsReflectanceWithAWarning) {
  write("a.mtl", "newmtl wall\nKd 1 1 1\nmap_Kd a.png\n");
  write("a.png", "RIFF....WEBPVP8 ");
  const auto scene = load("a.obj", "mtllib a.mtl\nusemtl wall\n" + kSquare + kFace);
  ASSERT_TRUE(scene) << scene.error().front().text();
  EXPECT_FALSE(scene->materials[0].coloured);
  EXPECT_TRUE(warns(*scene, "texture \"a.png\" is WebP"));
  std::filesystem::remove(folder_ / "a.png");
  const auto without = load("a.obj", "mtllib a.mtl\nusemtl wall\n" + kSquare + kFace);
  EXPECT_FALSE(without->materials[0].coloured);
  EXPECT_TRUE(warns(*without, "is not beside the mesh"));
}

TEST_F(FormatFiles, VertexColoursCount) {
  const std::string colour = " 0.50196 0.50196 0.50196\n";
  const auto obj = load("a.obj", "v 0 0 0" + colour + "v 1 0 0" + colour + "v 0 1 0" + colour + "f 1 2 3\n");
  ASSERT_TRUE(obj);
  EXPECT_NEAR(mean_reflectance(*obj), kGrey, 1e-4);
  const auto ply =
      load("a.ply",
           "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
           "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
           "property list uchar int vertex_indices\nend_header\n"
           "0 0 0 128 128 128\n1 0 0 128 128 128\n0 1 0 128 128 128\n3 0 1 2\n");
  ASSERT_TRUE(ply) << ply.error().front().text();
  EXPECT_NEAR(mean_reflectance(*ply), kGrey, 1e-4);
  GltfMaker gltf = GltfMaker::square();
  gltf.attributes()["COLOR_0"] = gltf.accessor<std::uint8_t>(
      {51, 51, 51, 255, 51, 51, 51, 255, 51, 51, 51, 255, 51, 51, 51, 255}, 5121, "VEC4", 4);
  gltf.root["accessors"].back()["normalized"] = true;
  const auto glb = load("a.glb", gltf.glb());
  ASSERT_TRUE(glb) << glb.error().front().text();
  EXPECT_NEAR(mean_reflectance(*glb), 0.2, 1e-6) << "linear light in glTF";
}

TEST_F(FormatFiles, APictureWithinAGlbCountsAsItsMean) {
  std::ifstream in(test::source_folder() / "tests/data/textures/grey.png", std::ios::binary);
  const std::string png((std::istreambuf_iterator<char>(in)), {});
  GltfMaker gltf = GltfMaker::square();
  gltf.root["images"] = {{{"bufferView", gltf.view(png)}, {"mimeType", "image/png"}}};
  gltf.root["textures"] = {{{"source", 0}}};
  gltf.root["materials"][0]["pbrMetallicRoughness"] = {{"baseColorTexture", {{"index", 0}}}};
  const auto scene = load("a.GLB", gltf.glb());
  ASSERT_TRUE(scene) << scene.error().front().text();
  EXPECT_NEAR(mean_reflectance(*scene), kGrey, 1e-4);

  gltf.root["materials"][0].erase("pbrMetallicRoughness");
  gltf.root["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"] = {
      {"diffuseFactor", {0.5, 0.5, 0.5, 1}}, {"diffuseTexture", {{"index", 0}}}};
  gltf.root["extensionsRequired"] = {"KHR_materials_pbrSpecularGlossiness"};
  const auto older = load("b.glb", gltf.glb());
  ASSERT_TRUE(older) << older.error().front().text();
  EXPECT_NEAR(mean_reflectance(*older), kGrey / 2, 1e-4);
  EXPECT_TRUE(warns(*older, "specular colour"));
}

TEST_F(FormatFiles, EveryInstanceOfAMeshIsPlaced) {
  GltfMaker gltf = GltfMaker::square();
  nlohmann::json& many = gltf.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  many["TRANSLATION"] = gltf.accessor<float>({0, 0, 0, 5, 0, 0, 0, 0, 7}, 5126, "VEC3", 3);
  many["ROTATION"] = gltf.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0.7071068f, 0, 0.7071068f}, 5126, "VEC4", 3);
  many["SCALE"] = gltf.accessor<float>({1, 1, 1, 2, 3, 1, 1, 1, 1}, 5126, "VEC3", 3);
  gltf.root["nodes"][0]["translation"] = {100, 0, 0};
  gltf.root["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const auto scene = load("a.glb", gltf.glb(), UpAxis::z);
  ASSERT_TRUE(scene) << scene.error().front().text();
  ASSERT_EQ(scene->triangles.size(), 6u);
  const auto corner = [&](std::size_t triangle) { return scene->vertices_m[scene->triangles[triangle][2]]; };
  EXPECT_LT((corner(0) - Vec3f(101, 1, 0)).norm(), 1e-5f);
  EXPECT_LT((corner(2) - Vec3f(107, 3, 0)).norm(), 1e-5f);
  EXPECT_LT((corner(4) - Vec3f(100, 1, 6)).norm(), 1e-5f) << "a quarter turn about y takes x to -z";
}

TEST_F(FormatFiles, QuantisedMeshesAreRead) {
  GltfMaker gltf = GltfMaker::square();
  gltf.attributes()["POSITION"] =
      gltf.accessor<std::int16_t>({0, 0, 0, 0, 32767, 0, 0, 0, 0, 32767, 0, 0}, 5122, "VEC3", 3);
  gltf.root["accessors"].back()["normalized"] = true;
  gltf.root["bufferViews"].back()["byteStride"] = 8;
  gltf.attributes().erase("TEXCOORD_0");
  gltf.primitive().erase("indices");
  gltf.root["nodes"][0]["scale"] = {4, 4, 4};
  gltf.root["extensionsRequired"] = {"KHR_mesh_quantization"};
  const auto scene = load("a.glb", gltf.glb());
  ASSERT_TRUE(scene) << scene.error().front().text();
  EXPECT_EQ(scene->vertices_m[1], Vec3f(4, 0, 0));
  EXPECT_EQ(scene->vertices_m[2], Vec3f(0, 4, 0));
}

TEST_F(FormatFiles, CompressionIsRefusedByName) {
  GltfMaker meshopt = GltfMaker::square();
  meshopt.root["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0}};
  meshopt.root["bufferViews"][0]["buffer"] = 1;
  meshopt.root["buffers"] = {{{"byteLength", 48}}};
  EXPECT_NE(refusal("a.glb", meshopt.glb()).find("EXT_meshopt_compression"), std::string::npos);
  GltfMaker draco = GltfMaker::square();
  draco.primitive()["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 0}};
  draco.root["accessors"][0].erase("bufferView");
  EXPECT_NE(refusal("b.glb", draco.glb()).find("KHR_draco_mesh_compression"), std::string::npos);
  for (const char* const name : {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "ACME_folding"}) {
    GltfMaker required = GltfMaker::square();
    required.root["extensionsRequired"] = {name};
    EXPECT_NE(refusal("c.glb", required.glb()).find(name), std::string::npos);
  }
}

TEST_F(FormatFiles, BrokenGltfIsRefusedWithItsLineNumber) {
  EXPECT_EQ(refusal("a.gltf", "{\"asset\":{\"version\":\"2.0\"},\n \"scene\" 0}\n"),
            "a.gltf:2:10: is no JSON from here on");
  EXPECT_EQ(refusal("b.gltf", "{\"asset\":{\"version\":\"1.0\"}}"), "b.gltf:0:0: is glTF \"1.0\"");
  GltfMaker short_view = GltfMaker::square();
  short_view.root["accessors"][0]["count"] = 1000;
  EXPECT_EQ(refusal("c.glb", short_view.glb()), "c.glb:0:0: has accessor 0 past the end of its buffer view");
}

TEST_F(FormatFiles, MeshesOf3dStudioAreRead) {
  const auto scene = load("a.3ds", test::triangle_3ds());
  ASSERT_TRUE(scene) << scene.error().front().text();
  ASSERT_EQ(scene->triangles.size(), 1u);
  EXPECT_EQ(scene->materials[0].name, "oak");
  EXPECT_NEAR(mean_reflectance(*scene), kGrey, 1e-4);
  EXPECT_EQ(refusal("b.3ds", test::triangle_3ds().substr(0, 100)), "b.3ds:0:0: is cut short");
}

TEST_F(FormatFiles, AVenueInMapCoordinatesKeepsItsMillimetres) {
  const auto scene =
      load("a.obj", "v 500000.001 5400000.002 0\nv 500001.001 5400000.002 0\nv 500000.001 5400001.003 0\nf 1 2 3\n");
  ASSERT_TRUE(scene) << scene.error().front().text();
  EXPECT_LT((scene->vertex_world_m(0) - Vec3(500000.001, 5400000.002, 0)).norm(), 1e-6);
  EXPECT_LT((scene->vertex_world_m(2) - Vec3(500000.001, 5400001.003, 0)).norm(), 1e-6);
}

TEST_F(FormatFiles, ATruncatedBinaryStlIsRefusedWithItsCounts) {
  std::string stl(80, ' ');
  test::put_bytes(stl, std::uint32_t{2});
  for (const float value : {0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) test::put_bytes(stl, value);
  test::put_bytes(stl, std::uint16_t{0});
  EXPECT_EQ(refusal("a.stl", stl), "a.stl:0:0: is cut short: it promises 2 triangles and holds 1");
  stl[80] = 1;
  stl.replace(0, 5, "solid");  // as some exporters do
  const auto whole = load("b.STL", stl);
  ASSERT_TRUE(whole) << whole.error().front().text();
  EXPECT_EQ(whole->triangles.size(), 1u);
}

TEST_F(FormatFiles, ConcavePolygonsAreCoveredOnce) {
  // An L, and a star of five points; their triangles' areas add up to theirs.
  const auto bent = load("a.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\n");
  ASSERT_TRUE(bent);
  double area = 0;
  for (const auto& t : bent->triangles) {
    const Vec3f a = bent->vertices_m[t[0]];
    const float twice = (bent->vertices_m[t[1]] - a).cross(bent->vertices_m[t[2]] - a).z();
    EXPECT_GT(twice, 0);
    area += twice / 2;
  }
  EXPECT_NEAR(area, 3, 1e-6);
}

}  // namespace
}  // namespace luxrig
