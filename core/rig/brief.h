#pragma once
/// The brief of a rig: points with goals and limits, tasks, mounting, keep-out zones, control, daylight.

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "core/rig/scene_spec.h"

namespace luxrig {

struct Point {
  std::string name;
  Vec3 position_world_m = Vec3::Zero();
  Vec3 normal_world = Vec3::UnitZ();  ///< unit
  std::optional<double> goal_lx;      ///< none = only reported (and limited)
  std::optional<Vec3> goal_rgb{};     ///< colour of that goal, linear Rec. 709 with a luminance of 1; none = any
  double weight = 1;
  std::optional<double> max_lx;               ///< hard limit
  std::optional<double> goal_tolerance{};     ///< none = that of ControlSpec
  std::optional<std::size_t> surface_goal{};  ///< index in the rig; none = a [[point]]
  FilePosition in_file;
};

/// Light that is painted on surfaces. `luxrig paint` keeps its strokes, and lays out points for them in a file beside,
/// which are read as the rig's points.
struct SurfaceGoalSpec {
  std::string name;
  std::filesystem::path strokes_file;  ///< core/goals/painting_file.h
  std::optional<double> max_lx;        ///< hard limit at its points
  double weight = 1;
  std::optional<Vec3> goal_rgb{};                 ///< colour of its light, as Point::goal_rgb; none = any
  std::optional<double> uniformity{};             ///< lowest over mean illuminance that is wanted (EN 12464-1: U0)
  std::optional<double> goal_tolerance{};         ///< of its points; none = ControlSpec::goal_tolerance
  double patch_m = 0.1;                           ///< size of the patches that strokes cover
  double min_spacing_m = 0.2, max_spacing_m = 1;  ///< of its points: where it has most detail, and where it has none
  FilePosition in_file;

