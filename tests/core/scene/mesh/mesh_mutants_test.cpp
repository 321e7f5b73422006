// Untrusted files: thousands of garbled ones of each format. Each is refused with a remedy or read, without a crash.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <random>

#include "core/scene/mesh/files_beside.h"
#include "core/scene/mesh/mesh_reading.h"
#include "core/scene/mesh/mtl_file.h"
#include "core/scene/mesh/ply_file.h"
#include "tests/core/scene/mesh/mesh_maker.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

constexpr int kMutants = 3000;

class NothingBeside final : public FilesBeside {
  std::optional<std::string> read(const std::string&, std::size_t) const override { return std::nullopt; }
};

std::string file_bytes(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return std::string((std::istreambuf_iterator<char>(in)), {});
}

/// Bytes changed, cut out, doubled, set to extremes; often several at once.
std::string mutant_of(std::string bytes, std::mt19937& random) {
  const auto below = [&](std::size_t limit) {
    return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random);
  };
  for (std::size_t changes = 1 + below(6); changes > 0 && !bytes.empty(); --changes) {
    const std::size_t at = below(bytes.size());
    switch (below(7)) {
      case 0:
        bytes[at] = static_cast<char>(below(256));
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 2:
        bytes.erase(at, 1 + below(16));
        break;
      case 3:
        bytes.insert(at, bytes.substr(below(bytes.size()), 1 + below(32)));
        break;
      case 4:
        for (std::size_t i = at; i < std::min(at + 4, bytes.size()); ++i) bytes[i] = static_cast<char>(0xff);
        break;
      case 5:
        bytes.resize(at);
        break;
      default:
        bytes.replace(at, 1, std::to_string(below(2) == 0 ? 4294967295u : static_cast<unsigned>(below(100000))));
    }
  }
  return bytes;
}

/// `read` returns whether it accepted the file. Returns the number of accepted mutants.
template <class Read>
int feed(const std::vector<std::string>& seeds, const Read& read) {
  std::mt19937 random(20);
  int taken = 0;
  for (const std::string& seed : seeds) EXPECT_TRUE(read(seed)) << "a seed must be sound";
  for (int i = 0; i < kMutants; ++i)
    taken += read(mutant_of(seeds[static_cast<std::size_t>(i) % seeds.size()], random));
  return taken;
}

bool takes_mesh(const std::string& bytes, const std::string& extension) {
  auto mesh = read_mesh(bytes, extension, "mutant", NothingBeside());
  if (!mesh) {
    EXPECT_FALSE(mesh.error().empty());
    for (const Problem& problem : mesh.error()) EXPECT_FALSE(problem.what.empty() || problem.mend.empty());
    return false;
  }
  const PlacedMesh placed = place_mesh(std::move(*mesh), Eigen::Affine3d::Identity());
  for (const auto& triangle : placed.triangles)
    for (const std::uint32_t index : triangle) EXPECT_LT(index, placed.vertices_world_m.size());
  for (const Material& material : placed.materials) {
    EXPECT_GE(material.reflectance_rgb.minCoeff(), 0);
    EXPECT_LE(material.reflectance_rgb.maxCoeff(), 0.95);
  }
  return true;
}

test::GltfMaker rich_gltf() {
  test::GltfMaker gltf = test::GltfMaker::square();
  gltf.root["images"] = {
      {{"bufferView", gltf.view(file_bytes(test::source_folder() / "tests/data/textures/grey.png"))}}};
  gltf.root["textures"] = {{{"source", 0}}};
  gltf.root["materials"][0]["pbrMetallicRoughness"] = {{"baseColorTexture", {{"index", 0}}}};
  gltf.attributes()["COLOR_0"] = gltf.accessor<float>(std::vector<float>(12, 0.5f), 5126, "VEC3", 4);
  gltf.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
      gltf.accessor<float>({0, 0, 0, 5, 0, 0, 0, 0, 7}, 5126, "VEC3", 3);
  const std::size_t rows = gltf.view(std::string("\1\0\2\0", 4)), values = gltf.view(std::string(24, '\x3f'));
  gltf.root["accessors"][0]["sparse"] = {
      {"count", 2}, {"indices", {{"bufferView", rows}, {"componentType", 5123}}}, {"values", {{"bufferView", values}}}};
  return gltf;
}

