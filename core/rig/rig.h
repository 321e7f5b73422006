#pragma once
/// A rig as plain values: the checked content of rig.toml (read by rig_file.h). Lists keep the order of the file; all
/// other code refers to their entries by index.

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

/// Position in the rig file, for problems found later.
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

/// An object placed in the scene: a mesh file, or a box.
struct SceneObject {
  std::string name;
  std::optional<MeshFile> mesh;          ///< else box_m
  Vec3 box_m = Vec3::Zero();             ///< width (x), depth (y), height (z)
  Vec3 position_world_m = Vec3::Zero();  ///< position of the middle of its underside (bounding box)
  double turn_rad = 0;                   ///< about +Z, counter-clockwise from above
  std::optional<double> height_m;        ///< mesh scaled evenly to this height
  std::optional<Vec3> reflectance_rgb;   ///< of all its materials; if not given, rules and file colours apply
  std::optional<double> transmittance;   ///< of each face, at normal incidence; set = glass (core/scene/panes.h)
  Place place;
};

struct SceneSpec {
  std::optional<MeshFile> mesh;
  Vec3 default_reflectance_rgb = Vec3::Constant(0.5);  ///< if neither a rule nor the file gives one
  std::vector<ReflectanceRule> reflectances;           ///< first match wins, before the file's own colour
  std::vector<SceneObject> objects;
  Place place;
};

/// ies: a measured file, IES LM-63 or EULUMDAT. cosine: a power of the cosine off the axis. The last four are surfaces
/// of uniform luminance: a rectangle or disk facing down, a sphere, an upright cylinder.
enum class LuminaireModel { ies, isotropic, spot, cosine, rectangle, disk, sphere, cylinder };

struct Luminaire {
  std::string name;
  LuminaireModel model = LuminaireModel::isotropic;
  std::filesystem::path ies_path;                  ///< model == ies: .ies, or .ldt for EULUMDAT
  double beam_angle_rad = 0, field_angle_rad = 0;  ///< model == spot, full angles to 50 % and 10 %
  /// model == spot: beam angles of its zoom, from and to; none = it does not zoom. See core/rig/zoom.h
  std::optional<std::pair<double, double>> zoom_beam_rad{};
  double lumens = 0;  ///< rated flux = flux of `intensity`
  std::optional<double> watts;
  Intensity intensity;             ///< at rated flux; never null in a checked Rig
  LuminousShape shape;             ///< a point, unless the model has a size or near_field asks for the file's opening
  Vec3 colour_rgb = Vec3::Ones();  ///< of its light, linear Rec. 709 with a luminance of 1
  std::optional<LampTilt> tilt;    ///< model == ies: output by its angle from upright
  /// Its emitters, if they are set one by one: each is a luminaire of the rig, called "<name>/<emitter>", and directly
  /// follows this one. This one is then all of them together at rated flux.
  std::vector<std::size_t> emitters{};
  std::optional<std::size_t> emitter_of{};  ///< the luminaire that this one is an emitter of
  Place place;
};

/// Function of one DMX slot of a fixture.
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

/// The part of a channel's values that is used, as shares of its whole range. For a dimmer, from least to full light.
/// For an angle, from the least to the largest; for a zoom, that is the beam angle.
struct DmxTravel {
  double at_start = 0, at_end = 1;
  double least = 0;                 ///< level at `at_start`: a dimmer may begin at 10 % of its light
  std::optional<double> at_dark{};  ///< value for level 0 and for any below `least`; none = `at_start` is the lowest

  [[nodiscard]] double at(double share) const {
    if (at_dark && (share <= 0 || share < least)) return *at_dark;
    return at_start + (share > least ? (share - least) / (1 - least) : 0) * (at_end - at_start);
  }
};

struct DmxSlot {
  SlotUse use = SlotUse::dimmer;
  int constant_dmx = 0;  ///< 0…255, for SlotUse::constant (an open shutter, say)
  bool sent = true;      ///< false = the fixture obeys the slot, but it is sent for the first fixture of the housing
  int cell = 0;          ///< which channel, if several of one use run together; its slots form one value
  DmxTravel travel{};    ///< of that channel
};

