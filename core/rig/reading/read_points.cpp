#include <fmt/format.h>

#include "core/rig/points_csv.h"
#include "core/rig/reading/rig_reader.h"

namespace luxrig {
namespace {

std::size_t room_for_points(const Rig& rig) {
  const std::size_t most = section_spec("point").most;
  return most - std::min(rig.points.size(), most);
}

}  // namespace

void RigReader::read_points_file(Section& s) {
  const auto path = read_file(s, "file");
  if (!path) return;
  add_points(load_points_csv(*path, room_for_points(rig)), *path, s.place_of("file"));
}

void RigReader::read_surface_goal(Section& s) {
  SurfaceGoalSpec goal;
  goal.in_file = s.in_file();
  if (s.read("name", goal.name)) surface_goals.add(goal.name, rig.surface_goals.size(), s.place_of("name"), problems);
  std::string strokes;
  s.read("strokes", strokes);
  goal.strokes_file = folder / strokes;
  s.read("max_lx", goal.max_lx);
  s.read("weight", goal.weight);
  goal.goal_rgb = read_goal_colour(s, fmt::format("the light of surface goal {},", in_quotes(goal.name)));
  s.read("uniformity", goal.uniformity);
  s.read("goal_tolerance", goal.goal_tolerance);
  s.read("patch_m", goal.patch_m);
  s.read("min_spacing_m", goal.min_spacing_m);
  s.read("max_spacing_m", goal.max_spacing_m);
  if (goal.min_spacing_m > goal.max_spacing_m)
    problems.add(s.place_of(s.has("min_spacing_m") ? "min_spacing_m" : "max_spacing_m"),
                 fmt::format("min_spacing_m {} is above max_spacing_m {}", goal.min_spacing_m, goal.max_spacing_m),
                 "make it the smaller of the two");
  const FilePosition in_file = s.place_of("strokes");
  if (goal.points_file() == goal.strokes_file)
    return problems.add(in_file, fmt::format("{} would be the file of its points, too", in_quotes(strokes)),
                        "end its name in .json");
  const auto same_file = [&](const SurfaceGoalSpec& other) { return other.strokes_file == goal.strokes_file; };
  if (!strokes.empty() && std::any_of(rig.surface_goals.begin(), rig.surface_goals.end(), same_file))
    return problems.add(in_file, fmt::format("another surface goal has the strokes {}", in_quotes(strokes)),
                        "give each its own file");
  rig.surface_goals.push_back(goal);
  if (strokes.empty() || painted == PaintedPoints::left_out) return;
  const auto lay_out = [&](std::string what) {
    problems.add(in_file, std::move(what), fmt::format("lay out its points: luxrig paint {}", rig.file.string()));
  };
  const std::string version = painted_version(goal);
  bool any = false;
  for (const auto& points_file : {goal.points_file(), next_points_file(goal)}) {
    std::error_code error;
    if (!std::filesystem::exists(points_file, error)) continue;
    any = true;
    auto table = load_points_csv(points_file, room_for_points(rig));
    if (table.made_for == version)
      return add_points(std::move(table), points_file, in_file, rig.surface_goals.size() - 1);
  }
  lay_out(any ? fmt::format("the points of surface goal {} are of other strokes or settings", in_quotes(goal.name))
              : fmt::format("surface goal {} has no points yet", in_quotes(goal.name)));
}

void RigReader::add_points(PointsTable table, const std::filesystem::path& path, const FilePosition& in_file,
                           std::optional<std::size_t> surface_goal) {
  for (Problem& problem : table.problems) problems.add(std::move(problem));
  for (PointsTable::Row& row : table.rows) {
    row.point.in_file = in_file;
    if (const auto taken = points.find(row.point.name)) {
      problems.add({path.string(), row.in_file.line, row.in_file.column,
                    fmt::format("a second point is called {}", in_quotes(row.point.name)),
                    "give each point its own name"});
    } else {
      points.add(row.point.name, rig.points.size(), in_file, problems);
    }
    if (row.goal_xy)
      row.point.goal_rgb = goal_colour(*row.goal_xy, path.string(), row.in_file,
                                       fmt::format("the goal of point {},", in_quotes(row.point.name)));
    row.point.surface_goal = surface_goal;
    if (surface_goal && row.point.goal_lx) row.point.goal_rgb = rig.surface_goals[*surface_goal].goal_rgb;
    rig.points.push_back(std::move(row.point));
    point_places.emplace_back(path.string(), row.in_file);
  }
}

Vec3 RigReader::goal_colour(const Chromaticity& xy, const std::string& file, const FilePosition& in_file,
                            const std::string& whose) {
  const ColourWithin709 colour = within_rec709(rgb_of_xy(xy));
  if (colour.moved) note_colour_moved(file, in_file, whose, xy, colour.rgb);
  return colour.rgb;
}

std::optional<Vec3> RigReader::read_goal_colour(Section& s, const std::string& whose) {
  Chromaticity xy;
  double cct_k = 0;
  const bool by_xy = s.read("goal_xy", xy), by_cct = s.read("goal_cct_k", cct_k);
  if (by_xy && by_cct) {
    problems.add(s.place_of("goal_cct_k"), "goal_xy and goal_cct_k both say what colour the goal has",
                 "remove one of the two");
    return std::nullopt;
  }
  if (by_xy) return goal_colour(xy, problems.file(), s.place_of("goal_xy"), whose);
  return by_cct ? std::optional(rgb_of_cct(cct_k)) : std::nullopt;
}

void RigReader::read_goal(Section& s, Point& point) {
  s.read("goal_lx", point.goal_lx);
  point.goal_rgb = read_goal_colour(s, fmt::format("the goal of point {},", in_quotes(point.name)));
  if (s.has("goal_lx")) return;
  for (const char* key : {"goal_xy", "goal_cct_k"})
    s.refuse(key, fmt::format("{} has no effect without goal_lx", key), "add goal_lx, or remove it");
}

/// If some goals have a colour, all must: a goal without one would weigh as a goal of white light.
void RigReader::check_goal_colours() {
  const auto counts = [](const Point& point) { return point.goal_lx && point.weight > 0; };
  const Point* coloured = nullptr;
  std::size_t first = rig.points.size(), grey = 0;
  for (std::size_t i = 0; i < rig.points.size(); ++i) {
    const Point& point = rig.points[i];
    if (!counts(point)) continue;
    if (point.goal_rgb) {
      if (!coloured) coloured = &point;
    } else {
      if (grey++ == 0) first = i;
    }
  }
  if (!coloured || grey == 0) return;
  const auto& [file, in_file] = point_places[first];
  problems.add({file, in_file.line, in_file.column,
                fmt::format("the goal of point {} has no colour{}, but that of point {} has one",
                            in_quotes(rig.points[first].name), grey > 1 ? fmt::format(" (as {} more)", grey - 1) : "",
                            in_quotes(coloured->name)),
                "give every goal a goal_xy or goal_cct_k (daylight white: goal_cct_k = 6500), or none"});
}

void RigReader::read_points() {
  each(root, "point", [&](Section& s) {
    Point point;
    point.in_file = s.in_file();
    point.position_world_m.setConstant(std::numeric_limits<double>::quiet_NaN());  // until known
    if (s.read("name", point.name)) points.add(point.name, rig.points.size(), s.place_of("name"), problems);
    s.read("position_m", point.position_world_m);
    s.read_normal("normal", point.normal_world);
    read_goal(s, point);
    s.read("weight", point.weight);
    s.read("max_lx", point.max_lx);
    s.read("goal_tolerance", point.goal_tolerance);
    rig.points.push_back(std::move(point));
    point_places.emplace_back(problems.file(), s.in_file());
  });
  each(root, "points", [&](Section& s) { read_points_file(s); });
  each(root, "surface_goal", [&](Section& s) { read_surface_goal(s); });
  check_goal_colours();
  for (const Point& point : rig.points) {
    // Legal, since the limit wins, but seldom intended.
    if (point.goal_lx && point.max_lx && *point.goal_lx > *point.max_lx) {
      rig.notes.push_back({problems.file(), point.in_file.line, point.in_file.column,
                           fmt::format("point {} has a goal of {} lx above its max_lx of {} lx", in_quotes(point.name),
                                       *point.goal_lx, *point.max_lx),
                           "the limit wins; lower the goal if that is not meant"});
    }
  }
}

}  // namespace luxrig
