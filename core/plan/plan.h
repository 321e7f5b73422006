#pragma once
/// Results of a solve, as a file (JSON) that a person can read, diff, version and apply later.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/photometry/light_colour.h"
#include "core/plan/look.h"
#include "core/plan/verdict.h"
#include "core/result.h"
#include "core/rig/rig.h"

namespace luxrig {

struct PlannedLight {
  std::string name;  ///< of the fixture, or the name it should get
  std::string luminaire;
  Vec3 position_world_m = Vec3::Zero();
  std::optional<Vec3> aim_world_m;
  std::optional<Joints> joints{};  ///< beam_rad: as set by its zoom; 0 without one
  double level = 0;                ///< emittance factor 0…1
  /// Level written by the solver. If `level` differs, a person changed it, and it is held. None = unknown.
  std::optional<double> solved_level{};
  double lumens = 0;              ///< level × rated flux
  std::optional<double> watts{};  ///< level × rated power; none = unknown
};

/// The best with another number of lights. The error is normalised and weighted, with no light above its highest level.
/// Kind "highlight" has the contrast instead, with each light at full level; the error is then NaN.
struct PlannedNumber {
  int lights = 0;
  double normalised_error = 0;
  std::optional<double> local_contrast_lx{};
  std::optional<double> relative_contrast{};  ///< kind "directions" has this
};

/// Error that the lights would leave within a power limit.
struct PlannedPower {
  double max_watts = 0, watts = 0;
  double normalised_error = 0;
};

/// Effect of the lights on an object's relief (core/highlight).
struct PlannedRelief {
  double local_contrast_lx = 0;  ///< largest difference in illuminance to a neighbour, mean over its recessed places
  double coverage = 0;           ///< share of its features where a light draws a shadow edge
  double relative_contrast = 0;  ///< the same as the difference over the sum; 0…1
  double object_lux = 0;         ///< at its brightest place
  std::optional<double> before_local_contrast_lx{}, before_coverage{},
      before_relative_contrast{};  ///< kind "aim": values of the look before
  std::optional<double> key_to_fill{};
  std::optional<double> seen{}, before_seen{};         ///< SeenScore::objective, if that was the task's
  std::optional<double> lit_share{}, clipped_share{};  ///< of what is seen: lit; burnt or crushed
};

/// Where a lamp that a person carries should be held.
struct PlannedDirection {
  Vec3 towards_world = Vec3::UnitZ();    ///< unit, from the object to the lamp
  double azimuth_rad = 0;                ///< from +x, counter-clockwise as seen from above
  double elevation_rad = 0;              ///< above the horizontal
  Vec3 position_world_m = Vec3::Zero();  ///< at the task's distance
};

struct PlannedTask {
  std::string name, kind;
  double normalised_error = 0;
  int iterations = 0;
  double seconds = 0;
  std::vector<PlannedLight> lights;  ///< fixtures; of a task that places lights: lights that may not hang yet
  /// Kinds that place lights: the rig's fixtures during the search.
  std::vector<PlannedLight> fixtures{};
  /// Kinds that place lights: the best with other numbers of lights, for a person to choose from.
  std::vector<PlannedNumber> numbers{};
  /// kind "placement": lower bounds of the error, proven in the search's own model of light, for the places it tried.
  /// The first holds for any number of lights, the second for up to this task's number.
  std::optional<double> lower_bound{}, lower_bound_of_number{};
  bool switches_proven = true;            ///< false = other settings of on-or-off lamps could be better
  std::optional<double> watts{};          ///< of its lights together; none if one is unknown
  std::vector<PlannedPower> front{};      ///< kind "placement": error at lower power limits
  std::optional<PlannedRelief> relief{};  ///< kinds "aim", "highlight" and "directions"; their normalised_error is 0
  std::vector<PlannedDirection> directions{};  ///< kind "directions": its relief is by beams of 1 lx from there
};

struct PlannedPoint {
  std::string name;
  Vec3 position_world_m = Vec3::Zero();
  Vec3 normal_world = Vec3::UnitZ();
  double lux = 0, direct_lux = 0, standard_error_lux = 0;
  std::optional<double> goal_lux;               ///< goal of corrections while the plan is in force
  std::string why;                              ///< why it misses its goal; empty if it does not
  std::optional<Verdict> verdict{};             ///< by the model, if the rig is as its file states; none without a goal
  std::string reason{};                         ///< for that verdict; empty if met
  std::optional<double> daylight_lux{};         ///< share of `lux` from daylight, in lux; none in a rig without
  std::optional<Chromaticity> xy{}, goal_xy{};  ///< in a rig whose goals have colours
  std::optional<double> weight{}, max_lux{};    ///< as used in the solve; weight: of a goal
  std::optional<double> goal_tolerance{};       ///< its own; none = the rig's
  /// Light that the show allows there until a luxmeter confirms the limits, if less than `lux`.
  std::optional<double> opening_lux{};
};

struct PlannedLimit {
  std::string point;
  double max_lux = 0, lux = 0;
  bool met = false;
};

/// Fingerprints of the rig that a plan was made for, to notice a changed rig file.
struct RigVersion {
  std::uint64_t goals = 0;   ///< goals in lux and colour, and their weights
  std::uint64_t limits = 0;  ///< of lux, levels and power
  std::uint64_t light = 0;   ///< scene, photometry, positions of fixtures, points and luxmeters
  bool operator==(const RigVersion&) const = default;
};

/// Differences between two versions, in words ("goals, limits"); empty = none.
[[nodiscard]] std::string what_differs(const RigVersion& one, const RigVersion& other);

struct Plan {
  std::string rig;                       ///< name of its rig
  std::optional<RigVersion> made_for{};  ///< none = unknown
  std::uint64_t seed = 0;
  double seconds = 0;
  std::vector<PlannedTask> tasks;  ///< for each fixture, the last task that names it counts
  std::vector<PlannedPoint> points;
  std::vector<PlannedLimit> limits;
};

/// Gives each point with a goal its verdict (core/plan/verdict.h): for the light of the plan, if the rig is exactly as
/// its file states, known to the standard error of the transport. A goal with a colour is also missed if its light is
/// further than 0.02 from it in CIE 1976 u'v'. goal_tolerance: of points without their own.
void judge(Plan& plan, double goal_tolerance);
[[nodiscard]] VerdictCounts goals_of(const Plan& plan);
/// By the model, no goal is missed (some may be unknown) and every limit is kept.
[[nodiscard]] bool nothing_missed(const Plan& plan);

/// Whether the last task to set fixtures was an aim. Then the light predicted by the plan is held, and the rig's goals
/// are set aside.
[[nodiscard]] bool holds_a_look(const Plan& plan);

/// The plan as a look of an existing rig, in the rig's order. A fixture that does not move, or has no joints in the
/// plan, keeps the rig's. A point's goal is the plan's, or the predicted light if that is to be held; its limit is the
/// lower of the rig's and the plan's. Problems if the plan:
/// - is for another rig
/// - names an unknown fixture, or a placed light that is not hung yet (then the mend says where and how)
/// - leaves out a fixture
/// - has a level outside 0…max_level or an angle outside a head's range
[[nodiscard]] Checked<Look> look_for(const Plan& plan, const Rig& rig, const std::string& file_name);

/// A plan whose placed lights hang, for light in the model.
struct HungPlan {
  Rig rig;  ///< each placed light that is not a fixture of the rig is a further fixture (hung_light), after its own
  Look look;
};
[[nodiscard]] Checked<HungPlan> hang_plan(const Plan& plan, const Rig& rig, const std::string& file_name);

/// A fixture without a bus (`bus` is past the last one), never for output: a luminaire at a position, pointing straight
/// down or at an aim. requires luminaire < the rig's.
[[nodiscard]] Fixture hung_light(const Rig& rig, const std::string& name, std::size_t luminaire,
                                 const Vec3& position_world_m, const std::optional<Vec3>& aim_world_m);

/// JSON, as `luxrig solve --json` prints it. Among its keys:
///   top level  "luxrig_plan": 1, "rig", "made_for": {"goals", "limits", "light"} (fingerprints of the rig, in hex)
///   a light    "solved_level", "watts", "beam_angle_deg" if it zooms
///   a point    "weight", "max_lux", "goal_tolerance" if it has its own, "why" if there is one, "xy" and "goal_xy" if
///              goals have a colour
///   a task     "watts", "switches_proven" if false
///   placement  "fixtures" (like "lights"), "numbers": [{"lights", "normalised_error", "local_contrast"}],
///              "lower_bound", "lower_bound_of_number", "front": [{"max_watts", "watts", "normalised_error"}]
///   relief     "local_contrast", "relative_contrast", "coverage", the same with "before_", "object_lux", "key_to_fill";
///              "seen", "before_seen", "lit_share", "clipped_share" if that was the objective
///   directions "directions": [{"direction", "azimuth_deg", "elevation_deg", "position"}], "numbers" with
///              "relative_contrast"
/// Numbers are finite, or the key is absent.
[[nodiscard]] std::string to_json(const Plan& plan);
/// Never throws. Problems of syntax have line and column; others have a path (/tasks/0/lights/3/level) in `what`.
/// Required: luxrig_plan, rig, tasks, and the name and level of each light. Any other absent number becomes NaN (a
/// whole number 0). Unknown keys are ignored, since later versions add some.
[[nodiscard]] Checked<Plan> plan_from_json(const std::string& text, const std::string& file_name);

}  // namespace luxrig
