/// The made-up objects as files, for rigs and for other programs.

#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "tools/bench/highlight/rows.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

struct MadeUpObject {
  const char* name;
  Scene (*make)();
};
constexpr MadeUpObject kMadeUpObjects[] = {
    {"relief", [] { return make_carved_relief(); }}, {"relief-10mm", [] { return make_carved_relief(0.010); }},
    {"terrain", [] { return make_terrain(); }},      {"head", [] { return make_head(); }},
                                           {"head-4mm", [] { return make_head(0.004); }},
    {"helmet", [] { return make_helmet(); }},        {"inscription", [] { return make_inscription(); }}};

void write_obj(const Scene& scene, const char* name, std::ostream& out) {
  out << "o " << name << '\n';
  for (const Vec3f& v : scene.vertices_m) out << fmt::format("v {:.4f} {:.4f} {:.4f}\n", v.x(), v.y(), v.z());
  for (const auto& t : scene.triangles) out << fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  out.flush();
}

}  // namespace

std::vector<BenchRow> export_highlight_objects(const std::filesystem::path& folder) {
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  std::vector<BenchRow> rows;
  for (const MadeUpObject& object : kMadeUpObjects) {
    HighlightRow row{fmt::format("exported-{}", object.name), "", std::nan("")};
    row.target_error = 0;  // a file that cannot be written is a failure
    const auto file = folder / fmt::format("{}.obj", object.name);
    std::ofstream out(file, std::ios::binary);
    if (out) {
      const Scene scene = object.make();
      write_obj(scene, object.name, out);
      row.note = fmt::format("{} triangles", scene.triangles.size());
    }
    if (out)
      row.error = 0;
    else
      fmt::print(stderr, "{}: cannot be written\n", file.string());
    rows.push_back(bench_row_of(row));
  }
  return rows;
}

}  // namespace luxrig
