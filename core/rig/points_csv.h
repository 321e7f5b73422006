#pragma once
/// Measurement points from a CSV file with a header line.
///
///   name,x_m,y_m,z_m,nx,ny,nz,goal_lx,weight,max_lx
///
/// and, for the colour of a goal, goal_x and goal_y, or goal_cct_k.
///
/// Columns in any order; name, x_m, y_m and z_m must be there. An empty cell takes the default of the key of the same
/// name in [[point]] (schema.h, whose ranges hold). Cells may stand in double quotes, "" in them is one quote. Empty
/// lines and lines that begin with # are skipped. UTF-8, with or without a byte-order mark; LF or CR LF.

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "core/photometry/light_colour.h"
#include "core/result.h"
#include "core/rig/rig.h"

namespace luxrig {

struct PointsTable {
  struct Row {
    Point point;
    std::optional<Chromaticity> goal_xy;  ///< not yet in point.goal_rgb, since it may have to be moved
    Place place;                          ///< of its name, in the CSV file
  };
  std::vector<Row> rows;          ///< those without a problem
  std::vector<Problem> problems;  ///< file:line:column of the CSV file; at most 1000
};

/// Refuses more than `most` rows.
[[nodiscard]] PointsTable parse_points_csv(std::string_view text, const std::string& file_name, std::size_t most);
/// Refuses a file over 64 MiB.
[[nodiscard]] PointsTable load_points_csv(const std::filesystem::path& path, std::size_t most);

}  // namespace luxrig
