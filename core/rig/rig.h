#pragma once
/// A rig as plain values: what rig.toml says, checked once (rig_file.h reads it). Lists keep the order
/// of the file; indices into them are used everywhere else.

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/photometry/intensity.h"
#include "core/photometry/lamp_tilt.h"
#include "core/photometry/luminous_shape.h"
#include "core/result.h"
#include "core/rig/frames.h"
#include "core/scene/mesh/mesh_file.h"

namespace luxrig {

/// Where in the rig file something stands, for problems found later.
struct Place {
  int line = 0;
  int column = 0;
};

struct ReflectanceRule {
  std::string material_pattern;  ///< shell pattern: * and ?
  Vec3 reflectance_rgb = Vec3::Constant(0.5);
  Place place;
  double specular = 0;     ///< gloss: reflectance of the coat at normal incidence, 0…0.95
  double roughness = 0.3;  ///< of the coat, 0.05…1
};

/// A thing put into the scene: a mesh file, or a box.
struct SceneObject {
  std::string name;
  std::optional<MeshFile> mesh;          ///< else box_m
  Vec3 box_m = Vec3::Zero();             ///< width (x), depth (y), height (z)
  Vec3 position_world_m = Vec3::Zero();  ///< where the middle of its underside (bounding box) stands
  double turn_rad = 0;                   ///< about +Z, counter-clockwise from above
  std::optional<double> height_m;        ///< mesh scaled evenly to this height
  std::optional<Vec3> reflectance_rgb;   ///< of all its materials; else rules and file colours apply
  std::optional<double> transmittance;   ///< of each face, at normal incidence: it is of glass (core/scene/panes.h)
  Place place;
};

struct SceneSpec {
  std::optional<MeshFile> mesh;
  Vec3 default_reflectance_rgb = Vec3::Constant(0.5);  ///< where neither a rule nor the file gives one
  std::vector<ReflectanceRule> reflectances;           ///< first match wins, before the file's own colour
  std::vector<SceneObject> objects;
  Place place;
};

/// ies: a measured file, IES LM-63 or EULUMDAT. cosine: a power of the cosine off the axis. The last four are surfaces
/// of one luminance: a rectangle or disk that faces down, a sphere, an upright cylinder.
enum class LuminaireModel { ies, isotropic, spot, cosine, rectangle, disk, sphere, cylinder };

struct Luminaire {
  std::string name;
  LuminaireModel model = LuminaireModel::isotropic;
  std::filesystem::path ies_path;                  ///< model == ies: .ies, or .ldt for EULUMDAT
  double beam_angle_rad = 0, field_angle_rad = 0;  ///< model == spot, full angles to 50 % and 10 %
  /// model == spot: beam angles that its zoom goes through, rising; none: it has none. core/rig/zoom.h
  std::optional<std::pair<double, double>> zoom_beam_rad{};
  double lumens = 0;  ///< rated flux = flux of `intensity`
  std::optional<double> watts;
  Intensity intensity;  ///< at rated flux; never null in a checked Rig
  LuminousShape shape;  ///< a point, unless the model has a size or a file's opening is asked for (near_field)
  Vec3 colour_rgb = Vec3::Ones();  ///< of its light, linear Rec. 709 with a luminance of 1
  std::optional<LampTilt> tilt;    ///< model == ies: output by how far it hangs off upright
  /// With emitters that are set one by one: for each a luminaire of the rig, called "<name>/<emitter>" and right after
  /// this one. This one is then all of them at their rated flux.
  std::vector<std::size_t> emitters{};
  std::optional<std::size_t> emitter_of{};  ///< the luminaire that has this one among its emitters
  Place place;
};

/// What one DMX slot of a fixture carries.
enum class SlotUse {
  dimmer,
  dimmer_fine,
  dimmer_ultra,
  pan,
  pan_fine,
  pan_ultra,
  tilt,
  tilt_fine,
  tilt_ultra,
  zoom,
  zoom_fine,
  zoom_ultra,
  constant,
  unused
};

/// Which values a channel runs through, as shares of all it has: at its least light or the least angle (of a zoom: of
/// the beam), and at the other end.
struct DmxTravel {
  double at_start = 0, at_end = 1;
  double least = 0;                 ///< level at `at_start`: a dimmer may begin at 10 % of its light
  std::optional<double> at_dark{};  ///< value for level 0, and for any below `least`; none: `at_start` is the lowest

