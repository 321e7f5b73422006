#pragma once
/// Measurement points from a CSV file with a header line:
///
///   name,x_m,y_m,z_m,nx,ny,nz,goal_lx,weight,max_lx
///
/// For the colour of a goal, add goal_x and goal_y, or goal_cct_k; for a tolerance of its own, goal_tolerance.
///
/// Columns may be in any order. name, x_m, y_m and z_m are required. An empty cell takes the default of the key of the
/// same name in [[point]] (schema.h; its ranges apply). Cells may be in double quotes, where "" is one quote. Empty
/// lines and lines that begin with # are skipped. UTF-8, with or without a byte-order mark; LF or CR LF.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/photometry/light_colour.h"
#include "core/result.h"
#include "core/rig/brief.h"

namespace luxrig {

struct PointsTable {
  struct Row {
    Point point;
    std::optional<Chromaticity> goal_xy;  ///< not yet in point.goal_rgb, since it may have to be moved
    FilePosition in_file;                 ///< of the name, in the CSV file
  };
  std::vector<Row> rows;          ///< rows without a problem
  std::string made_for;           ///< after "# made for " in the first line, if that is a comment: painted_version()
  std::vector<Problem> problems;  ///< file:line:column of the CSV file; at most 1000
};

/// Refuses more than `most` rows.
[[nodiscard]] PointsTable parse_points_csv(std::string_view text, const std::string& file_name, std::size_t most);
/// Refuses a file over 64 MiB.
[[nodiscard]] PointsTable load_points_csv(const std::filesystem::path& path, std::size_t most);

/// Says what the points of a surface goal follow from: its strokes, limit, weight, tolerance and spacing. Empty if its
/// strokes cannot be read.
[[nodiscard]] std::string painted_version(const SurfaceGoalSpec& goal);
/// The same for strokes that are not in its file yet.
[[nodiscard]] std::string painted_version(const SurfaceGoalSpec& goal, std::string_view strokes);
/// Points are here before their strokes are in the file, and move to points_file() after. So a program that is killed in
/// between leaves a rig that can be read.
[[nodiscard]] std::filesystem::path next_points_file(const SurfaceGoalSpec& goal);
/// A file with these points for load_points_csv().
[[nodiscard]] std::string points_csv(std::span<const Point> points, const std::string& made_for);

}  // namespace luxrig
