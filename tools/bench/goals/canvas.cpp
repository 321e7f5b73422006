#include "tools/bench/goals/canvas.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "tools/bench/peak_memory.h"

namespace luxrig {
namespace {

double area_m2(const Scene& scene) {
  double sum_m2 = 0;
  for (const auto& [a, b, c] : scene.triangles)
    sum_m2 += 0.5 * (scene.vertex_world_m(b) - scene.vertex_world_m(a))
                        .cross(scene.vertex_world_m(c) - scene.vertex_world_m(a))
                        .norm();
  return sum_m2;
}

}  // namespace

BenchRow goal_row(const std::string& name, const std::string& method, double seconds,
                  std::optional<double> target_seconds, const GoalColumns& columns) {
  BenchRow row{name, method, std::numeric_limits<double>::quiet_NaN(), seconds, {}, target_seconds, {}};
  const auto text = [](std::optional<double> value) { return value ? fmt::format("{:.3g}", *value) : std::string(); };
  row.further = {{"triangles", std::to_string(columns.triangles)},
                 {"patches", std::to_string(columns.patches)},
                 {"groups", std::to_string(columns.groups)},
                 {"cpu_seconds", text(columns.cpu_s)},
                 {"peak_gib", text(columns.peak_gib)},
                 {"note", columns.note}};
  return row;
}

bool wanted_goal_case(const BenchOptions& options, const std::string& name) { return name.rfind(options.only, 0) == 0; }

std::optional<Canvas> make_canvas(Scene scene, double cell_m, const BenchOptions& options) {
  Canvas canvas{std::move(scene), RayScene(Scene{}), {}, {}, 0};
  canvas.rays = RayScene(canvas.scene);
  Result<SurfacePatches> surface;
  forget_peak();
  canvas.took = timed([&] { surface = make_surface_patches(canvas.scene, canvas.rays, {cell_m, options.threads}); });
  canvas.peak_gib = peak_gib();
  if (!surface) {
    fmt::print(stderr, "{}\n", surface.error().detail);
    return std::nullopt;
  }
  canvas.surface = std::move(*surface);
  return canvas;
}

GoalColumns columns_of(const Canvas& canvas) {
  return {canvas.scene.triangles.size(), canvas.surface.size(), canvas.surface.groups(), {}, {}, {}};
}

BenchRow patches_row(const std::string& name, const Canvas& canvas, double cell_m,
                     std::optional<double> target_seconds) {
  GoalColumns columns = columns_of(canvas);
  columns.cpu_s = canvas.took.cpu;
  columns.peak_gib = canvas.peak_gib;
  columns.note = fmt::format("cells of {} m; {} links", cell_m, canvas.surface.links.size() / 2);
  BenchRow row = goal_row(name, "patches and groups", canvas.took.wall, target_seconds, columns);
  double patches_m2 = 0;
  for (const SurfacePatch& patch : canvas.surface.patches) patches_m2 += patch.area_m2;
  row.error = std::abs(patches_m2 / (2 * area_m2(canvas.scene)) - 1);
  row.target_error = 1e-5;
  return row;
}

}  // namespace luxrig