  [[nodiscard]] double at(double share) const {
    if (at_dark && (share <= 0 || share < least)) return *at_dark;
    return at_start + (share > least ? (share - least) / (1 - least) : 0) * (at_end - at_start);
  }
};

struct DmxSlot {
  SlotUse use = SlotUse::dimmer;
  int constant_dmx = 0;  ///< 0…255, for SlotUse::constant (an open shutter, say)
  bool sent = true;      ///< false: obeyed, but sent for the first fixture of the housing
  int cell = 0;          ///< which of several channels of one use that go together; its slots make up one value
  DmxTravel travel{};    ///< of that channel
};

struct DmxPatch {
  int universe = 1;  ///< sACN 1…63999; Art-Net port address 0…32767
  int address = 1;   ///< first slot, 1…512
  std::vector<DmxSlot> slots = {DmxSlot{}};
};

/// How a number stands in Modbus registers.
enum class RegisterNumber { whole, signed_whole, floating };
struct RegisterFormat {
  int registers = 1;  ///< 1 or 2; floating: 2 (IEEE 754 binary32)
  RegisterNumber number = RegisterNumber::whole;
  bool low_word_first = false;  ///< word order CDAB; only with 2 registers
  bool low_byte_first = false;  ///< bytes of each register swapped: BADC, or DCBA
};

struct RegisterMap;

/// A dimmer channel behind a holding register, or two; or a relay behind a coil.
struct ModbusPatch {
  int unit = 1;               ///< 0…255
  int holding_register = 0;   ///< 0-based, as on the wire
  int full_scale_raw = 1000;  ///< register value at full drive, 1…65535
  int dark_raw = 0;           ///< at none
  RegisterFormat format{};
  std::shared_ptr<const RegisterMap> map{};  ///< of its product; null: only the register is known
  bool coil = false;  ///< holding_register is the number of a coil (functions 5 and 15): on or off
};

using Patch = std::variant<DmxPatch, ModbusPatch>;

/// One joint that a drive of its own turns (CiA 402), as a node on a CAN bus.
struct AxisPatch {
  int node = 1;  ///< CANopen node id, 1…127
  double counts_per_degree =
      1;                ///< position units of the drive per degree of the joint; not 0; < 0: counts the other way
  double home_rad = 0;  ///< joint angle at the drive's home position, where it counts 0
  double acceleration_rad_s2 = 0;  ///< > 0, of speeding up and of slowing down

  [[nodiscard]] double counts_at(double joint_rad) const {
    return deg_from_rad(joint_rad - home_rad) * counts_per_degree;
  }
  [[nodiscard]] double joint_rad_at(double counts) const { return home_rad + rad_from_deg(counts / counts_per_degree); }
};

/// A head whose pan and tilt are not on the bus of its lamp.
struct AxesPatch {
  std::size_t bus = 0;
  AxisPatch pan, tilt;
};

/// drive (0…1, what is sent) -> level (0…1, share of rated flux), as the fixture's maker states it.
enum class DimmerCurve { linear, square, s_curve };

struct Personality;

/// A fixture whose slots come from its maker's file.
struct FixtureMode {
  std::filesystem::path file;
  std::shared_ptr<const Personality> personality;  ///< never null
  std::size_t mode = 0;                            ///< of its modes
  std::string emitter{};                           ///< as the rig file calls it; empty: the fixture is one light
  std::string dimmer{};                            ///< channel that the rig file says is its dimmer; empty: none said
  std::vector<std::string> told{};                 ///< how it was understood, for a person
};

/// What hangs and is set by one level. A [[fixture]] whose luminaire has emitters becomes one Fixture for each, called
/// "<name>/<emitter>": they stand one after the other and share place, aim and address.
struct Fixture {
  std::string name;
  std::size_t luminaire = 0;
  std::optional<std::size_t> housing{};  ///< of an emitter: the fixture that is the first of its housing
  Pose world_from_mount;                 ///< base as hung
  std::optional<Vec3> aim_world_m;       ///< point looked at; else `joints` are given
  Joints joints;  ///< pan and tilt, derived from the aim when there is one; zoom as its luminaire
  double roll_rad = 0;
  bool moves = false;                                ///< has pan and tilt slots, or axes; perhaps a zoom slot
  JointRange range;                                  ///< only when it moves
  double pan_speed_rad_s = 0, tilt_speed_rad_s = 0;  ///< only when it moves, > 0
  double zoom_speed_rad_s = 0;                       ///< of the beam angle; only when it zooms, > 0
  std::size_t bus = 0;
  Patch patch;
  std::optional<AxesPatch> axes{};    ///< else pan and tilt are slots of `patch`
  std::optional<FixtureMode> mode{};  ///< with a personality
  DimmerCurve dimmer_curve = DimmerCurve::linear;
  bool switched = false;             ///< on or off: its level is 0 or 1, and nothing between (a relay, a contactor)
  double max_level = 1.0;            ///< 0…1; no output ever above
  std::optional<double> safe_level;  ///< overrides [safe] level
  std::optional<Joints> park{};      ///< where it rests; only when it moves
  int stage = 1;                     ///< of power-up; the lowest first
  double reset_s = 0;                ///< after power comes it finds its zero for so long; only when it moves
  Place place;

