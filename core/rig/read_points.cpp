#include <fmt/format.h>

#include "core/rig/points_csv.h"
#include "core/rig/rig_reader.h"

namespace luxrig {

void RigReader::read_points_file(Section& s) {
  const auto path = read_file(s, "file");
  if (!path) return;
  const Place place = s.place_of("file");
  const std::size_t room = section_spec("point").most - std::min(rig.points.size(), section_spec("point").most);
  PointsTable table = load_points_csv(*path, room);
  for (Problem& problem : table.problems) problems.add(std::move(problem));
  for (PointsTable::Row& row : table.rows) {
    row.point.place = place;
    if (const auto taken = points.find(row.point.name)) {
      problems.add({path->string(), row.place.line, row.place.column,
                    fmt::format("a second point is called {}", in_quotes(row.point.name)),
                    "give each point its own name"});
    } else {
      points.add(row.point.name, rig.points.size(), place, problems);
    }
    rig.points.push_back(std::move(row.point));
  }
}

void RigReader::read_points() {
  each(root, "point", [&](Section& s) {
    Point point;
    point.place = s.place();
    point.position_world_m.setConstant(std::numeric_limits<double>::quiet_NaN());  // until it is known
    if (s.read("name", point.name)) points.add(point.name, rig.points.size(), s.place_of("name"), problems);
    s.read("position_m", point.position_world_m);
    s.read_normal("normal", point.normal_world);
    s.read("goal_lx", point.goal_lx);
    s.read("weight", point.weight);
    s.read("max_lx", point.max_lx);
    rig.points.push_back(std::move(point));
  });
  each(root, "points", [&](Section& s) { read_points_file(s); });
  for (const Point& point : rig.points) {
    // Legal, since the limit wins; but seldom what was meant.
    if (point.goal_lx && point.max_lx && *point.goal_lx > *point.max_lx) {
      rig.notes.push_back({problems.file(), point.place.line, point.place.column,
                           fmt::format("point {} has a goal of {} lx above its max_lx of {} lx", in_quotes(point.name),
                                       *point.goal_lx, *point.max_lx),
                           "the limit wins; lower the goal if that is not meant"});
    }
  }
}

}  // namespace luxrig