  /// points_csv.h
  [[nodiscard]] std::filesystem::path points_file() const {
    return std::filesystem::path(strokes_file).replace_extension(".csv");
  }
};

enum class PlacementSearch { luxrig, gpk15, gp16 };
/// Names as in core/solve/placement/placement_methods.h.
[[nodiscard]] constexpr const char* name_of(PlacementSearch search) {
  constexpr const char* kNames[] = {"luxrig", "gpk15", "gp16"};
  return kNames[static_cast<int>(search)];
}

/// State of the rig's own fixtures while lights are placed. as_set: as earlier tasks set them (dark if none did). off:
/// dark. full: at their highest level.
enum class FixturesMeanwhile { as_set, off, full };

/// kind == placement: finds lights that are not hung yet.
struct PlacementSpec {
  std::size_t luminaire = 0;
  std::optional<int> lights;    ///< none = as few as suffice
  int max_lights = 20;          ///< without `lights`
  double error_wanted = 0.001;  ///< normalised error at which the search ends
  double improvement = 0.05;    ///< without `lights`: share of the error that one more light must remove
  PlacementSearch method = PlacementSearch::luxrig;
  bool aimed = false;    ///< the aim is searched, too
  bool indirect = true;  ///< reflected light counts in the search
  FixturesMeanwhile fixtures = FixturesMeanwhile::as_set;
  std::optional<double> seconds;  ///< time after which the search ends with its best so far
  int energy_front = 0;           ///< number of further searches with power limits below the power of the lights found
  bool bound = false;             ///< also prove how close the same number of lights could come
};

/// What a task's lights are to the object, as photographers say. any: all of its light.
enum class LightRole { any, key, fill, rim, background };
[[nodiscard]] constexpr const char* name_of(LightRole role) {
  constexpr const char* kNames[] = {"any", "key", "fill", "rim", "background"};
  return kNames[static_cast<int>(role)];
}

/// Where photographers put lights for a known effect (core/highlight/lights/set_up.h).
enum class SetUp { none, rembrandt, loop, split, broad, raking, copy };
[[nodiscard]] constexpr const char* name_of(SetUp set_up) {
  constexpr const char* kNames[] = {"none", "rembrandt", "loop", "split", "broad", "raking", "copy"};
  return kNames[static_cast<int>(set_up)];
}

/// What a person wants to see of an object, as factors on the usual weights of SeenWishes
/// (core/highlight/seen/seen_contrast.h); none of them below 0.
struct SeenWeights {
  double fine = 1, form = 1, lit = 1, edge = 1;
  double even = 0, shadows = 0;  ///< over the weight of `lit`
  double max_clipped = 0.02;     ///< share of what is seen that may be burnt or crushed
};

/// An object whose relief is to be brought out.
struct ReliefSpec {
  std::size_t object = 0;               ///< index in SceneSpec::objects; a mesh
  std::optional<double> scale_m;        ///< scale at which its curvature is measured; none = from the mesh
  double interest = 0.1;                ///< share of its surface that counts, the most recessed first
  std::optional<double> max_lx;         ///< highest allowed anywhere on it
  bool seen = false;                    ///< judged by what is seen of it; false = by contrast at its recessed places
  bool relative = true;                 ///< that contrast as an adapted eye sees it; false = in lux
  double coverage_weight = 0.25;        ///< weight of features with a shadow edge, relative to contrast
  std::optional<std::size_t> camera{};  ///< only relief that it sees counts; none = all
  LightRole role = LightRole::any;
  std::optional<double> ratio{};    ///< of the key's illuminance to this role's, or, of the key, to all other light
  SetUp set_up = SetUp::none;       ///< as seen by the camera
  SeenWeights weights{};            ///< objective "seen"
  std::optional<Vec3> light_rgb{};  ///< colour of its lights, as Point::goal_rgb; none = all emitters alike
};

/// kind == aim: aims and levels of heads that are already hung.
struct AimSpec {
  ReliefSpec relief;
  std::vector<std::size_t> heads;  ///< fixtures, rising, the first of each housing; they may or may not move
  std::optional<std::size_t> key;  ///< index in fixtures; one of the heads
  double min_key_to_fill = 1;
  std::optional<double> max_key_to_fill;
  std::vector<std::size_t> eyes;     ///< points where light from any direction counts
  std::optional<double> max_eye_lx;  ///< at those points and at every camera
  double energy_weight = 0, base_weight = 1, travel_weight = 0.01;
  double base_lx = 0;
};

/// kind == highlight: lights that are not hung yet, placed as `mounting` allows.
struct HighlightSpec {
  ReliefSpec relief;
  std::size_t luminaire = 0;
  std::optional<int> lights;  ///< none = until contrast no longer rises
  int max_lights = 8;
};

/// kind == directions: where a lamp that a person carries should be held. Nothing of the rig is set.
struct DirectionsSpec {
  ReliefSpec relief;
  std::optional<int> lights;  ///< none = until contrast no longer rises
  int max_lights = 4;
  double distance_m = 1.5;  ///< of the lamp from the object; nothing else may stand nearer in its direction
};

enum class TaskKind { emittance, placement, aim, highlight, directions };
/// Name in the rig file.
[[nodiscard]] constexpr const char* name_of(TaskKind kind) {
  constexpr const char* kNames[] = {"emittance", "placement", "aim", "highlight", "directions"};
  return kNames[static_cast<int>(kind)];
}

struct Task {
  std::string name;
  TaskKind kind = TaskKind::emittance;
  FilePosition in_file;
  PlacementSpec placement{};
  AimSpec aim{};
  HighlightSpec highlight{};
  DirectionsSpec directions{};
  std::optional<double> max_watts{};  ///< of the lights it sets or places, together

