#include "core/scene/mesh/mesh_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "tests/core/scene/mesh/mesh_maker.h"

namespace luxrig {
namespace {

/// A folder for the files of one test.
class MeshFiles : public testing::Test {
 protected:
  MeshFiles() {
    std::string name = (std::filesystem::temp_directory_path() / "luxrig-mesh-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~MeshFiles() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  Checked<Scene> load(const std::string& name, const std::string& bytes, UpAxis up = UpAxis::z,
                      double metres_per_unit = 1) const {
    return load_mesh({write(name, bytes), metres_per_unit, up});
  }

  std::filesystem::path folder_;
};

/// A wavy sheet of side x side squares as binary PLY (little-endian, as is this machine): 2·side² triangles.
std::string sheet_ply(int side) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                      std::to_string((side + 1) * (side + 1)) +
                      "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                      std::to_string(2 * side * side) + "\nproperty list uchar int vertex_indices\nend_header\n";
  for (int i = 0; i <= side; ++i) {
    for (int j = 0; j <= side; ++j) {
      test::put_bytes(bytes, static_cast<float>(i));
      test::put_bytes(bytes, static_cast<float>(j));
      test::put_bytes(bytes, std::sin(0.1f * static_cast<float>(i + j)));
    }
  }
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const int v = i * (side + 1) + j;
      for (const auto& triangle : {std::array{v, v + 1, v + side + 2}, std::array{v, v + side + 2, v + side + 1}}) {
        test::put_bytes(bytes, static_cast<unsigned char>(3));
        for (const int index : triangle) test::put_bytes(bytes, index);
      }
    }
  }
  return bytes;
}

/// A glTF with one right triangle in x and y (glTF's frame, +Y up) in the given nodes.
std::string triangle_gltf(const std::string& nodes, const std::string& uri) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)" + nodes +
         R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],
"materials":[{"name":"plaster","pbrMetallicRoughness":{"baseColorFactor":[0.25,0.5,0.75,1]}}],
"buffers":[{"uri":")" +
         uri + R"(","byteLength":36}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}]})";
}
std::string triangle_bytes() {
  std::string bytes;
  for (const float value : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) test::put_bytes(bytes, value);
  return bytes;
}

Eigen::AlignedBox3d bounds_of(const Scene& scene) {
  Eigen::AlignedBox3d bounds;
  for (const auto& triangle : scene.triangles) {
    for (const std::uint32_t index : triangle) bounds.extend(scene.vertex_world_m(index));
  }
  return bounds;
}

TEST_F(MeshFiles, ATriangleOfObjKeepsItsPlaceUnitAndMaterial) {
  write("paint.mtl", "newmtl oak floor\nKd 0.4 0.3 0.2\nnewmtl unstated\nKs 1 1 1\n");
  const auto scene = load("a.obj",
                          "mtllib paint.mtl\nv 100 200 300\nv 200 200 300\nv 100 300 300\nusemtl oak floor\nf 1 2 3\n"
                          "usemtl unstated\nf 1 3 2\nusemtl missing\nf 2 3 1\n",
                          UpAxis::z, 0.01);
  ASSERT_TRUE(scene.has_value()) << scene.error().front().text();
  ASSERT_EQ(scene->triangles.size(), 3u);
  EXPECT_NEAR((bounds_of(*scene).min() - Vec3(1, 2, 3)).norm(), 0, 1e-6);
  EXPECT_NEAR((bounds_of(*scene).max() - Vec3(2, 3, 3)).norm(), 0, 1e-6);
  EXPECT_EQ(scene->object_names, std::vector<std::string>{"a.obj"});
  const Material& oak = scene->materials[scene->material_of_triangle[0]];
  EXPECT_EQ(oak.name, "oak floor");
  EXPECT_TRUE(oak.coloured);
  EXPECT_NEAR((oak.reflectance_rgb - Vec3(0.4, 0.3, 0.2)).norm(), 0, 1e-6);
  EXPECT_EQ(scene->materials[scene->material_of_triangle[1]].name, "unstated");
  EXPECT_FALSE(scene->materials[scene->material_of_triangle[1]].coloured);
  EXPECT_EQ(scene->materials[scene->material_of_triangle[2]].name, "missing");
  EXPECT_FALSE(scene->materials[scene->material_of_triangle[2]].coloured);
}

