#include "core/rig/points_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>

#include "core/fingerprint.h"
#include "core/rig/problem_list.h"
#include "core/rig/reading/section.h"
#include "core/rig/schema.h"
#include "core/text/nearest.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{64} << 20;

constexpr std::string_view kMadeFor = "# made for ";

enum Column {
  kName,
  kX,
  kY,
  kZ,
  kNx,
  kNy,
  kNz,
  kGoal,
  kGoalX,
  kGoalY,
  kGoalCct,
  kWeightColumn,
  kMax,
  kTolerance,
  kColumns
};
constexpr std::array<std::string_view, kColumns> kColumnNames = {
    "name",    "x_m",    "y_m",    "z_m",        "nx",     "ny",     "nz",
    "goal_lx", "goal_x", "goal_y", "goal_cct_k", "weight", "max_lx", "goal_tolerance"};
constexpr std::array<std::string_view, kColumns> kKeys = {
    "name",    "position_m", "position_m", "position_m", "normal", "normal", "normal",
    "goal_lx", "goal_xy",    "goal_xy",    "goal_cct_k", "weight", "max_lx", "goal_tolerance"};

struct Cell {
  std::string text;
  FilePosition in_file;
};

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

/// Cells of one line; nullopt and a problem if a quote is not closed.
std::optional<std::vector<Cell>> split(std::string_view line, int line_number, ProblemList& problems) {
  std::vector<Cell> cells;
  std::size_t at = 0;
  const auto place_at = [&](std::size_t byte) {
    return FilePosition{line_number, 1 + static_cast<int>(length_in_characters(line.substr(0, byte)))};
  };
  while (true) {
    while (at < line.size() && (line[at] == ' ' || line[at] == '\t')) ++at;
    Cell cell{"", place_at(at)};
    if (at < line.size() && line[at] == '"') {
      bool closed = false;
      for (++at; at < line.size(); ++at) {
        if (line[at] != '"') {
          cell.text += line[at];
        } else if (at + 1 < line.size() && line[at + 1] == '"') {
          cell.text += '"';
          ++at;
        } else {
          closed = true;
          ++at;
          break;
        }
      }
      const std::size_t comma = std::min(line.find(',', at), line.size());
      if (!closed || !trimmed(line.substr(at, comma - at)).empty()) {
        problems.add(cell.in_file, closed ? "text after a closing quote" : "a quote is not closed",
                     "put the whole cell in double quotes, and write \"\" for a quote in it");
        return std::nullopt;
      }
      at = comma;
    } else {
      const std::size_t comma = std::min(line.find(',', at), line.size());
      cell.text = trimmed(line.substr(at, comma - at));
      at = comma;
    }
    cells.push_back(std::move(cell));
    if (at >= line.size()) return cells;
    ++at;
  }
}

class PointsReader {
 public:
  PointsReader(const std::string& file_name, std::size_t most) : problems_(file_name), max_(most) {}

  void line(std::string_view text, int number) {
    const std::string_view content = trimmed(text);
    if (content.empty() || content.front() == '#' || stopped_) return;
    if (text.size() > 65536) {
      problems_.add({number, 1}, "a line of more than 65536 bytes", "write one point a line");
      return;
    }
    const auto cells = split(text, number, problems_);
    if (!has_header_) {
      has_header_ = true;
      if (!cells || !header(*cells)) stopped_ = true;
    } else if (cells) {
      row(*cells, number);
    }
  }

  PointsTable take() {
    if (!has_header_) {
      problems_.add({1, 1}, "no header line", "begin with: name,x_m,y_m,z_m,nx,ny,nz,goal_lx,weight,max_lx");
    }
    return {std::move(rows_), {}, problems_.take()};
  }

 private:
  bool header(const std::vector<Cell>& cells) {
    bool good = true;
    const auto refuse = [&](const FilePosition& in_file, std::string what, std::string mend) {
      problems_.add(in_file, std::move(what), std::move(mend));
      good = false;
    };
    for (const Cell& cell : cells) {
      const auto at = std::find(kColumnNames.begin(), kColumnNames.end(), cell.text);
      if (at == kColumnNames.end()) {
        refuse(cell.in_file, fmt::format("unknown column {}", in_quotes(cell.text)),
               mend_for_unknown(cell.text, kColumnNames, "remove it"));
        columns_.push_back(kColumns);
        continue;
      }
      const auto column = static_cast<Column>(at - kColumnNames.begin());
      if (std::find(columns_.begin(), columns_.end(), column) != columns_.end()) {
        refuse(cell.in_file, fmt::format("column {} stands there twice", cell.text), "remove one of them");
      }
      columns_.push_back(column);
    }
    const auto has = [&](Column column) {
      return std::find(columns_.begin(), columns_.end(), column) != columns_.end();
    };
    for (const Column column : {kName, kX, kY, kZ}) {
      if (!has(column)) {
        refuse(cells.front().in_file, fmt::format("no column {}", kColumnNames[column]), "add it to the header line");
      }
    }
    if ((has(kNx) || has(kNy) || has(kNz)) && !(has(kNx) && has(kNy) && has(kNz))) {
      refuse(cells.front().in_file, "a normal needs the columns nx, ny and nz", "add those that are missing");
    }
    if (has(kGoalX) != has(kGoalY)) {
      refuse(cells.front().in_file, "a chromaticity needs the columns goal_x and goal_y",
             "add the one that is missing");
    }
    return good;
  }

