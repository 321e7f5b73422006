#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "core/scene/mesh/mesh_file.h"
#include "tests/folders.h"
#include "tools/bench/highlight/rows.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

/// The text after the comments and the name.
std::string geometry_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::size_t from = text.find("\nv ");
  return from == std::string::npos ? std::string() : text.substr(from);
}

TEST(HighlightExport, WritesTheGeneratedObjectsIncludingThoseThatAreShipped) {
  std::string name = (std::filesystem::temp_directory_path() / "luxrig-export-XXXXXX").string();
  const std::filesystem::path folder = ::mkdtemp(name.data());
  for (const BenchRow& row : export_highlight_objects(folder)) EXPECT_EQ(row.error, 0) << row.case_name;
  const auto terrain = load_mesh({folder / "terrain.obj", 1, UpAxis::z});
  ASSERT_TRUE(terrain);
  const Scene made = make_terrain();
  ASSERT_EQ(terrain->triangles.size(), made.triangles.size());
  double area_m2 = 0, made_m2 = 0;
  for (const auto& [scene, sum_m2] : {std::pair(&*terrain, &area_m2), std::pair(&made, &made_m2)})
    for (const auto& t : scene->triangles) {
      const Vec3f &a = scene->vertices_m[t[0]], &b = scene->vertices_m[t[1]], &c = scene->vertices_m[t[2]];
      *sum_m2 += (b - a).cross(c - a).norm() / 2;
    }
  EXPECT_NEAR(area_m2, made_m2, 1e-3 * made_m2);
  for (const auto& [file, written] : {std::pair("rigs/frieze/objects/frieze.obj", "relief-10mm.obj"),
                                      std::pair("rigs/portrait/objects/head.obj", "head-4mm.obj")}) {
    const std::string shipped = geometry_of(test::source_folder() / file);
    EXPECT_GT(shipped.size(), 100'000u);
    EXPECT_TRUE(geometry_of(folder / written) == shipped) << file;
  }
  std::filesystem::remove_all(folder);

  for (const BenchRow& row : export_highlight_objects("/proc/nowhere")) EXPECT_FALSE(row.error == 0) << row.case_name;
}

}  // namespace
}  // namespace luxrig