  [[nodiscard]] Pose world_from_lamp() const { return luxrig::world_from_lamp(world_from_mount, joints, roll_rad); }
  /// Where its AimCommands go; its LevelCommands go to `bus`.
  [[nodiscard]] std::size_t motion_bus() const { return axes ? axes->bus : bus; }
};

/// What health reports call the two axes of a head that has them.
[[nodiscard]] inline std::string pan_axis_name(const Fixture& fixture) { return fixture.name + " (pan axis)"; }
[[nodiscard]] inline std::string tilt_axis_name(const Fixture& fixture) { return fixture.name + " (tilt axis)"; }

/// A driver's own options, as written. Drivers check them (drivers/registry.h).
using OptionValue = std::variant<bool, std::int64_t, double, std::string>;
struct Option {
  OptionValue value;
  Place place;
};

struct Bus {
  std::string name;
  std::string driver;                     ///< a name in the driver registry
  std::optional<double> safe_level;       ///< of its fixtures that have none of their own; none: that of [safe]
  std::map<std::string, Option> options;  ///< every further key
  Place place;
};

/// How a register pair becomes lux.
struct ModbusMeterPatch {
  int unit = 1;
  bool input_registers = false;  ///< function 4, else holding registers (function 3)
  int first_register = 0;        ///< 0-based
  int registers = 2;             ///< 1: u16, 2: u32
  bool low_word_first = false;   ///< word order CDAB
  double lux_per_count = 0.001;
  RegisterNumber number = RegisterNumber::whole;
  bool low_byte_first = false;
  std::shared_ptr<const RegisterMap> map{};  ///< of its product; null: only the registers are known

