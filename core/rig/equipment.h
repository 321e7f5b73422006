#pragma once
/// The equipment of a rig: luminaires, fixtures, luxmeters and cameras.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/photometry/files/lamp_tilt.h"
#include "core/photometry/intensity.h"
#include "core/photometry/shapes/luminous_shape.h"
#include "core/rig/frames.h"
#include "core/rig/joint_map.h"
#include "core/rig/patch.h"

namespace luxrig {

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
  FilePosition in_file;
};

/// drive (0…1, as sent) -> level (0…1, share of rated flux), as the maker states it.
enum class DimmerCurve { linear, square, s_curve };

/// Level by the maker's curve -> share of its full light, both strictly ascending within 0…1, without 0, the last of at
/// least two (1, 1). Empty = the maker's curve is right.
using MeasuredCurve = std::vector<std::pair<double, double>>;

/// Standard deviations, as shares: of a lamp's output (NaN = as the rig file allows); of its light at a place beside.
struct LightError {
  double output = 0, local = 0;
  double least_local = 0;  ///< where that is known best
};

/// Light of a fixture that does not move at a point, at full level, as a calibration found it.
struct KnownLight {
  std::size_t point = 0, fixture = 0;
  double lux = 0, standard_error_lx = 0;
};

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
  std::optional<JointMap> joint_map{};               ///< by a calibration; none = what is sent is where it turns
  double pan_speed_rad_s = 0, tilt_speed_rad_s = 0;  ///< only if it moves, > 0
  double zoom_speed_rad_s = 0;                       ///< of the beam angle; only if it zooms, > 0
  double settles_s =
      0;  ///< by a calibration: from an order, beside its way, until its beam stands still; 0 = not known
  std::size_t bus = 0;
  Patch patch;
  std::optional<AxesPatch> axes{};    ///< if none, pan and tilt are slots of `patch`
  std::optional<FixtureMode> mode{};  ///< if it has a personality
  DimmerCurve dimmer_curve = DimmerCurve::linear;
  MeasuredCurve measured_curve{};    ///< by a calibration; over dimmer_curve
  std::optional<LightError> known_to{};  ///< by a calibration; none = as wide as the rig file allows
  bool switched = false;             ///< on or off: its level is 0 or 1, nothing between (a relay, a contactor)
  double max_level = 1.0;            ///< 0…1; its output never exceeds it
  std::optional<double> safe_level;  ///< overrides [safe] level
  std::optional<Joints> park{};      ///< rest position; only if it moves
  int stage = 1;                     ///< of power-up; the lowest comes first
  double reset_s = 0;                ///< how long it homes after power-on; only if it moves
  FilePosition in_file;

  /// Of what may be sent. Everything else deals in true joints, whose range is `range`.
  [[nodiscard]] const JointRange& sent_range() const { return joint_map ? joint_map->sent : range; }
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

struct Luxmeter {
  std::string name;
  Vec3 position_world_m = Vec3::Zero();
  Vec3 normal_world = Vec3::UnitZ();
  std::optional<std::size_t> point;  ///< the [[point]] it is at, if any
  double tolerance = 0.05;           ///< fraction of the reading: the true value lies within ±tolerance
  double range_lx = 200000;          ///< full scale
  std::size_t bus = 0;
  ModbusMeterPatch patch;
  FilePosition in_file;
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
  FilePosition in_file;
};

}  // namespace luxrig