struct DmxPatch {
  int universe = 1;  ///< sACN 1…63999; Art-Net port address 0…32767
  int address = 1;   ///< first slot, 1…512
  std::vector<DmxSlot> slots = {DmxSlot{}};
};

/// Number format of Modbus registers.
enum class RegisterNumber { whole, signed_whole, floating };
struct RegisterFormat {
  int registers = 1;  ///< 1 or 2; floating: 2 (IEEE 754 binary32)
  RegisterNumber number = RegisterNumber::whole;
  bool low_word_first = false;  ///< word order CDAB; only with 2 registers
  bool low_byte_first = false;  ///< bytes of each register swapped: BADC, or DCBA
};

struct RegisterMap;

/// A dimmer channel behind one or two holding registers, or a relay behind a coil.
struct ModbusPatch {
  int unit = 1;               ///< 0…255
  int holding_register = 0;   ///< 0-based, as on the wire
  int full_scale_raw = 1000;  ///< register value at full drive, 1…65535
  int dark_raw = 0;           ///< register value at no drive
  RegisterFormat format{};
  std::shared_ptr<const RegisterMap> map{};  ///< of its product; null = only the register is known
  bool coil = false;                         ///< holding_register is a coil number (functions 5 and 15): on or off
};

using Patch = std::variant<DmxPatch, ModbusPatch>;

/// One joint with its own drive (CiA 402), a node on a CAN bus.
struct AxisPatch {
  int node = 1;  ///< CANopen node id, 1…127
  double counts_per_degree =
      1;                ///< position units of the drive per degree of the joint; not 0; < 0 = counts the other way
  double home_rad = 0;  ///< joint angle at the drive's home position, where it counts 0
  double acceleration_rad_s2 = 0;  ///< > 0, for speeding up and slowing down

  [[nodiscard]] double counts_at(double joint_rad) const {
    return deg_from_rad(joint_rad - home_rad) * counts_per_degree;
  }
  [[nodiscard]] double joint_rad_at(double counts) const { return home_rad + rad_from_deg(counts / counts_per_degree); }
};

/// For a head whose pan and tilt are not on the bus of its lamp.
struct AxesPatch {
  std::size_t bus = 0;
  AxisPatch pan, tilt;
};

/// drive (0…1, as sent) -> level (0…1, share of rated flux), as the maker states it.
enum class DimmerCurve { linear, square, s_curve };

struct Personality;

/// For a fixture whose slots come from its maker's file.
struct FixtureMode {
  std::filesystem::path file;
  std::shared_ptr<const Personality> personality;  ///< never null
  std::size_t mode = 0;                            ///< of its modes
  std::string emitter{};                           ///< name in the rig file; empty = the fixture is one light
  std::string dimmer{};                            ///< its dimmer channel by the rig file; empty = none named
  std::vector<std::string> told{};                 ///< how the file was interpreted, for a person
};

/// A light set by one level. A [[fixture]] whose luminaire has emitters becomes one Fixture per emitter, called
/// "<name>/<emitter>". They are adjacent in the list and share position, aim and address.
struct Fixture {
  std::string name;
  std::size_t luminaire = 0;
  std::optional<std::size_t> housing{};  ///< of an emitter: the first fixture of its housing
  Pose world_from_mount;                 ///< base as hung
  std::optional<Vec3> aim_world_m;       ///< point aimed at; if none, `joints` are given
  Joints joints;                         ///< pan and tilt, derived from the aim if there is one; zoom as its luminaire
  double roll_rad = 0;
  bool moves = false;                                ///< has pan and tilt slots, or axes; perhaps a zoom slot
  JointRange range;                                  ///< only if it moves
  double pan_speed_rad_s = 0, tilt_speed_rad_s = 0;  ///< only if it moves, > 0
  double zoom_speed_rad_s = 0;                       ///< of the beam angle; only if it zooms, > 0
  std::size_t bus = 0;
  Patch patch;
  std::optional<AxesPatch> axes{};    ///< if none, pan and tilt are slots of `patch`
  std::optional<FixtureMode> mode{};  ///< if it has a personality
  DimmerCurve dimmer_curve = DimmerCurve::linear;
  bool switched = false;             ///< on or off: its level is 0 or 1, nothing between (a relay, a contactor)
  double max_level = 1.0;            ///< 0…1; its output never exceeds it
  std::optional<double> safe_level;  ///< overrides [safe] level
  std::optional<Joints> park{};      ///< rest position; only if it moves
  int stage = 1;                     ///< of power-up; the lowest comes first
  double reset_s = 0;                ///< how long it homes after power-on; only if it moves
  Place place;

