#pragma once
/// The truth that a rig file only approximates: one seeded world behind every simulated device.
///
/// Deviations are drawn once from the seed: of lamps, dimmers, mounts, the room and meters (struct Deviations).
/// Light follows drive with the lamp's lag; heads move at their speeds. Everything is a function of the seed and of the
/// timed writes: the same writes at the same times give the same readings.
///
/// The world's clock starts at Time{} and ticks every 10 ms. A write takes effect with the next tick, so the pattern of
/// advance() calls does not matter.

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/output/devices.h"
#include "core/rig/rig.h"
#include "core/scene/scene.h"
#include "core/transport/evaluator.h"

namespace luxrig::sim {

inline constexpr Duration kTick = std::chrono::milliseconds(10);

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
  double backlash_rad = 0;
  double pan_scale = 1;  ///< true over commanded; negative: it turns the other way
  std::size_t line = 0;  ///< the fixture whose drive and aim reach it
};

/// Frame of the lamp's light, at these true joints (core/rig/frames.h).
[[nodiscard]] Pose true_lamp(const FixtureTruth& truth, const Joints& joints, double roll_rad);
/// Where the head looks when its electronics are told to: joints of the file.
[[nodiscard]] Joints true_joints(const FixtureTruth& truth, const Joints& commanded);

struct PointTruth {
  double lux = 0;
  double max_lux_seen = 0;  ///< largest at any step since the start (or the last reset_peaks)
};

/// A period in which a point's true lux exceeded its limit.
struct Violation {
  std::size_t point = 0;
  double max_lx = 0;  ///< the limit
  double lux = 0;     ///< maximum in that period
  Time began{};
};

/// The light of a moving head on each receiver at rated flux, for any joints. world.cpp calls it at every tick of a
/// movement.
class HeadLight {
 public:
  virtual ~HeadLight() = default;
  /// Writes the column of T for `fixture` (which moves) looking at `joints`. Rows as in World::make.
  virtual void column(std::size_t fixture, const Joints& joints, Eigen::Ref<Eigen::VectorXd> lux) const = 0;
};

/// What meters make of light, over its illuminance: they respond to slanting light too little or too much.
struct MeterResponse {
  Eigen::MatrixXd of_fixtures;  ///< luxmeters × fixtures; empty = 1
  Eigen::VectorXd of_daylight;  ///< luxmeters; empty = 1
};

class World {
 public:
  /// Loads the scene and computes the true transport with the true poses (takes seconds). `max_error`: of that
  /// transport. Luminaires and daylight are made as for the planner (core/tasks/rig_transport.h).
  static Result<std::unique_ptr<World>> make(const Rig& rig, const Deviations& deviations, double max_error,
                                             const Watch& watch = {});

  /// The same from a given transport: `lux_per_level` has a row per point of the rig, then one per luxmeter, and a
  /// column per fixture, at rated flux. Without `heads`, turning a head changes no light.
  /// fixed_lx   light independent of the fixtures (daylight), per row; empty = none
  /// Cause::invalid if the shape does not fit or an entry is negative or not finite.
  static Result<std::unique_ptr<World>> make(const Rig& rig, const Deviations& deviations,
                                             const Eigen::MatrixXd& lux_per_level,
                                             std::unique_ptr<const HeadLight> heads = nullptr,
                                             const Eigen::VectorXd& fixed_lx = {}, const MeterResponse& response = {});

  virtual ~World() = default;
  /// The drive that the wires carry to a fixture. Values out of range are clamped, as by a device.
  virtual void set_drive(std::size_t fixture, double drive) = 0;
  /// Its lamp is burnt out or has no power: dark at any drive.
  virtual void set_lamp_out(std::size_t fixture, bool out) = 0;
  virtual void set_aim_target(std::size_t fixture, const Joints& joints) = 0;
  /// Sets a head whose joints are simulated elsewhere (sim/devices/axis_mechanics.h), at the next tick; it no longer
  /// turns by itself. Not clamped: the axis has its own end stops.
  virtual void set_joints(std::size_t fixture, const Joints& joints) = 0;
  /// Somebody stands in the light of this point: it, and the luxmeters at it, get this share of the lamps' light (1:
  /// nobody).
  virtual void set_shade(std::size_t point, double share) = 0;
  /// The luxmeter sees this share of all light at it (1: it is not covered).
  virtual void set_cover(std::size_t luxmeter, double share) = 0;
  /// The luxmeter shows this in place of its light, such as a recorded reading; nullopt: its light again.
  virtual void set_shown(std::size_t luxmeter, std::optional<double> lux) = 0;
  /// Daylight is this many times that of the rig file.
  virtual void set_daylight(double factor) = 0;
  /// Advances lamps, heads and meters to `now` in steps of 10 ms, recording peaks at every step. Never goes back.
  virtual void advance(Time now) = 0;
  /// Time of the last tick.
  [[nodiscard]] virtual Time now() const = 0;
  /// Reading of a meter at the world's present time (gain, noise, lag, quantisation and clipping included).
  [[nodiscard]] virtual double meter_reading_lx(std::size_t luxmeter) const = 0;
  /// Time of that reading; Time{} = none taken yet.
  [[nodiscard]] virtual Time meter_sampled_at(std::size_t luxmeter) const = 0;

  [[nodiscard]] virtual std::vector<PointTruth> points() const = 0;     ///< true lux at the rig's points
  [[nodiscard]] virtual std::vector<PointTruth> luxmeters() const = 0;  ///< true lux at the meters
  [[nodiscard]] virtual std::vector<double> levels() const = 0;         ///< true output over rated, per fixture
  [[nodiscard]] virtual std::vector<double> drives() const = 0;         ///< as set, clamped; 0 if the lamp is out
  [[nodiscard]] virtual std::vector<Joints> joints() const = 0;         ///< present positions of the heads
  [[nodiscard]] virtual const std::vector<FixtureTruth>& fixtures() const = 0;
  [[nodiscard]] virtual const std::vector<double>& meter_gains() const = 0;
  /// In order of their start; the first thousand.
  [[nodiscard]] virtual const std::vector<Violation>& violations() const = 0;
  /// Forgets peaks and violations.
  virtual void reset_peaks() = 0;
};

/// Worlds of one rig for many seeds: what they share is computed once. Direct light is of each seed's true poses, so
/// exact; reflected light is of the rig file's poses. With poses off by 1 cm and 0.2° the difference in reflected light
/// is far below the deviation of lamp outputs.
class WorldMaker {
 public:
  /// Cause::invalid with a problem of the scene. max_error: of the reflected light, as a share of all.
  static Result<WorldMaker> make(const Rig& rig, double max_error, const Watch& watch = {});
  WorldMaker(WorldMaker&&) noexcept;
  ~WorldMaker();

  [[nodiscard]] Result<std::unique_ptr<World>> world(const Deviations& deviations) const;

 private:
  struct State;
  explicit WorldMaker(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The room as it is: its paint, and its objects, which are not quite where the file says.
[[nodiscard]] Scene true_scene(Scene scene, const Rig& rig, const Deviations& deviations);

/// The properties that the seed gives each fixture.
[[nodiscard]] std::vector<FixtureTruth> draw_fixtures(const Rig& rig, const Deviations& deviations);

}  // namespace luxrig::sim
