#pragma once
/// What a solve decided, as a file (JSON) that a person can read, diff, version and apply later.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "core/rig/rig.h"

namespace luxrig {

struct PlannedLight {
  std::string name;  ///< fixture
  std::string luminaire;
  Vec3 position_world_m = Vec3::Zero();
  std::optional<Vec3> aim_world_m;
  std::optional<double> pan_deg, tilt_deg;
  double level = 0;   ///< emittance factor 0…1
  double lumens = 0;  ///< level × rated flux
};

struct PlannedTask {
  std::string name, kind;
  double normalised_error = 0;
  int iterations = 0;
  double seconds = 0;
  std::vector<PlannedLight> lights;
};

struct PlannedPoint {
  std::string name;
  Vec3 position_world_m = Vec3::Zero();
  Vec3 normal_world = Vec3::UnitZ();
  double lux = 0, direct_lux = 0, standard_error_lux = 0;
  std::optional<double> goal_lux;
  std::string why;                       ///< empty when met; else what binds
  std::optional<double> daylight_lux{};  ///< what of lux is daylight; none in a rig without
};

struct PlannedLimit {
  std::string point;
  double max_lux = 0, lux = 0;
  bool met = false;
};

struct Plan {
  std::string rig;  ///< name of the rig it is for
  std::uint64_t seed = 0;
  double seconds = 0;
  std::vector<PlannedTask> tasks;  ///< the light list of the last task that names a fixture counts
  std::vector<PlannedPoint> points;
  std::vector<PlannedLimit> limits;
};

/// Level of every fixture of the rig, in the rig's order; problems when the plan is for another rig, names an unknown
/// fixture, leaves one out, or has a level outside 0…max_level.
[[nodiscard]] Checked<std::vector<double>> levels_for(const Plan& plan, const Rig& rig, const std::string& file_name);

/// JSON, keys as in design.md `solve --json`, plus "luxrig_plan": 1 and "rig" (and a point's "why" when there is one).
/// Numbers are finite or the key is absent.
[[nodiscard]] std::string to_json(const Plan& plan);
/// Never throws. Problems of syntax carry line and column, others a path (/tasks/0/lights/3/level) in `what`. Needed
/// are luxrig_plan, rig, tasks, and the name and level of each light; another number that is absent becomes NaN (0 for
/// a whole number), and unknown keys are left alone, since later versions add some.
[[nodiscard]] Checked<Plan> plan_from_json(const std::string& text, const std::string& file_name);

}  // namespace luxrig