  [[nodiscard]] Pose world_from_lamp() const { return world_from_lamp(joints); }
  [[nodiscard]] Pose world_from_lamp(const Joints& at) const {
    return luxrig::world_from_lamp(world_from_mount, at, roll_rad);
  }
  /// Bus of its AimCommands. Its LevelCommands go to `bus`.
  [[nodiscard]] std::size_t motion_bus() const { return axes ? axes->bus : bus; }
};

/// Names of the two axes of a head in health reports.
[[nodiscard]] inline std::string pan_axis_name(const Fixture& fixture) { return fixture.name + " (pan axis)"; }
[[nodiscard]] inline std::string tilt_axis_name(const Fixture& fixture) { return fixture.name + " (tilt axis)"; }

/// A driver's own option, as written. Drivers check them (drivers/registry.h).
using OptionValue = std::variant<bool, std::int64_t, double, std::string>;
struct Option {
  OptionValue value;
  Place place;
};

struct Bus {
  std::string name;
  std::string driver;                     ///< a name in the driver registry
  std::optional<double> safe_level;       ///< for its fixtures without their own; none = that of [safe]
  std::map<std::string, Option> options;  ///< every further key
  Place place;
};

/// How registers become lux.
struct ModbusMeterPatch {
  int unit = 1;
  bool input_registers = false;  ///< function 4; if false, holding registers (function 3)
  int first_register = 0;        ///< 0-based
  int registers = 2;             ///< 1: u16, 2: u32
  bool low_word_first = false;   ///< word order CDAB
  double lux_per_count = 0.001;
  RegisterNumber number = RegisterNumber::whole;
  bool low_byte_first = false;
  std::shared_ptr<const RegisterMap> map{};  ///< of its product; null = only the registers are known

  [[nodiscard]] RegisterFormat format() const { return {registers, number, low_word_first, low_byte_first}; }
};

struct Luxmeter {
  std::string name;
  Vec3 position_world_m = Vec3::Zero();
  Vec3 normal_world = Vec3::UnitZ();
  std::optional<std::size_t> point;  ///< the [[point]] it is at, if any
  double tolerance = 0.05;           ///< fraction of the reading: the true value lies within ±tolerance
  double range_lx = 200000;          ///< full scale
  std::size_t bus = 0;
  ModbusMeterPatch patch;
  Place place;
};

/// Source of a real camera's pictures. none = only the simulated rig has them.
enum class PictureSource { none, v4l2, files };
/// Layout of samples in memory. any = the best that the device offers.
enum class PixelFormat { any, grey8, grey10, grey12, grey16, yuyv, rgb24, bgr24 };
/// How samples grow with light: in proportion, or by the standard curve that the camera applied.
enum class PixelCurve { linear, srgb, bt709 };

/// How pictures are taken, and how their samples become light.
struct PictureTaking {
  PictureSource source = PictureSource::none;
  std::string device;           ///< for v4l2: path, bus, serial number or name; empty = the only one
  std::filesystem::path files;  ///< a folder, or one whose last part is a pattern (* and ?)
  PixelFormat format = PixelFormat::any;
  std::optional<double> exposure_s;  ///< for v4l2
  std::optional<int> gain;           ///< for v4l2, in the device's own steps; none = its default
  double dark_share = 0;             ///< share of full scale: a sample's value without light
  PixelCurve curve = PixelCurve::linear;
  std::filesystem::path curve_file;          ///< measured; used instead of `curve` if not empty
  std::optional<double> full_scale_cd_m2{};  ///< luminance that fills a sample at this exposure and gain
};

/// A camera that looks at the rig and takes pictures.
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
  std::optional<double> goal_lx;      ///< none = only reported (and limited)
  std::optional<Vec3> goal_rgb{};     ///< colour of that goal, linear Rec. 709 with a luminance of 1; none = any
  double weight = 1;
  std::optional<double> max_lx;  ///< hard limit
  Place place;
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