TEST_F(MeshFiles, ConvertsEveryUpAxisToZWithoutMirroring) {
  const std::string text = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 2 3\nf 1 3 4\nf 1 4 2\n";
  const auto corner = [&](UpAxis up, std::size_t vertex) {
    const auto scene = load("up.obj", text, up);
    // OBJ vertices come back unshared: find the file's vertex by its length, which a rotation keeps.
    for (const auto& v : scene->vertices_m) {
      if (std::abs(v.norm() - static_cast<float>(vertex)) < 1e-6f) return Vec3(v.cast<double>());
    }
    return Vec3(9, 9, 9);
  };
  EXPECT_EQ(corner(UpAxis::z, 3), Vec3(0, 0, 3));
  EXPECT_EQ(corner(UpAxis::y, 1), Vec3(1, 0, 0));
  EXPECT_EQ(corner(UpAxis::y, 2), Vec3(0, 0, 2));
  EXPECT_EQ(corner(UpAxis::y, 3), Vec3(0, -3, 0));  // so -Z of the file is +Y
  EXPECT_EQ(corner(UpAxis::x, 1), Vec3(0, 0, 1));
  EXPECT_EQ(corner(UpAxis::x, 2), Vec3(0, 2, 0));
  EXPECT_EQ(corner(UpAxis::x, 3), Vec3(-3, 0, 0));
}

TEST_F(MeshFiles, SplitsPolygonsAndDropsPointsAndLines) {
  const auto scene = load("q.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nl 1 2\np 3\n");
  ASSERT_TRUE(scene.has_value());
  EXPECT_EQ(scene->triangles.size(), 2u);
}

TEST_F(MeshFiles, AppliesTheTransformsOfNestedNodesAndTheBaseColour) {
  write("one.bin", triangle_bytes());
  const auto scene = load(
      "a.gltf", triangle_gltf(R"({"children":[1],"translation":[10,20,30]},{"mesh":0,"scale":[2,3,1]})", "one.bin"),
      UpAxis::y);
  ASSERT_TRUE(scene.has_value()) << scene.error().front().text();
  EXPECT_NEAR((bounds_of(*scene).min() - Vec3(10, -30, 20)).norm(), 0, 1e-5);
  EXPECT_NEAR((bounds_of(*scene).max() - Vec3(12, -30, 23)).norm(), 0, 1e-5);
  const Material& material = scene->materials[scene->material_of_triangle[0]];
  EXPECT_EQ(material.name, "plaster");
  EXPECT_TRUE(material.coloured);
  EXPECT_NEAR((material.reflectance_rgb - Vec3(0.25, 0.5, 0.75)).norm(), 0, 1e-6);
}

TEST_F(MeshFiles, OpensNoFileOutsideTheFolderOfTheMesh) {
  std::filesystem::create_directory(folder_ / "inside");
  write("outside.bin", triangle_bytes());
  write("inside/own.bin", triangle_bytes());
  std::filesystem::create_symlink(folder_ / "outside.bin", folder_ / "inside" / "link.bin");
  const std::string node = R"({"mesh":0})";
  EXPECT_TRUE(load("inside/a.gltf", triangle_gltf(node, "own.bin")).has_value());
  EXPECT_FALSE(load("inside/b.gltf", triangle_gltf(node, "../outside.bin")).has_value());
  EXPECT_FALSE(load("inside/c.gltf", triangle_gltf(node, "link.bin")).has_value());
  EXPECT_FALSE(load("inside/d.gltf", triangle_gltf(node, (folder_ / "outside.bin").string())).has_value());
}