  /// Finds places for lights that are not hung yet.
  [[nodiscard]] bool places_lights() const { return kind == TaskKind::placement || kind == TaskKind::highlight; }
  /// Sets fixtures of the rig.
  [[nodiscard]] bool sets_levels() const { return kind == TaskKind::emittance || kind == TaskKind::aim; }
};

/// Region where lights may be placed.
struct MountingSpec {
  struct Pattern {
    std::string text;  ///< shell pattern: * and ?
    FilePosition in_file;
  };
  std::optional<Eigen::AlignedBox3d> box_world_m;   ///< none = the scene's bounds
  std::vector<Pattern> surfaces;                    ///< by name of material or object; empty = anywhere in the air
  double offset_min_m = 0.05, offset_max_m = 0.15;  ///< from those surfaces
  double clearance_m = 0.1;                         ///< from all others
  std::optional<double> spacing_m;                  ///< between the places tried first
  FilePosition in_file;
};

/// A region that no lit beam of a head may meet: an audience, a camera, a mirror. Box or sphere.
struct KeepOut {
  std::string name;
  std::optional<Eigen::AlignedBox3d> box_world_m;  ///< none = the sphere
  Vec3 centre_world_m = Vec3::Zero();
  double radius_m = 0;                  ///< > 0
  double margin_rad = rad_from_deg(2);  ///< beside the beam's field angle
  std::vector<std::size_t> heads;       ///< fixtures it applies to, rising; all of them move
  FilePosition in_file;
};

struct Limits {
  double max_level = 1.0;          ///< for all fixtures
  double open_loop_margin = 0.25;  ///< share of a max_lx kept free until a meter has confirmed the model there
  /// Electrical power of all fixtures and placed lights together, taken as rated watts times level.
  std::optional<double> max_watts{};
  FilePosition in_file;
};

enum class FadeCurve { linear, s_curve };

struct ControlSpec {
  double fade_s = 3;  ///< from one look to the next
  FadeCurve fade_curve = FadeCurve::s_curve;
  double correction_fade_s = 1.0;          ///< between correction rounds
  double settle_s = 0.5;                   ///< wait after a fade before a meter is believed
  int rounds = 3;                          ///< most correction rounds after a cue
  double tolerance = 0.02;                 ///< |measured - goal| / goal below which no correction round is run
  double goal_tolerance = 0.1;             ///< |true - goal| / goal at which a goal still counts as met
  double gain_min = 0.6, gain_max = 1.15;  ///< range of a fixture's true output that the model allows, as a factor
  bool fault_dips = true;  ///< one lamp may be dimmed for seconds, to tell causes of changed readings apart
  FilePosition in_file;
};

/// What goes to the safe look when a device fails: only the fixtures on it, or all.
enum class SafeScope { rest_stays, all };

struct SafeSpec {
  double level = 0.1;  ///< of every fixture without its own safe_level, or its bus's
  double hold_s = 5;   ///< time that the last look is held after a failure
  double fade_s = 3;
  SafeScope scope = SafeScope::rest_stays;
  bool on_meter_loss = false;  ///< true = a lost meter sends all light to the safe look
  FilePosition in_file;
};

/// How light comes on after power-up. Nothing is staged by default.
struct StartupSpec {
  double stage_s = 0;                       ///< from the start of one stage to the start of the next
  std::optional<double> max_watts_per_s{};  ///< highest rise of power, all fixtures together
  bool after_loss = false;                  ///< a device back after a loss had no power, and is staged, too
  FilePosition in_file;
};

/// Light from outside. Directions are final: north and the time of day are already applied.
struct Daylight {
  enum class SkyKind { none, uniform, overcast, clear, general };
  SkyKind sky = SkyKind::none;
  int general_type = 12;     ///< 1…15 of ISO 15469, for SkyKind::general
  double horizontal_lx = 0;  ///< of the sky without the sun, on an unobstructed horizontal plane; > 0 with a sky
  double sun_normal_lx = 0;  ///< of the sun, on a plane facing it; 0 = no sun
  Vec3 towards_sun_world = Vec3::UnitZ();  ///< unit; below the horizon there is no sun
  FilePosition in_file;
};

struct DaemonSpec {
  int http_port = 9620;
  std::string listen = "127.0.0.1";  ///< address; any but loopback needs accounts
  std::filesystem::path accounts_file;
  std::filesystem::path tls_certificate_file, tls_key_file;  ///< PEM; both or none
  bool behind_proxy = false;  ///< the client's address and scheme are those that the proxy states
  bool park_at_end = false;
  FilePosition in_file;
};

}  // namespace luxrig