  void row(const std::vector<Cell>& cells, int number) {
    if (rows_.size() >= max_) {
      problems_.add({number, 1}, "more than 100000 points", "leave some out");
      stopped_ = true;
      return;
    }
    if (cells.size() != columns_.size()) {
      problems_.add(cells.front().in_file,
                    fmt::format("{} cells, but the header has {} columns", cells.size(), columns_.size()),
                    "give every line as many cells as the header");
      return;
    }
    PointsTable::Row out;
    std::array<std::optional<double>, kColumns> values;
    FilePosition normal_place;
    bool good = true;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const Column column = columns_[i];
      if (column == kName) {
        good &= read_name(cells[i], out);
      } else {
        good &= read_number(cells[i], column, values[column]);
        if (column == kNx) normal_place = cells[i].in_file;
      }
    }
    if (!good) return;
    Point& p = out.point;
    p.position_world_m = {*values[kX], *values[kY], *values[kZ]};
    if (values[kNx] || values[kNy] || values[kNz]) {
      const Vec3 normal(values[kNx].value_or(0), values[kNy].value_or(0), values[kNz].value_or(0));
      if (normal.stableNorm() < 1e-9) {
        problems_.add(normal_place, "the normal has no length", "give the direction the lit side faces: 0,0,1 for up");
        return;
      }
      p.normal_world = normal.stableNormalized();
    }
    p.goal_lx = values[kGoal];
    if (!read_colour(cells, values, out)) return;
    p.weight = values[kWeightColumn].value_or(p.weight);
    p.max_lx = values[kMax];
    p.goal_tolerance = values[kTolerance];
    rows_.push_back(std::move(out));
  }

  bool read_colour(const std::vector<Cell>& cells, const std::array<std::optional<double>, kColumns>& values,
                   PointsTable::Row& out) {
    const auto &x = values[kGoalX], &y = values[kGoalY], &cct_k = values[kGoalCct];
    if (!x && !y && !cct_k) return true;
    const auto refuse = [&](Column at, std::string what, std::string mend) {
      const auto column = std::find(columns_.begin(), columns_.end(), at) - columns_.begin();
      problems_.add(cells[static_cast<std::size_t>(column)].in_file, std::move(what), std::move(mend));
      return false;
    };
    if (x.has_value() != y.has_value())
      return refuse(x ? kGoalY : kGoalX, "half a chromaticity", "give goal_x and goal_y, or neither");
    if (x && cct_k)
      return refuse(kGoalCct, "goal_x and goal_cct_k both say what colour the goal has", "leave one of the two empty");
    if (!values[kGoal])
      return refuse(x ? kGoalX : kGoalCct, "the colour of a goal without goal_lx", "add goal_lx, or leave it empty");
    if (x && *x + *y > 1)
      return refuse(kGoalX, fmt::format("goal_x {:g} and goal_y {:g} add up to {:g}", *x, *y, *x + *y),
                    "x and y of a chromaticity (CIE 1931) add up to 1 at most");
    if (x) out.goal_xy = Chromaticity(*x, *y);
    if (cct_k) out.point.goal_rgb = rgb_of_cct(*cct_k);
    return true;
  }

  bool read_name(const Cell& cell, PointsTable::Row& out) {
    const std::size_t length = length_in_characters(cell.text);
    if (length == 0 || length > kLongestName || !is_plain_text(cell.text)) {
      problems_.add(cell.in_file,
                    length == 0             ? "a point without a name"
                    : length > kLongestName ? fmt::format("a name of {} characters", length)
                                            : fmt::format("name {} is not plain text", in_quotes(cell.text)),
                    fmt::format("name it with 1 to {} printable characters in UTF-8", kLongestName));
      return false;
    }
    out.point.name = cell.text;
    out.in_file = cell.in_file;
    return true;
  }

  bool read_number(const Cell& cell, Column column, std::optional<double>& out) {
    const std::string_view title = kColumnNames[column];
    const bool required = column == kX || column == kY || column == kZ;
    if (cell.text.empty() && !required) return true;
    double x = 0;
    const char* end = cell.text.data() + cell.text.size();
    const auto [stop, error] = std::from_chars(cell.text.data(), end, x);
    if (cell.text.empty() || error != std::errc{} || stop != end || !std::isfinite(x)) {
      problems_.add(cell.in_file, fmt::format("{} is {}, not a finite number", title, in_quotes(cell.text)),
                    "write a number with a decimal point, as 1.25");
      return false;
    }
    const auto point_keys = keys_of("point");
    const auto spec =
        std::find_if(point_keys.begin(), point_keys.end(), [&](const KeySpec& k) { return k.key == kKeys[column]; });
    if (!spec->bounds.contain(x)) {
      problems_.add(cell.in_file, fmt::format("{} is {}, which is out of range", title, x),
                    fmt::format("allowed: {}", range_text(*spec)));
      return false;
    }
    out = x;
    return true;
  }

  ProblemList problems_;
  std::size_t max_;
  std::vector<Column> columns_;
  std::vector<PointsTable::Row> rows_;
  bool has_header_ = false, stopped_ = false;
};

}  // namespace