TEST(MeshMutants, ObjIsReadOrRefused) {
  const int taken = feed({"v 0 0 0\nv 1 0 0 1 0 0\nv 1 1 0\nv 0 1 0\nv .5 2 0\nvt 0 1\nvn 0 0 1\nusemtl oak\no a\n"
                          "f 1/1/1 2 -3//1 4/1 5 \\\n 1\nf 1 2 3\nl 1 2\nmtllib none.mtl\n"},
                         [](const std::string& bytes) { return takes_mesh(bytes, "obj"); });
  EXPECT_GT(taken, 0);
}

TEST(MeshMutants, MaterialsOfObjAreReadOrRefused) {
  const int taken = feed(
      {"newmtl oak\nKd 0.5 0.4 .3\nmap_Kd -s 1 2 -mm 0 1 -clamp on oak.png\nd 0.5\nKe 1 1 1\nnewmtl b\nKd xyz 1 1 1\n",
       std::string("\xff\xfen\0e\0w\0m\0t\0l\0 \0a\0\n\0K\0d\0 \0.\0"
                   "5\0",
                   30)},
      [](const std::string& bytes) { return parse_mtl(bytes, "mutant").has_value(); });
  EXPECT_GT(taken, 0);
}

TEST(MeshMutants, StlIsReadOrRefused) {
  std::string binary(80, ' ');
  test::put_bytes(binary, std::uint32_t{2});
  for (int i = 0; i < 100; ++i) binary += static_cast<char>(i);
  const int taken = feed({"solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                          "endloop\nendfacet\nendsolid s\n",
                          binary},
                         [](const std::string& bytes) { return takes_mesh(bytes, "stl"); });
  EXPECT_GT(taken, 0);
}

TEST(MeshMutants, GltfIsReadOrRefused) {
  const int taken = feed({rich_gltf().glb(), test::GltfMaker::square().glb()},
                         [](const std::string& bytes) { return takes_mesh(bytes, "glb"); });
  EXPECT_GT(taken, 0);
}

TEST(MeshMutants, MeshesOf3dStudioAreReadOrRefused) {
  const int taken = feed({test::triangle_3ds()}, [](const std::string& bytes) { return takes_mesh(bytes, "3ds"); });
  EXPECT_GT(taken, 0);
}

TEST(MeshMutants, PlyIsReadOrRefused) {
  const auto path = std::filesystem::temp_directory_path() / ("luxrig-mutant-" + std::to_string(getpid()) + ".ply");
  const auto corpus = test::source_folder() / "tests/fuzz/corpus/ply";
  const int taken = feed({file_bytes(corpus / "ascii.ply"), file_bytes(corpus / "binary_little.ply"),
                          file_bytes(corpus / "binary_big.ply")},
                         [&](const std::string& bytes) {
                           std::ofstream(path, std::ios::binary) << bytes;
                           return read_ply(path).has_value();
                         });
  std::filesystem::remove(path);
  EXPECT_GT(taken, 0);
}

TEST(MeshMutants, PicturesAreReadOrRefused) {
  const auto folder = test::source_folder() / "tests/data/textures";
  std::vector<std::string> seeds;
  for (const char* const name : {"grey.png", "glass.png", "black-over-white.png", "grey.jpg", "progressive.jpg"})
    seeds.push_back(file_bytes(folder / name));
  const int taken = feed(seeds, [](const std::string& bytes) {
    const DecodedTexture decoded = decode_texture(bytes);
    EXPECT_NE(decoded.texture == nullptr, decoded.trouble.empty());
    if (!decoded.texture) return false;
    const Vec3 mean = decoded.texture->mean_over({{{0, 0}, {0.3f, 7}, {-2, 0.1f}}});
    return mean.minCoeff() >= 0 && mean.maxCoeff() <= 1;
  });
  EXPECT_GT(taken, 0);
}

}  // namespace
}  // namespace luxrig