/// An object whose relief is to be brought out.
struct ReliefSpec {
  std::size_t object = 0;               ///< index in SceneSpec::objects; a mesh
  std::optional<double> scale_m;        ///< scale at which its curvature is measured; none = from the mesh
  double interest = 0.1;                ///< share of its surface that counts, the most recessed first
  std::optional<double> max_lx;         ///< highest allowed anywhere on it
  bool relative = true;                 ///< contrast as an adapted eye sees it; false = in lux
  double coverage_weight = 0.25;        ///< weight of features with a shadow edge, relative to contrast
  std::optional<std::size_t> camera{};  ///< only relief that it sees counts; none = all
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
  Place place;
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
    Place place;
  };
  std::optional<Eigen::AlignedBox3d> box_world_m;   ///< none = the scene's bounds
  std::vector<Pattern> surfaces;                    ///< by name of material or object; empty = anywhere in the air
  double offset_min_m = 0.05, offset_max_m = 0.15;  ///< from those surfaces
  double clearance_m = 0.1;                         ///< from all others
  std::optional<double> spacing_m;                  ///< between the places tried first
  Place place;
};

/// A region that no lit beam of a head may meet: an audience, a camera, a mirror. Box or sphere.
struct KeepOut {
  std::string name;
  std::optional<Eigen::AlignedBox3d> box_world_m;  ///< none = the sphere
  Vec3 centre_world_m = Vec3::Zero();
  double radius_m = 0;                  ///< > 0
  double margin_rad = rad_from_deg(2);  ///< beside the beam's field angle
  std::vector<std::size_t> heads;       ///< fixtures it applies to, rising; all of them move
  Place place;
};

struct Limits {
  double max_level = 1.0;          ///< for all fixtures
  double open_loop_margin = 0.25;  ///< share of a max_lx kept free until a meter has confirmed the model there
  /// Electrical power of all fixtures and placed lights together, taken as rated watts times level.
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
  double tolerance = 0.02;                 ///< |measured - goal| / goal below which no correction round is run
  double goal_tolerance = 0.1;             ///< |true - goal| / goal at which a goal still counts as met
  double gain_min = 0.6, gain_max = 1.15;  ///< range of a fixture's true output that the model allows, as a factor
  Place place;
};

/// What goes to the safe look when a device fails: only the fixtures on it, or all.
enum class SafeScope { rest_stays, all };

struct SafeSpec {
  double level = 0.1;  ///< of every fixture without its own safe_level, or its bus's
  double hold_s = 5;   ///< time that the last look is held after a failure
  double fade_s = 3;
  SafeScope scope = SafeScope::rest_stays;
  bool on_meter_loss = false;  ///< true = a lost meter sends all light to the safe look
  Place place;
};

/// How light comes on after power-up. Nothing is staged by default.
struct StartupSpec {
  double stage_s = 0;                       ///< from the start of one stage to the start of the next
  std::optional<double> max_watts_per_s{};  ///< highest rise of power, all fixtures together
  bool after_loss = false;                  ///< a device back after a loss had no power, and is staged, too
  Place place;
};

/// Light from outside. Directions are final: north and the time of day are already applied.
struct Daylight {
  enum class SkyKind { none, uniform, overcast, clear, general };
  SkyKind sky = SkyKind::none;
  int general_type = 12;     ///< 1…15 of ISO 15469, for SkyKind::general
  double horizontal_lx = 0;  ///< of the sky without the sun, on an unobstructed horizontal plane; > 0 with a sky
  double sun_normal_lx = 0;  ///< of the sun, on a plane facing it; 0 = no sun
  Vec3 towards_sun_world = Vec3::UnitZ();  ///< unit; below the horizon there is no sun
  Place place;
};

struct DaemonSpec {
  int http_port = 9620;  ///< on loopback
  bool park_at_end = false;
  Place place;
};

struct Rig {
  std::filesystem::path file;  ///< as opened; for problems, and for paths relative to it
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

  /// Goals state a colour. In that case, every point with a goal that counts has one.
  [[nodiscard]] bool colour_goals() const {
    return std::any_of(points.begin(), points.end(), [](const Point& p) { return p.goal_lx && p.goal_rgb; });
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
