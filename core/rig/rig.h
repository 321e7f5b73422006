#pragma once
/// A rig as plain values: the checked content of rig.toml (read by rig_file.h). Lists keep the order of the file; all
/// other code refers to their entries by index.

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "core/rig/brief.h"
#include "core/rig/equipment.h"
#include "core/rig/patch.h"
#include "core/rig/scene_spec.h"

namespace luxrig {

struct Rig {
  std::filesystem::path file;  ///< as opened; for problems, and for paths relative to it
  std::string name;
  std::string calibrated;           ///< when the calibration that is applied over the file was made; empty = none is
  double calibrated_hours_ago = 0;  ///< from then until the rig was opened
  std::string calibrated_on;        ///< the simulated rig that it was measured on; empty = the real one
  std::vector<KnownLight> known_lights;  ///< by that calibration; in place of what is traced
  std::uint64_t known_lights_of = 0;     ///< RigVersion::light of the rig that they are of, without them
  SceneSpec scene;
  std::vector<Luminaire> luminaires;
  std::vector<Bus> buses;
  std::vector<Fixture> fixtures;
  std::vector<Luxmeter> luxmeters;
  std::vector<PictureCamera> cameras;
  std::optional<Daylight> daylight;
  std::vector<Point> points;
  std::vector<SurfaceGoalSpec> surface_goals;  ///< their points are among `points`
  std::vector<Task> tasks;
  MountingSpec mounting;
  std::vector<KeepOut> keep_outs;
  Limits limits;
  ControlSpec control;
  SafeSpec safe;
  StartupSpec startup;
  DaemonSpec daemon;
  std::vector<Problem> notes;  ///< legal, but worth a look (a goal above its limit, an odd IES file)

  /// Goals state a colour. In that case, every point with a goal that counts has one.
  [[nodiscard]] bool colour_goals() const {
    return std::any_of(points.begin(), points.end(), [](const Point& p) { return p.goal_lx && p.goal_rgb; });
  }
  /// |true - goal| / goal at which the goal of a point still counts as met.
  [[nodiscard]] double goal_tolerance(std::size_t point) const {
    return points[point].goal_tolerance.value_or(control.goal_tolerance);
  }
  /// Smallest and largest of all goals; the rig's own if there are none.
  [[nodiscard]] std::pair<double, double> goal_tolerances() const {
    std::optional<std::pair<double, double>> span;
    for (std::size_t p = 0; p < points.size(); ++p) {
      const double one = goal_tolerance(p);
      if (points[p].goal_lx)
        span = span ? std::pair(std::min(span->first, one), std::max(span->second, one)) : std::pair(one, one);
    }
    return span.value_or(std::pair(control.goal_tolerance, control.goal_tolerance));
  }
  /// Highest allowed level of a fixture: the lower of its own limit and the rig's.
  [[nodiscard]] double max_level(const Fixture& fixture) const { return std::min(fixture.max_level, limits.max_level); }
  /// The parts of a luminaire that are set one by one: its emitters, or the luminaire itself.
  [[nodiscard]] std::vector<std::size_t> emitters_or_itself(std::size_t luminaire) const {
    const std::vector<std::size_t>& emitters = luminaires[luminaire].emitters;
    return emitters.empty() ? std::vector<std::size_t>{luminaire} : emitters;
  }
};

}  // namespace luxrig