TEST_F(MeshFiles, CountsCleanedTrianglesAndKeepsTheRest) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 5\nproperty list uchar int vertex_indices\nend_header\n";
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Vec3f& v : {Vec3f(0, 0, 0), Vec3f(1, 0, 0), Vec3f(0, 1, 0), Vec3f(2, 0, 0), Vec3f(nan, 0, 0)}) {
    for (int axis = 0; axis < 3; ++axis) test::put_bytes(bytes, v[axis]);
  }
  const int faces[5][3] = {{0, 1, 2}, {0, 1, 3}, {0, 0, 2}, {0, 1, 4}, {1, 3, 2}};
  for (const auto& face : faces) {
    test::put_bytes(bytes, static_cast<unsigned char>(3));
    for (const int index : face) test::put_bytes(bytes, index);
  }
  const auto scene = load("dirty.ply", bytes);
  ASSERT_TRUE(scene.has_value()) << scene.error().front().text();
  EXPECT_EQ(scene->triangles.size(), 2u);
  EXPECT_EQ(scene->cleaning.non_finite_vertices, 1u);
  EXPECT_EQ(scene->cleaning.degenerate_triangles, 2u);  // collinear, and a repeated corner
  ASSERT_EQ(scene->warnings.size(), 1u);
  for (const auto& vertex : scene->vertices_m) EXPECT_TRUE(vertex.allFinite());
}

TEST_F(MeshFiles, KeepsThinTrianglesFarFromTheOrigin) {
  const auto scene = load("thin.obj", "v 1000 0 0\nv 1001 0 0\nv 1000.5 0.001 0\nf 1 2 3\n");
  ASSERT_TRUE(scene.has_value());
  EXPECT_EQ(scene->cleaning.total(), 0u);
}

struct Broken {
  const char* name;
  std::string bytes;
};

TEST_F(MeshFiles, RefusesInvalidMeshesWithAProblem) {
  const std::string ply = sheet_ply(4);
  std::string huge = ply;
  huge.replace(huge.find("element face 32"), 15, "element face 60000000");
  std::string promises = ply;
  promises.replace(promises.find("element vertex 25"), 17, "element vertex 4000000000");
  std::string bad_index = ply;
  const int far = 1 << 30;
  for (std::size_t i = 0; i < 32; ++i) std::memcpy(&bad_index[bad_index.size() - 12 - 13 * i], &far, sizeof far);
  const Broken broken[] = {
      {"empty.obj", ""},
      {"nothing.obj", "# nothing here\n"},
      {"points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"},
      {"flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"},
      {"index.obj", "v 0 0 0\nv 1 0 0\nv 2 1 0\nf 1 2 9\n"},
      {"text.ply", "this is no mesh\n"},
      {"noend.ply", "ply\nformat ascii 1.0\nelement vertex 3\n"},
      {"huge.ply", huge},
      {"promises.ply", promises},
      {"index.ply", bad_index},
      {"half.ply", ply.substr(0, ply.size() / 2)},
      {"text.glb", "glTF but not really"},
      {"text.gltf", "{\"asset\":"},
      {"missing.gltf", triangle_gltf(R"({"mesh":0})", "nowhere.bin")},
      {"text.stl", "solid nothing"},
      {"mesh.blend", "BLENDER"},
      {"zip.obj.zip", "PK"},
  };
  for (const Broken& one : broken) {
    const auto scene = load(one.name, one.bytes);
    ASSERT_FALSE(scene.has_value()) << one.name;
    EXPECT_EQ(scene.error().front().file, (folder_ / one.name).string());
    EXPECT_FALSE(scene.error().front().what.empty());
    EXPECT_FALSE(scene.error().front().mend.empty());
  }
  EXPECT_FALSE(load_mesh({folder_ / "absent.obj", 1, UpAxis::z}).has_value());
  EXPECT_FALSE(load_mesh({folder_, 1, UpAxis::z}).has_value());
}

