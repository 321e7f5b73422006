#pragma once
/// The truth that a rig file only approximates: one seeded world behind every simulated device.
///
/// Deviations, drawn once from the seed: lamp output −20…+5 % per fixture, dimmer curve exponent off nominal,
/// mount pose errors (centimetres, tenths of a degree), meter gain error within its tolerance, noise, lag,
/// quantisation. Light follows drive with the lamp's lag; heads move at their speeds. Everything is a function of the
/// seed and of what was written when: the same writes at the same times give the same readings.
///
/// The world's clock starts at Time{} and ticks every 10 ms. What is written takes effect with the next tick, so the
/// way in which advance() is called changes nothing.

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/output/devices.h"
#include "core/rig/rig.h"
#include "core/transport/evaluator.h"

namespace luxrig::sim {

inline constexpr Duration kTick = std::chrono::milliseconds(10);

struct Deviations {
  std::uint64_t seed = 1;
  double output_min = 0.80, output_max = 1.05;  ///< true over rated flux
  double curve_exponent_spread = 0.08;          ///< true curve = nominal^(1 ± spread)
  double position_error_m = 0.01;               ///< standard deviation per axis
  double angle_error_rad = 0.003;               ///< standard deviation per axis
  double meter_gain_share = 0.25;               ///< gain error, as a share of the meter's stated tolerance
  double meter_noise = 0.003;                   ///< standard deviation, fraction of reading
  double meter_lag_s = 0.15;                    ///< first-order
  double lamp_lag_s = 0.05;                     ///< first-order

  /// A world that is exactly as the rig file says: no spread, noise or lag.
  [[nodiscard]] static Deviations none();
};

/// What one fixture truly is.
struct FixtureTruth {
  double output = 1;  ///< true over rated flux
  double curve_exponent = 1;
  Pose world_from_mount;
};

struct PointTruth {
  double lux = 0;
  double max_lux_seen = 0;  ///< largest at any step since the start (or the last reset_peaks)
};

/// One stretch of time in which a point's true lux was above its limit.
struct Violation {
  std::size_t point = 0;
  double max_lx = 0;  ///< the limit
  double lux = 0;     ///< most during that stretch
  Time began{};
};

/// What a moving head gives each receiver at rated flux, for any joints. world.cpp asks at every tick of a movement.
class HeadLight {
 public:
  virtual ~HeadLight() = default;
  /// Writes the column of T for `fixture` (which moves) looking at `joints`. Rows as in World::make.
  virtual void column(std::size_t fixture, const Joints& joints, Eigen::Ref<Eigen::VectorXd> lux) const = 0;
};

class World {
 public:
  /// Loads the scene and computes the true transport with the true poses (seconds). `max_error`: of that transport.
  /// Luminaires and daylight are made as for the planner (core/tasks/rig_transport.h).
  static Result<std::unique_ptr<World>> make(const Rig& rig, const Deviations& deviations, double max_error,
                                             const Watch& watch = {});

  /// The same from a transport that is given: `lux_per_level` has a row per point of the rig, then one per luxmeter,
  /// and a column per fixture, at rated flux. Without `heads`, turning a head changes no light.
  /// fixed_lx   light that is there whatever the fixtures do (daylight), per row; empty = none
  /// Cause::invalid when the shape does not fit or an entry is negative or not finite.
  static Result<std::unique_ptr<World>> make(const Rig& rig, const Deviations& deviations,
                                             const Eigen::MatrixXd& lux_per_level,
                                             std::unique_ptr<const HeadLight> heads = nullptr,
                                             const Eigen::VectorXd& fixed_lx = {});

  virtual ~World() = default;
  /// What the wires carry to the fixtures. Values out of range are clamped, as a device would.
  virtual void set_drive(std::size_t fixture, double drive) = 0;
  /// Its lamp has burnt out or has no power: dark, whatever drive is set.
  virtual void set_lamp_out(std::size_t fixture, bool out) = 0;
  virtual void set_aim_target(std::size_t fixture, const Joints& joints) = 0;
  /// Where a head is whose joints are simulated elsewhere (sim/devices/axis_mechanics.h), at the next tick; it does not
  /// turn by itself any more. Not clamped: end stops are the axis's own.
  virtual void set_joints(std::size_t fixture, const Joints& joints) = 0;
  /// Advances lamps, heads and meters to `now` in steps of 10 ms, recording peaks at every step. Never goes back.
  virtual void advance(Time now) = 0;
  /// The instant of the last tick.
  [[nodiscard]] virtual Time now() const = 0;
  /// What a meter shows at the world's present time (gain, noise, lag, quantisation and clipping included).
  [[nodiscard]] virtual double meter_reading_lx(std::size_t luxmeter) const = 0;
  /// When it took that reading; Time{} = it has taken none yet.
  [[nodiscard]] virtual Time meter_sampled_at(std::size_t luxmeter) const = 0;

  [[nodiscard]] virtual std::vector<PointTruth> points() const = 0;     ///< true lux at the rig's points
  [[nodiscard]] virtual std::vector<PointTruth> luxmeters() const = 0;  ///< true lux at the meters
  [[nodiscard]] virtual std::vector<double> levels() const = 0;         ///< true output over rated, per fixture
  [[nodiscard]] virtual std::vector<double> drives() const = 0;         ///< as set, clamped; 0 of a lamp that is out
  [[nodiscard]] virtual std::vector<Joints> joints() const = 0;         ///< where the heads are
  [[nodiscard]] virtual const std::vector<FixtureTruth>& fixtures() const = 0;
  [[nodiscard]] virtual const std::vector<double>& meter_gains() const = 0;
  /// In the order in which they began; the first thousand.
  [[nodiscard]] virtual const std::vector<Violation>& violations() const = 0;
  /// Forgets peaks and violations.
  virtual void reset_peaks() = 0;
};

/// What the seed makes of each fixture.
[[nodiscard]] std::vector<FixtureTruth> draw_fixtures(const Rig& rig, const Deviations& deviations);

}  // namespace luxrig::sim
