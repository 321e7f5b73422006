#include "core/scene/mesh/ply_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <random>
#include <string>

#include "core/scene/mesh/ply_header.h"

namespace luxrig {
namespace {

/// One file for the test, deleted with it.
class PlyFiles : public testing::Test {
 protected:
  PlyFiles() {
    std::string name = (std::filesystem::temp_directory_path() / "luxrig-ply-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~PlyFiles() override { std::filesystem::remove_all(folder_); }

  Checked<PolygonMesh> read(const std::string& bytes) const {
    std::ofstream(folder_ / "a.ply", std::ios::binary) << bytes;
    return read_ply(folder_ / "a.ply");
  }
  /// "line: what" of the only problem; empty if there is none.
  std::string refusal(const std::string& bytes) const {
    const auto mesh = read(bytes);
    if (mesh) return "";
    EXPECT_EQ(mesh.error().size(), 1u);
    EXPECT_FALSE(mesh.error().front().mend.empty());
    return std::to_string(mesh.error().front().line) + ": " + mesh.error().front().what;
  }

  std::filesystem::path folder_;
};

/// A value in either byte order (this machine is little-endian, as the mesh tests assume).
template <class T>
void put(std::string& bytes, T value, bool big_endian) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  if (big_endian) std::reverse(raw, raw + sizeof value);
  bytes.append(raw, sizeof value);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

// Lines:                        1    2                 3                 4                 5
const std::string kTriangle =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    //  6                 7               8                                       9           10…
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 "
    "2\n";

TEST_F(PlyFiles, ReadsTheSameMeshInAllThreeFormsAmongOtherElements) {
  const std::string shape =
      "comment of no use\nobj_info a scan\nelement camera 2\nproperty double view\nproperty list ushort short tags\n"
      "element vertex 4\nproperty uchar red\nproperty double z\nproperty float x\nproperty list uchar float y_list\n"
      "property short y\nelement face 2\nproperty uint flags\nproperty list uint ushort vertex_index\n"
      "property list uchar float texcoord\nend_header\n";
  for (const char* const form : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    std::string bytes = std::string("ply\r\nformat ") + form + " 1.0\n" + shape;
    if (std::string(form) == "ascii") {
      bytes +=
          "0.5 2 7 8\n1e3 0\n9 0.25 1 1 0.1 -4\n9 0.5 2 0 5\n+9 0.75 3 0 6\n9 1 4 0 7\n1 3 0 1 2 2 0 1\n1 4 3 2 1 0 "
          "0\n";
    } else {
      const bool big = std::string(form) == "binary_big_endian";
      const auto add = [&](auto... values) { (put(bytes, values, big), ...); };
      using u8 = std::uint8_t;
      using u16 = std::uint16_t;
      using i16 = std::int16_t;
      add(0.5, u16(2), i16(7), i16(8), 1e3, u16(0));
      add(u8(9), 0.25, 1.f, u8(1), 0.1f, i16(-4));
      add(u8(9), 0.5, 2.f, u8(0), i16(5), u8(9), 0.75, 3.f, u8(0), i16(6), u8(9), 1.0, 4.f, u8(0), i16(7));
      add(1u, 3u, u16(0), u16(1), u16(2), u8(2), 0.f, 1.f);
      add(1u, 4u, u16(3), u16(2), u16(1), u16(0), u8(0));
    }
    const auto mesh = read(bytes);
    ASSERT_TRUE(mesh.has_value()) << form << ": " << mesh.error().front().text();
    ASSERT_EQ(mesh->vertices.size(), 4u) << form;
    EXPECT_EQ(mesh->vertices[0], Vec3(1, -4, 0.25f)) << form;
    EXPECT_EQ(mesh->vertices[3], Vec3(4, 7, 1)) << form;
    EXPECT_EQ(mesh->corner_counts, (std::vector<std::uint32_t>{3, 4})) << form;
    EXPECT_EQ(mesh->corners, (std::vector<std::uint32_t>{0, 1, 2, 3, 2, 1, 0})) << form;
  }
}

TEST_F(PlyFiles, NamesTheLineOfEveryBrokenHeader) {
  EXPECT_EQ(refusal(kTriangle), "");
  const auto with = [&](const char* from, const char* to) { return refusal(replaced(kTriangle, from, to)); };
  EXPECT_EQ(with("ply", "plx"), "1: does not begin with the line 'ply'");
  EXPECT_EQ(with("ascii", "asci"), "2: has a PLY format that is not known: \"format asci 1.0\"");
  EXPECT_EQ(with("1.0", "2.0"), "2: has a PLY format that is not known: \"format ascii 2.0\"");
  EXPECT_EQ(with("format ascii 1.0\n", ""), "0: does not say whether its PLY is ascii or binary");
  EXPECT_EQ(with("vertex 3", "vertex"), "3: has a PLY element without a name and a count: \"element vertex\"");
  EXPECT_EQ(with("vertex 3", "vertex -3"), "3: has a PLY element without a name and a count: \"element vertex -3\"");
  EXPECT_EQ(with("float x", "floaty x"), "4: has a PLY property of a type that is not known: \"property floaty x\"");
  EXPECT_EQ(with("float y", "float"), "5: has a PLY property without a type and a name: \"property float\"");
  EXPECT_EQ(with("float y", "float x"), "5: has the PLY property \"x\" twice in one element");
  EXPECT_EQ(with("float z", "float w"), "3: has vertices without z");
  EXPECT_EQ(with("property float z", "prop\x01rty"), "6: has a header line that PLY does not know: \"prop?rty\"");
  EXPECT_EQ(with("face 1", "vertex 1"), "7: has the PLY element \"vertex\" twice");
  EXPECT_EQ(with("element vertex 3", "comment vertex 3"), "4: has a PLY property before any element");
  EXPECT_EQ(with("uchar int", "float int").substr(0, 17), "8: has a PLY prop");
  EXPECT_EQ(with("uchar int", "uchar float").substr(0, 30), "7: has faces without one list ");
  EXPECT_EQ(with("vertex_indices", "indices").substr(0, 30), "7: has faces without one list ");
  EXPECT_EQ(with("face 1", "face 0"), "0: has no faces");
  EXPECT_EQ(with("face 1", "face 60000000"), "7: has more than 50 million faces");
  EXPECT_EQ(with("face 1", "face 9"), "7: is cut short: its header promises more elements than it has bytes");
  EXPECT_EQ(with("end_header", "end"), "9: has a header line that PLY does not know: \"end\"");
  EXPECT_EQ(with("end_header\n", std::string(70000, '\n').c_str()), "0: has no PLY header that ends within 64 KiB");
  EXPECT_EQ(with("element face", "element bare 4000000000\nelement face"), "7: has a PLY element without properties");
}

TEST_F(PlyFiles, NamesTheLineOfABrokenAsciiBody) {
  const auto with = [&](const char* from, const char* to) { return refusal(replaced(kTriangle, from, to)); };
  EXPECT_EQ(with("1 0 0", "1 zero 0"), "11: has no number of the stated type in vertex 2");
  EXPECT_EQ(with("3 0 1 2", "3 0 1.5 2"), "13: has no number of the stated type in face 1");
  EXPECT_EQ(with("3 0 1 2", "-3 0 1 2"), "13: has no number of the stated type in face 1");
  EXPECT_EQ(with("3 0 1 2", "4294967295 0 1 2"), "13: has more than 1000 corners in face 1");
  EXPECT_EQ(with("3 0 1 2", "3       0 1").substr(4), "is cut short at face 1");
}

TEST_F(PlyFiles, KeepsInvalidTrianglesForTheCleaningToCount) {
  const auto mesh = read(replaced(replaced(kTriangle, "1 0 0", "nan 1e999 1e300"), "3 0 1 2", "3 -1 1 4294967296"));
  ASSERT_TRUE(mesh.has_value()) << mesh.error().front().text();
  for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(std::isnan(mesh->vertices[1][axis]));
  EXPECT_EQ(mesh->corners, (std::vector<std::uint32_t>{0xffffffffu, 1, 0xffffffffu}));
}

TEST_F(PlyFiles, RefusesEveryTruncation) {
  std::string binary = replaced(kTriangle.substr(0, kTriangle.find("0 0 0")), "ascii", "binary_little_endian");
  for (const float value : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) put(binary, value, false);
  put(binary, std::uint8_t{3}, false);
  for (const int index : {0, 1, 2}) put(binary, index, false);
  ASSERT_EQ(refusal(binary), "");
  for (std::size_t size = 0; size < binary.size(); ++size) EXPECT_NE(refusal(binary.substr(0, size)), "") << size;
  // An ascii file may lack its last newline, but nothing else.
  for (std::size_t size = 0; size + 1 < kTriangle.size(); ++size) {
    EXPECT_NE(refusal(kTriangle.substr(0, size)), "") << size;
  }
}

TEST_F(PlyFiles, IsConsistentAcrossBlockBoundaries) {
  // 20,000 vertices in words of 1 to 20 characters: many cross the border of a 64 KiB block.
  std::mt19937 random(7);
  std::string bytes = replaced(kTriangle.substr(0, kTriangle.find("0 0 0")), "vertex 3", "vertex 20000");
  std::vector<double> wanted;
  for (int i = 0; i < 60000; ++i) {
    wanted.push_back(static_cast<double>(random()) / 1024);
    std::string word = std::to_string(wanted.back());
    wanted.back() = std::stod(word);
    bytes += word + std::string(1 + random() % 9, i % 3 == 2 ? '\n' : ' ');
  }
  const auto mesh = read(bytes + "3 0 1 2");
  ASSERT_TRUE(mesh.has_value()) << mesh.error().front().text();
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    ASSERT_EQ(mesh->vertices[i / 3][static_cast<Eigen::Index>(i % 3)], wanted[i]) << i;
  }
}

}  // namespace
}  // namespace luxrig