TEST_F(MeshFiles, KeepsOnlyUsedMaterials) {
  write("paint.mtl",
        "newmtl idle\nKd 1 1 1\nnewmtl oak\nKd 0.4 0.3 0.2\nnewmtl thin\nKd 1 1 1\nnewmtl snow\nKd 1 1 1\n");
  const auto scene = load("a.obj",
                          "mtllib paint.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nusemtl thin\nf 1 2 4\n"
                          "usemtl snow\nf 1 2 3\nusemtl oak\nf 1 3 2\nusemtl snow\nf 2 4 3\n");
  ASSERT_TRUE(scene.has_value()) << scene.error().front().text();
  ASSERT_EQ(scene->materials.size(), 2u);  // idle has no face, and the faces of thin have no area
  ASSERT_EQ(scene->triangles.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const Material& material = scene->materials[scene->material_of_triangle[i]];
    const auto& index = scene->triangles[i];
    // The only oak face looks down.
    const Vec3f a = scene->vertices_m[index[0]];
    const float up = (scene->vertices_m[index[1]] - a).cross(scene->vertices_m[index[2]] - a).z();
    EXPECT_EQ(material.name, up < 0 ? "oak" : "snow");
    EXPECT_EQ(material.too_bright, up > 0);
  }
}

TEST_F(MeshFiles, DropsTheDefaultMaterialAddedByGltfReaders) {
  write("one.bin", triangle_bytes());
  const auto scene = load("a.gltf", triangle_gltf(R"({"mesh":0})", "one.bin"));
  ASSERT_TRUE(scene.has_value()) << scene.error().front().text();
  ASSERT_EQ(scene->materials.size(), 1u);
  EXPECT_EQ(scene->materials.front().name, "plaster");
}

TEST_F(MeshFiles, LoadsAMillionTrianglesInSeconds) {
  const auto path = write("million.ply", sheet_ply(708));
  const auto began = std::chrono::steady_clock::now();
  const auto scene = load_mesh({path, 0.01, UpAxis::z});
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  ASSERT_TRUE(scene.has_value()) << scene.error().front().text();
  EXPECT_EQ(scene->triangles.size(), 2u * 708 * 708);
  EXPECT_EQ(scene->cleaning.total(), 0u);
  RecordProperty("seconds", std::to_string(took.count()));
  std::printf("%zu triangles in %.2f s\n", scene->triangles.size(), took.count());
  EXPECT_LT(took.count(), 60);  // 2 s on two old cores; the sanitizers take many times that
}

TEST_F(MeshFiles, RefusesAFaceThatTakesTooLongToSplit) {
  std::string text;
  std::string face = "f";
  for (int i = 0; i < 1001; ++i) {
    const double turn_rad = 2 * 3.14159265358979 * i / 1001;
    text += "v " + std::to_string(std::cos(turn_rad)) + " " + std::to_string(std::sin(turn_rad)) + " 0\n";
    face += " " + std::to_string(i + 1);
  }
  EXPECT_FALSE(load("many.obj", text + face + "\n").has_value());
  const auto split = load("fewer.obj", text + face.substr(0, face.rfind(' ')) + "\n");
  ASSERT_TRUE(split.has_value()) << split.error().front().text();
  EXPECT_EQ(split->triangles.size() + split->cleaning.degenerate_triangles, 998u);
}

TEST_F(MeshFiles, LoadsBothFormsOfStl) {
  const auto ascii = load("a.stl",
                          "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                          "endloop\nendfacet\nendsolid s\n");
  ASSERT_TRUE(ascii.has_value()) << ascii.error().front().text();
  EXPECT_EQ(ascii->triangles.size(), 1u);
  EXPECT_FALSE(ascii->materials.front().coloured);
}

}  // namespace
}  // namespace luxrig