PointsTable parse_points_csv(std::string_view text, const std::string& file_name, std::size_t most) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  PointsReader reader(file_name, most);
  std::string made_for;
  if (text.starts_with(kMadeFor))
    made_for = trimmed(text.substr(kMadeFor.size(), text.find_first_of("\r\n") - kMadeFor.size()));
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    reader.line(line, number);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  PointsTable table = reader.take();
  table.made_for = std::move(made_for);
  return table;
}

namespace {

/// none = it cannot be read, or is too long.
std::optional<std::string> text_of(const std::filesystem::path& path, std::string& why) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  why = "the file cannot be read";
  if (!error && size > kMaxBytes) {
    why = "the file is over 64 MiB";
    return std::nullopt;
  }
  std::ifstream in(path, std::ios::binary);
  if (error || !in) return std::nullopt;
  std::string text(size, '\0');
  in.read(text.data(), static_cast<std::streamsize>(size));
  if (in.bad()) return std::nullopt;
  text.resize(static_cast<std::size_t>(in.gcount()));
  return text;
}

/// A cell as PointsReader reads it.
std::string cell_of(const std::string& text) {
  if (text.find_first_of(",\"") == std::string::npos && trimmed(text) == text && !text.starts_with('#')) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

}  // namespace

PointsTable load_points_csv(const std::filesystem::path& path, std::size_t most) {
  std::string why;
  const auto text = text_of(path, why);
  if (!text) return {{}, {}, {{path.string(), 0, 0, why, "leave some points out, or check who may read it"}}};
  return parse_points_csv(*text, path.string(), most);
}

std::string painted_version(const SurfaceGoalSpec& goal) {
  std::string why;
  const auto strokes = text_of(goal.strokes_file, why);
  return strokes ? painted_version(goal, *strokes) : "";
}

std::string painted_version(const SurfaceGoalSpec& goal, std::string_view strokes) {
  Fingerprint fingerprint;
  fingerprint.add(strokes);
  fingerprint.add(goal.name);
  fingerprint.add(goal.max_lx);
  for (const double value : {goal.weight, goal.patch_m, goal.min_spacing_m, goal.max_spacing_m}) fingerprint.add(value);
  if (goal.goal_tolerance) fingerprint.add(*goal.goal_tolerance);
  return fmt::format("{:016x}", fingerprint.value());
}

std::filesystem::path next_points_file(const SurfaceGoalSpec& goal) { return goal.points_file().string() + ".next"; }

std::string points_csv(std::span<const Point> points, const std::string& made_for) {
  std::string csv =
      fmt::format("{}{}\nname,x_m,y_m,z_m,nx,ny,nz,goal_lx,weight,max_lx,goal_tolerance\n", kMadeFor, made_for);
  const auto optional = [](const std::optional<double>& value) { return value ? fmt::format("{}", *value) : ""; };
  for (const Point& point : points) {
    csv += cell_of(point.name);
    for (const Vec3& vector : {point.position_world_m, point.normal_world})
      for (const double value : vector) csv += fmt::format(",{}", value);
    csv += fmt::format(",{},{},{},{}\n", optional(point.goal_lx), point.weight, optional(point.max_lx),
                       optional(point.goal_tolerance));
  }
  return csv;
}

}  // namespace luxrig
