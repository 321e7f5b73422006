// Painting light on surfaces: patches of scenes of 10^4 to 10^7 triangles, and strokes on a million.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <random>

#include "core/goals/goal_points.h"
#include "tools/bench/goals/canvas.h"
#include "tools/bench/goals/tiled_hall.h"
#include "tools/bench/row_progress.h"
#include "tools/bench/suites.h"

namespace luxrig {
namespace {

void add_patches(const BenchOptions& options, std::vector<BenchRow>& rows) {
  struct Size {
    const char* name;
    std::size_t triangles;
    double cell_m;
  };
  constexpr Size kSizes[] = {{"patches-1e4", 10'000, kGoalCell_m},
                             {"patches-1e5", 100'000, kGoalCell_m},
                             {"patches-1e6", 1'000'000, kGoalCell_m},
                             {"patches-fine-1e6", 1'000'000, kGoalCell_m / 2},
                             {"patches-1e7", 10'000'000, kGoalCell_m}};
  for (const Size& size : kSizes) {
    if (!wanted_goal_case(options, size.name) || (options.quick && size.triangles > 1'000'000)) continue;
    const auto canvas = make_canvas(make_tiled_hall(size.triangles), size.cell_m, options);
    if (!canvas) continue;
    const bool judged = size.triangles == 1'000'000 && size.cell_m == kGoalCell_m;
    rows.push_back(patches_row(size.name, *canvas, size.cell_m, judged ? std::optional(3.0) : std::nullopt));
    say_row_made(rows.back());
  }
}

/// Seconds from a call until the values that it changed are in a buffer as a page gets them.
class StrokeClock {
 public:
  explicit StrokeClock(Painting& painting) : painting_(painting) {}

  template <class Call>
  void time(std::vector<double>& seconds, const Call& call) {
    const auto start = std::chrono::steady_clock::now();
    call();
    buffer_.clear();
    for (const std::uint32_t patch : painting_.changed()) buffer_.emplace_back(patch, painting_.lux()[patch]);
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    all_.push_back(seconds.back());
  }
  [[nodiscard]] const std::vector<double>& all() const { return all_; }

 private:
  Painting& painting_;
  std::vector<std::pair<std::uint32_t, float>> buffer_;
  std::vector<double> all_;
};

BenchRow strokes_row(const std::string& name, const std::string& method, std::vector<double> seconds,
                     std::optional<double> target_seconds, const Canvas& canvas) {
  std::sort(seconds.begin(), seconds.end());
  const auto at = [&](double share) { return seconds[static_cast<std::size_t>(share * double(seconds.size() - 1))]; };
  GoalColumns columns = columns_of(canvas);
  columns.note = fmt::format("95th percentile of {}; median {:.3g} ms; worst {:.3g} ms", seconds.size(), 1000 * at(0.5),
                             1000 * at(1));
  return goal_row(name, method, at(0.95), target_seconds, columns);
}

/// What a person does: mostly brushes, drawn on and on; also fills, erasing, undo and redo. Places are anywhere.
void add_strokes(const BenchOptions& options, std::vector<BenchRow>& rows) {
  const std::string name = "strokes-1e6";
  if (!wanted_goal_case(options, name)) return;
  const auto canvas = make_canvas(make_tiled_hall(1'000'000), kGoalCell_m, options);
  if (!canvas) return;
  const SurfacePatches& surface = canvas->surface;
  Painting painting(surface, canvas->rays);
  StrokeClock clock(painting);
  std::mt19937 random(1);
  const auto between = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  const auto somewhere = [&] {
    const auto patch = static_cast<std::uint32_t>(between(0, static_cast<double>(surface.size()) - 0.5));
    return SurfacePlace{surface.position_world_m(patch), surface.patches[patch].normal.cast<double>().normalized()};
  };
  std::vector<double> brush, bucket, selective, eraser, undo;
  for (int i = 0, strokes = options.quick ? 100 : 400; i < strokes; ++i) {
    const double kind = between(0, 1), lux = between(50, 500);
    SurfacePlace at = somewhere();
    if (kind < 0.5) {
      const Stroke stroke{StrokeKind::brush, {at}, lux, between(0.05, 1), between(0, 1)};
      clock.time(brush, [&] { painting.add(stroke); });
      const Vec3 step = 0.1 * at.normal_world.unitOrthogonal();
      for (int drawn = 0; drawn < 5; ++drawn) {
        at.position_world_m += step;
        clock.time(brush, [&] { painting.extend(at); });
      }
    } else if (kind < 0.65) {
      clock.time(bucket, [&] { painting.add({StrokeKind::bucket, {at}, lux, 0, 0}); });
    } else if (kind < 0.8) {
      clock.time(selective, [&] { painting.add({StrokeKind::selective, {at}, lux, 0, 0}); });
    } else if (kind < 0.85) {
      clock.time(eraser, [&] { painting.add({StrokeKind::eraser, {at}, 0, 0, 0}); });
    } else {
      clock.time(undo, [&] { (void)painting.undo(); });
      clock.time(undo, [&] { (void)painting.redo(); });
    }
  }
  rows.push_back(strokes_row(name, "all", clock.all(), 0.004, *canvas));
  for (const auto& [method, seconds] :
       {std::pair{"brush", brush}, {"bucket", bucket}, {"selective", selective}, {"eraser", eraser}, {"undo", undo}})
    if (!seconds.empty()) rows.push_back(strokes_row(name, method, seconds, {}, *canvas));
  say_row_made(rows.back());
  GoalColumns columns = columns_of(*canvas);
  std::size_t points = 0;
  const CallSeconds took = timed([&] { points = goal_points(surface, painting.lux(), {"all", {}, 1}, {}).size(); });
  columns.cpu_s = took.cpu;
  columns.note = fmt::format("{} points", points);
  rows.push_back(goal_row("points-1e6", "goal points", took.wall, {}, columns));
}

}  // namespace

std::vector<BenchRow> bench_goals(const BenchOptions& options) {
  std::vector<BenchRow> rows;
  add_patches(options, rows);
  add_strokes(options, rows);
  add_apartment(options, rows);
  return rows;
}

}  // namespace luxrig