  [[nodiscard]] RegisterFormat format() const { return {registers, number, low_word_first, low_byte_first}; }
};

struct Luxmeter {
  std::string name;
  Vec3 position_world_m = Vec3::Zero();
  Vec3 normal_world = Vec3::UnitZ();
  std::optional<std::size_t> point;  ///< the [[point]] it stands at, when it does
  double tolerance = 0.05;           ///< of reading, as a fraction: its true value lies within ±tolerance
  double range_lx = 200000;          ///< full scale
  std::size_t bus = 0;
  ModbusMeterPatch patch;
  Place place;
};

/// Where a real camera's pictures come from; none: only the simulated rig has them.
enum class PictureSource { none, v4l2, files };
/// How samples lie in memory; any: the best of what the device has.
enum class PixelFormat { any, grey8, grey10, grey12, grey16, yuyv, rgb24, bgr24 };
/// How samples grow with light: in proportion, or by the curve of a standard that the camera applied.
enum class PixelCurve { linear, srgb, bt709 };

/// What makes light of samples.
struct PictureTaking {
  PictureSource source = PictureSource::none;
  std::string device;           ///< of v4l2: path, bus, serial number or name; empty: the only one
  std::filesystem::path files;  ///< a folder, or one whose last part is a pattern (* and ?)
  PixelFormat format = PixelFormat::any;
  std::optional<double> exposure_s;  ///< of v4l2
  std::optional<int> gain;           ///< of v4l2, in the device's own steps; none: its default
  double dark_share = 0;             ///< of full scale: what a sample is without light
  PixelCurve curve = PixelCurve::linear;
  std::filesystem::path curve_file;          ///< measured; instead of `curve` when not empty
  std::optional<double> full_scale_cd_m2{};  ///< luminance that fills a sample at this exposure and gain
};

/// Looks at the rig and takes pictures.
struct PictureCamera {
  std::string name;
  Vec3 position_world_m = Vec3::Zero();
  Vec3 aim_world_m = Vec3::UnitY();
  double vertical_fov_rad = rad_from_deg(40);
  int width_px = 960, height_px = 640;
  PictureTaking taking;
  Place place;
};

struct Point {
  std::string name;
  Vec3 position_world_m = Vec3::Zero();
  Vec3 normal_world = Vec3::UnitZ();  ///< unit
  std::optional<double> goal_lx;      ///< none: only reported (and limited)
  std::optional<Vec3> goal_rgb{};     ///< colour of that goal, linear Rec. 709 with a luminance of 1; none: any
  double weight = 1;
  std::optional<double> max_lx;  ///< hard limit
  Place place;
};

enum class PlacementSearch { luxrig, gpk15, gp16, lin2013, annealing, pursuit };
/// As core/solve/placement/placement_methods.h names them.
[[nodiscard]] constexpr const char* name_of(PlacementSearch search) {
  constexpr const char* kNames[] = {"luxrig", "gpk15", "gp16", "lin2013", "annealing", "pursuit"};
  return kNames[static_cast<int>(search)];
}

/// What the rig's own fixtures do while lights are placed: what the tasks before have set (dark, where none has), dark,
/// or all they may.
enum class FixturesMeanwhile { as_set, off, full };

/// kind == placement: lights that are not hung yet.
struct PlacementSpec {
  std::size_t luminaire = 0;
  std::optional<int> lights;    ///< else as few as will do
  int max_lights = 20;          ///< without `lights`
  double error_wanted = 0.001;  ///< normalised error at which the search ends
  double improvement = 0.05;    ///< without `lights`: share of the error that one more light must take away
  PlacementSearch method = PlacementSearch::luxrig;
  bool aimed = false;    ///< what it looks at is searched, too
  bool indirect = true;  ///< reflected light counts in the search
  FixturesMeanwhile fixtures = FixturesMeanwhile::as_set;
  std::optional<double> seconds;  ///< after which the search ends with the best so far
  int energy_front = 0;           ///< power limits to search anew with, below what the lights found take
  bool bound = false;             ///< prove, too, how close as many lights could come
};

/// An object whose relief lights shall bring out.
struct ReliefSpec {
  std::size_t object = 0;               ///< of SceneSpec::objects; a mesh
  std::optional<double> scale_m;        ///< at which its curvature is looked at; none: from the mesh
  double interest = 0.1;                ///< share of its surface that counts, the most recessed first
  std::optional<double> max_lx;         ///< never more, anywhere on it
  bool relative = true;                 ///< contrast as an eye sees it that adapts, else in lux
  double coverage_weight = 0.25;        ///< of features with a shadow's edge, beside contrast
  std::optional<std::size_t> camera{};  ///< only what it sees of the relief counts; none: all of it
};

/// kind == aim: where heads that hang look, and how bright they are.
struct AimSpec {
  ReliefSpec relief;
  std::vector<std::size_t> heads;  ///< fixtures, rising, of each housing the first; each moves or not
  std::optional<std::size_t> key;  ///< of all fixtures, one of the heads
  double min_key_to_fill = 1;
  std::optional<double> max_key_to_fill;
  std::vector<std::size_t> eyes;     ///< points where light counts from wherever it comes
  std::optional<double> max_eye_lx;  ///< there, and at every camera
  double energy_weight = 0, base_weight = 1, travel_weight = 0.01;
  double base_lx = 0;
};

/// kind == highlight: lights that are not hung yet, on what `mounting` says.
struct HighlightSpec {
  ReliefSpec relief;
  std::size_t luminaire = 0;
  std::optional<int> lights;  ///< else until contrast rises no more
  int max_lights = 8;
};

enum class TaskKind { emittance, placement, aim, highlight };
/// As the rig file writes it.
[[nodiscard]] constexpr const char* name_of(TaskKind kind) {
  constexpr const char* kNames[] = {"emittance", "placement", "aim", "highlight"};
  return kNames[static_cast<int>(kind)];
}

struct Task {
  std::string name;
  TaskKind kind = TaskKind::emittance;
  Place place;
  PlacementSpec placement{};
  AimSpec aim{};
  HighlightSpec highlight{};
  std::optional<double> max_watts{};  ///< of the lights that it sets or places, together

