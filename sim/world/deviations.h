#pragma once
/// How the truth differs from a rig file, and what it is for a seed.

#include <cstdint>
#include <vector>

#include "core/rig/rig.h"
#include "core/scene/ray_scene.h"
#include "core/scene/scene.h"
#include "sim/devices/head.h"

namespace luxrig::sim {

/// How far the truth is from the rig file. The kinds, by how well a rig was installed and is looked after:
///   mild  new lamps, mounts within a centimetre, a good meter: what the defaults say
///   real  what is found in halls: ± 20 % of output, curves that are not the label's, mounts 15 cm and 5° off, paint that is
///         not that of the file, meters with cosine error, drift and latency, lamps that warm up and age, clouds, play
///   bad   real, and some heads and lines are connected wrongly
/// "Up to" is a largest value: uniform, or a normal deviation of a third of it that is cut there.
struct Deviations {
  std::uint64_t seed = 1;

  // Lamps and dimmers
  double output_min = 0.80, output_max = 1.05;  ///< true over rated flux
  double curve_exponent_spread = 0.08;          ///< true curve = nominal^(1 ± spread)
  /// Above 0: the light is the drive to a power between these, whatever curve the file states.
  double drive_exponent_min = 0, drive_exponent_max = 0;
  double dead_band = 0;             ///< up to this share of the drive gives no light
  double tail = 0;                  ///< above the dead band the light begins with up to this share
  double lamp_lag_s = 0.05;         ///< first-order
  double warm_up_share = 0;         ///< so much more light when cold; gone after ten minutes at full light
  double ageing_per_hour = 0;       ///< up to this share of the light is lost in an hour at full light
  double photometry_angle_rad = 0;  ///< up to this angle between the axes of photometry and lamp

  // Mounts and heads
  double position_error_m = 0.01;  ///< standard deviation per axis
  double angle_error_rad = 0.003;  ///< standard deviation per axis
  double backlash_rad = 0;         ///< up to this play in pan and tilt
  double head_speed_share = 0;     ///< up to this share slower than stated, or half of it faster
  double head_lag_s = 0;           ///< up to: time constant with which a head follows its motors
  double wrong_heads = 0;          ///< share of heads that hang or turn the wrong way, or by 540° for 630°
  double wrong_lines = 0;          ///< share of fixtures that are patched as their neighbour

  // Room
  double reflectance_spread = 0;  ///< true reflectance of a material = stated · (1 ± spread)
  double object_error_m = 0;      ///< up to this distance sideways, of objects that no point lies on
  double cloud_share = 0;         ///< daylight changes by up to this share within minutes
  double visits_per_hour = 0;     ///< somebody stands in the light of a point, for up to a minute

  // Meters
  double meter_gain_share = 0.25;                           ///< gain error, as a share of the meter's stated tolerance
  double meter_noise = 0.003;                               ///< standard deviation, fraction of reading
  double meter_lag_s = 0.15;                                ///< first-order
  double meter_latency_min_s = 0, meter_latency_max_s = 0;  ///< from the light to the reading
  double meter_cosine_exponent = 0;  ///< responds as cos^(1 + up to this) of the angle of incidence
  double meter_drift_per_hour = 0;   ///< gain, up to

  // Cameras; each up to. They are otherwise as in the rig file, with a straight, clean lens that sees as the eye does.
  double camera_angle_rad = 0;     ///< from where the file has it look
  double camera_position_m = 0;    ///< from where the file has it
  double camera_field_share = 0;   ///< of its field of view
  double camera_distortion = 0;    ///< Camera::distortion
  double camera_vignetting = 0;    ///< of the light, lost in a corner
  double camera_flare = 0;         ///< of all light, spread evenly over the picture
  double camera_halo = 0;          ///< of each pixel's light, spread around it
  double camera_log_response = 0;  ///< ± logarithm of its reading over the eye's, drawn for each kind of lamp

  /// A world exactly as in the rig file: no spread, noise or lag.
  [[nodiscard]] static Deviations none();
  [[nodiscard]] static Deviations real();
  [[nodiscard]] static Deviations bad();

  /// The room's own light differs by so much that it has to be traced for each seed.
  [[nodiscard]] bool of_the_room() const {
    return reflectance_spread > 0 || object_error_m > 0 || position_error_m > 0.02 || angle_error_rad > 0.01 ||
           photometry_angle_rad > 0.01;
  }
};

/// True properties of one fixture.
struct FixtureTruth {
  double output = 1;  ///< true over rated flux, when new and warm
  double curve_exponent = 1;
  bool of_drive = false;  ///< the exponent is of the drive, not of the stated curve
  double dead_band = 0, tail = 0;
  double warm_up_share = 0, ageing_per_hour = 0;
  Pose world_from_mount;
  Mat3 photometry_from_lamp = Mat3::Identity();  ///< turn of its light about the lamp
  HeadTruth head{};
  std::size_t line = 0;  ///< the fixture whose drive and aim reach it
};

/// Frame of the lamp's light, at these true joints (core/rig/frames.h).
[[nodiscard]] Pose true_lamp(const FixtureTruth& truth, const Joints& joints, double roll_rad);
/// Where a head without play looks when it is sent these joints.
[[nodiscard]] Joints true_joints(const FixtureTruth& truth, const Joints& commanded);

/// The room as it is: its paint, and its objects, which are not quite where the file says.
[[nodiscard]] Scene true_scene(Scene scene, const Rig& rig, const Deviations& deviations);

/// The properties that the seed gives each fixture.
/// room: no mount is drawn behind a surface of it, seen from where the file has it; null = anywhere.
[[nodiscard]] std::vector<FixtureTruth> draw_fixtures(const Rig& rig, const Deviations& deviations,
                                                      const RayScene* room = nullptr);

}  // namespace luxrig::sim
