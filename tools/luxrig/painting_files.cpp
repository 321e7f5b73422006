#include "tools/luxrig/painting_files.h"

#include <fmt/format.h>

#include <system_error>

#include "core/goals/painting_file.h"
#include "core/rig/points_csv.h"
#include "tools/process/files.h"

namespace luxrig {

Checked<std::vector<Stroke>> strokes_of(const SurfaceGoalSpec& goal) {
  std::error_code error;
  if (!std::filesystem::exists(goal.strokes_file, error) && !error) return std::vector<Stroke>{};
  const auto text = read_file(goal.strokes_file);
  if (!text) return tl::unexpected(text.error());
  return painting_from_json(*text, goal.strokes_file.string());
}

Result<void> save_points(const SurfaceGoalSpec& goal, std::span<const Point> points) {
  return write_file(goal.points_file(), points_csv(points, painted_version(goal)));
}

Result<void> save_painting(const SurfaceGoalSpec& goal, const std::string& strokes, std::span<const Point> points) {
  const auto next = next_points_file(goal);
  if (auto written = write_file(next, points_csv(points, painted_version(goal, strokes))); !written) return written;
  if (auto written = write_file(goal.strokes_file, strokes); !written) return written;
  std::error_code error;
  std::filesystem::rename(next, goal.points_file(), error);
  if (!error && sync_folder(goal.strokes_file.parent_path().empty() ? "." : goal.strokes_file.parent_path())) return {};
  return tl::unexpected(
      Fault{Cause::system, {}, fmt::format("cannot replace {}: {}", goal.points_file().string(), error.message()), {}});
}

}  // namespace luxrig