  /// Finds places for lights that do not hang yet.
  [[nodiscard]] bool places_lights() const { return kind == TaskKind::placement || kind == TaskKind::highlight; }
};

/// Where lights may be placed.
struct MountingSpec {
  struct Pattern {
    std::string text;  ///< shell pattern: * and ?
    Place place;
  };
  std::optional<Eigen::AlignedBox3d> box_world_m;   ///< else the scene's bounds
  std::vector<Pattern> surfaces;                    ///< by name of material or object; empty: anywhere in the air
  double offset_min_m = 0.05, offset_max_m = 0.15;  ///< from those surfaces
  double clearance_m = 0.1;                         ///< from all others
  std::optional<double> spacing_m;                  ///< of the places that are tried first
  Place place;
};

/// A region that no lit beam of a head may meet: an audience, a camera, a mirror. Box or sphere.
struct KeepOut {
  std::string name;
  std::optional<Eigen::AlignedBox3d> box_world_m;  ///< else the sphere
  Vec3 centre_world_m = Vec3::Zero();
  double radius_m = 0;                  ///< > 0
  double margin_rad = rad_from_deg(2);  ///< beside the beam's field angle
  std::vector<std::size_t> heads;       ///< fixtures that it holds for, rising; all of them move
  Place place;
};

struct Limits {
  double max_level = 1.0;          ///< over all fixtures
  double open_loop_margin = 0.25;  ///< share of a max_lx kept free until a meter has confirmed the model there
  /// Electrical power of all fixtures, and lights that are placed, together. Taken as rated watts times level.
  std::optional<double> max_watts{};
  Place place;
};

enum class FadeCurve { linear, s_curve };

struct ControlSpec {
  double fade_s = 3;  ///< from one look to the next
  FadeCurve fade_curve = FadeCurve::s_curve;
  double correction_fade_s = 1.0;          ///< between correction rounds
  double settle_s = 0.5;                   ///< wait after a fade before a meter is believed
  int rounds = 3;                          ///< most correction rounds after a cue
  double tolerance = 0.02;                 ///< |measured - goal| / goal at which a round is left out
  double goal_tolerance = 0.1;             ///< |true - goal| / goal at which a goal still counts as met
  double gain_min = 0.6, gain_max = 1.15;  ///< what the model allows a fixture's true output to be, as a factor
  Place place;
};

/// What goes to the safe look when a device fails: the fixtures that hang on it, or all.
enum class SafeScope { rest_stays, all };

struct SafeSpec {
  double level = 0.1;  ///< of every fixture without its own safe_level, or its bus's
  double hold_s = 5;   ///< how long the last look is held after a failure
  double fade_s = 3;
  SafeScope scope = SafeScope::rest_stays;
  bool on_meter_loss = false;  ///< true: a lost meter sends all light to the safe look
  Place place;
};

/// How light comes on after power does. Nothing is staged unless something is said.
struct StartupSpec {
  double stage_s = 0;                       ///< from the beginning of one stage to that of the next
  std::optional<double> max_watts_per_s{};  ///< added, of all fixtures together
  bool after_loss = false;                  ///< a device that was lost and is back had no power, and starts so, too
  Place place;
};

/// Light from outside. Directions are resolved: north and the time of day have had their say.
struct Daylight {
  enum class SkyKind { none, uniform, overcast, clear, general };
  SkyKind sky = SkyKind::none;
  int general_type = 12;     ///< 1…15 of ISO 15469, for SkyKind::general
  double horizontal_lx = 0;  ///< of the sky without the sun, on an unobstructed horizontal plane; > 0 with a sky
  double sun_normal_lx = 0;  ///< of the sun, on a plane that faces it; 0: no sun
  Vec3 towards_sun_world = Vec3::UnitZ();  ///< unit; below the horizon there is no sun
  Place place;
};

struct DaemonSpec {
  int http_port = 9620;  ///< on loopback
  bool park_at_end = false;
  Place place;
};

struct Rig {
  std::filesystem::path file;  ///< as opened, for problems and for paths beside it
  std::string name;
  SceneSpec scene;
  std::vector<Luminaire> luminaires;
  std::vector<Bus> buses;
  std::vector<Fixture> fixtures;
  std::vector<Luxmeter> luxmeters;
  std::vector<PictureCamera> cameras;
  std::optional<Daylight> daylight;
  std::vector<Point> points;
  std::vector<Task> tasks;
  MountingSpec mounting;
  std::vector<KeepOut> keep_outs;
  Limits limits;
  ControlSpec control;
  SafeSpec safe;
  StartupSpec startup;
  DaemonSpec daemon;
  std::vector<Problem> notes;  ///< legal, but worth a look (a goal above its limit, an odd IES file)

  /// Goals say a colour: then every point with a goal that counts has one.
  [[nodiscard]] bool colour_goals() const {
    return std::any_of(points.begin(), points.end(), [](const Point& p) { return p.goal_lx && p.goal_rgb; });
  }
  /// Highest level that it may have: its own limit and that of the rig.
  [[nodiscard]] double max_level(const Fixture& fixture) const { return std::min(fixture.max_level, limits.max_level); }
  /// What of a luminaire is set one by one: its emitters, or the luminaire itself.
  [[nodiscard]] std::vector<std::size_t> emitters_or_itself(std::size_t luminaire) const {
    const std::vector<std::size_t>& emitters = luminaires[luminaire].emitters;
    return emitters.empty() ? std::vector<std::size_t>{luminaire} : emitters;
  }
};

}  // namespace luxrig
