#pragma once
/// What a solve decided, as a file (JSON) that a person can read, diff, version and apply later.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/photometry/light_colour.h"
#include "core/plan/verdict.h"
#include "core/result.h"
#include "core/rig/rig.h"

namespace luxrig {

struct PlannedLight {
  std::string name;  ///< fixture, or what it is to be called
  std::string luminaire;
  Vec3 position_world_m = Vec3::Zero();
  std::optional<Vec3> aim_world_m;
  std::optional<double> pan_deg, tilt_deg;
  std::optional<double> beam_angle_deg;  ///< that its zoom makes
  double level = 0;                      ///< emittance factor 0…1
  /// What the solver wrote as level: one that differs is a person's, and is held as such. None: nobody knows.
  std::optional<double> solved_level{};
  double lumens = 0;              ///< level × rated flux
  std::optional<double> watts{};  ///< level × rated power; none when that is not known
};

/// So many lights would leave so much of the error (normalised, weighted, none above its highest level); or, kind
/// "highlight", give so much contrast, each at full level (then the error is NaN).
struct PlannedNumber {
  int lights = 0;
  double normalised_error = 0;
  std::optional<double> local_contrast_lx{};
};

/// Within so much power the lights would leave so much of the error.
struct PlannedPower {
  double max_watts = 0, watts = 0;
  double normalised_error = 0;
};

/// What lights do for an object's relief (core/highlight).
struct PlannedRelief {
  double local_contrast_lx = 0;  ///< largest difference in illuminance to a neighbour, mean over its recessed places
  double coverage = 0;           ///< share of its features where a light draws a shadow's edge
  double relative_contrast = 0;  ///< the difference over the sum, likewise; 0…1
  double object_lux = 0;         ///< at its brightest place
  std::optional<double> before_local_contrast_lx{}, before_coverage{},
      before_relative_contrast{};  ///< kind "aim": of the look that was there
  std::optional<double> key_to_fill{};
};

struct PlannedTask {
  std::string name, kind;
  double normalised_error = 0;
  int iterations = 0;
  double seconds = 0;
  std::vector<PlannedLight> lights;  ///< of an emittance task, fixtures; of a placement, lights that need not hang yet
  /// Kinds that place lights: what the rig's fixtures give meanwhile.
  std::vector<PlannedLight> fixtures{};
  /// Kinds that place lights: the best with other numbers of lights, so that a person can choose.
  std::vector<PlannedNumber> numbers{};
  /// kind "placement": proven by the search's own light: no number of lights at the places it tried comes closer, and
  /// none up to this task's number does.
  std::optional<double> lower_bound{}, lower_bound_of_number{};
  bool switches_proven = true;            ///< false: other settings of what is on or off could be better
  std::optional<double> watts{};          ///< of its lights together; none when one's is not known
  std::vector<PlannedPower> front{};      ///< kind "placement": what each watt less would cost
  std::optional<PlannedRelief> relief{};  ///< kind "aim" and "highlight"; their normalised_error is 0
};

struct PlannedPoint {
  std::string name;
  Vec3 position_world_m = Vec3::Zero();
  Vec3 normal_world = Vec3::UnitZ();
  double lux = 0, direct_lux = 0, standard_error_lux = 0;
  std::optional<double> goal_lux;               ///< what corrections aim at while the plan is in force
  std::string why;                              ///< what keeps it from its goal; empty when nothing does
  std::optional<Verdict> verdict{};             ///< by the model, were the rig as its file says; none without a goal
  std::string reason{};                         ///< of that verdict; empty when met
  std::optional<double> daylight_lux{};         ///< what of lux is daylight; none in a rig without
  std::optional<Chromaticity> xy{}, goal_xy{};  ///< in a rig whose goals have colours
  std::optional<double> weight{}, max_lux{};    ///< as solved for; weight: of a goal
  /// What the show lets out there while no luxmeter confirms the limits, where that is less than lux.
  std::optional<double> opening_lux{};
};

struct PlannedLimit {
  std::string point;
  double max_lux = 0, lux = 0;
  bool met = false;
};

/// Fingerprints of what a plan rests on, to notice that the rig file is another one by now.
struct RigVersion {
  std::uint64_t goals = 0;   ///< goals in lux and colour, and their weights
  std::uint64_t limits = 0;  ///< of lux, levels and power
  std::uint64_t light = 0;   ///< scene, photometry, where fixtures, points and luxmeters are
  bool operator==(const RigVersion&) const = default;
};

/// What differs between two versions, in words ("goals and limits"); empty: nothing.
[[nodiscard]] std::string what_differs(const RigVersion& one, const RigVersion& other);

struct Plan {
  std::string rig;                       ///< name of the rig it is for
  std::optional<RigVersion> made_for{};  ///< none: nobody knows
  std::uint64_t seed = 0;
  double seconds = 0;
  std::vector<PlannedTask> tasks;  ///< the light list of the last task that names a fixture counts
  std::vector<PlannedPoint> points;
  std::vector<PlannedLimit> limits;
};

/// Gives each point with a goal its verdict (core/plan/verdict.h): the light of the plan, were the rig exactly as
/// its file says, known to the standard error of the transport. A goal with a colour is missed, too, when its light is
/// further than 0.02 in CIE 1976 u'v' from it.
void judge(Plan& plan, double goal_tolerance);
[[nodiscard]] VerdictCounts goals_of(const Plan& plan);
/// No goal is missed (some may be unknown), and every limit is kept, both by the model.
[[nodiscard]] bool nothing_missed(const Plan& plan);

/// Whether the last task to set fixtures was an aim: then what the plan predicts is what shall be held, and goals of
/// the rig are set aside.
[[nodiscard]] bool holds_a_look(const Plan& plan);

/// What a plan wants of a rig that hangs.
struct PlannedLook {
  std::vector<double> levels;  ///< per fixture
  std::vector<Joints> joints;  ///< per fixture: of one that does not move, or that the plan gives none, the rig's
  /// Per point: the plan's, or what it predicts when that shall be held; none: it is not corrected towards anything.
  std::vector<std::optional<double>> goal_lx;
  /// Per point: the lower of the rig's and the plan's.
  std::vector<std::optional<double>> max_lx;
  std::vector<double> weight;  ///< per point: the plan's, else the rig's
  /// Per fixture: what was solved, where a person has written another level; none: the level is as it was solved.
  std::vector<std::optional<double>> solved_levels;
};

/// In the rig's order; problems when the plan is for another rig, names an unknown fixture (or a placed light that does
/// not hang yet: then the mend says where and how), leaves one out, or has a level outside 0…max_level or an angle
/// outside a head's range.
[[nodiscard]] Checked<PlannedLook> look_for(const Plan& plan, const Rig& rig, const std::string& file_name);

/// The rig with its heads turned so: joints, and no aim where they differ. One of each per fixture.
void turn_heads(Rig& rig, std::span<const Joints> joints);

/// The levels, with each placed light that is no fixture of the rig hung at its place first: `rig` gets a fixture more
/// for each, after its own. They have no bus (their `bus` is past the last one): for light in the model, never for
/// output. Heads look where the plan has them look.
[[nodiscard]] Checked<std::vector<double>> levels_when_hung(const Plan& plan, Rig& rig, const std::string& file_name);

/// A fixture without a bus: a luminaire at a place, straight down or looking at an aim. requires luminaire < the rig's.
[[nodiscard]] Fixture hung_light(const Rig& rig, const std::string& name, std::size_t luminaire,
                                 const Vec3& position_world_m, const std::optional<Vec3>& aim_world_m);

/// JSON, keys as in design.md `solve --json`, plus "luxrig_plan": 1, "rig", "made_for": {"goals", "limits", "light"}
/// (fingerprints of the rig, in hex), "solved_level" of a light, "weight" and "max_lux" of a point (and a point's "why"
/// when there is one, and a placement's "fixtures", like "lights", and "numbers": [{"lights", "normalised_error",
/// "local_contrast"}], "beam_angle_deg" of a light that zooms, "local_contrast", "relative_contrast", "coverage", the
/// same with "before_", "object_lux", "key_to_fill" of a task for an object's relief, "lower_bound" and
/// "lower_bound_of_number", "switches_proven" where false, "front":
/// [{"max_watts", "watts", "normalised_error"}], "watts" of lights and tasks, and with goals of a colour a point's "xy"
/// and "goal_xy"). Numbers are finite or the key is absent.
[[nodiscard]] std::string to_json(const Plan& plan);
/// Never throws. Problems of syntax carry line and column, others a path (/tasks/0/lights/3/level) in `what`. Needed
/// are luxrig_plan, rig, tasks, and the name and level of each light; another number that is absent becomes NaN (0 for
/// a whole number), and unknown keys are left alone, since later versions add some.
[[nodiscard]] Checked<Plan> plan_from_json(const std::string& text, const std::string& file_name);

}  // namespace luxrig
