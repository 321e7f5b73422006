#pragma once
/// The truth that a rig file only approximates: one seeded world behind every simulated device.
///
/// Deviations, drawn once from the seed: lamp output −20…+5 % per fixture, dimmer curve exponent off nominal,
/// mount pose errors (centimetres, tenths of a degree), meter gain error within its tolerance, noise, lag,
/// quantisation. Light follows drive with the lamp's lag; heads move at their speeds. Everything is a function of the
/// seed and of what was written when: the same writes at the same times give the same readings.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/control/devices.h"
#include "core/rig/rig.h"
#include "core/transport/evaluator.h"

namespace luxrig::sim {

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

class World {
 public:
  /// Loads the scene and computes the true transport with the true poses (seconds). `max_error`: of that transport.
  static Result<std::unique_ptr<World>> make(const Rig& rig, const Deviations& deviations, double max_error);

  virtual ~World() = default;
  /// What the wires carry to the fixtures. Values out of range are clamped, as a device would.
  virtual void set_drive(std::size_t fixture, double drive) = 0;
  virtual void set_aim_target(std::size_t fixture, const PanTilt& joints) = 0;
  /// Advances lamps, heads and meters to `now` in steps of at most 10 ms, recording peaks at every step.
  virtual void advance(Time now) = 0;
  /// What a meter shows at the world's present time (gain, noise, lag, quantisation and clipping included).
  [[nodiscard]] virtual double meter_reading_lx(std::size_t luxmeter) const = 0;

  [[nodiscard]] virtual std::vector<PointTruth> points() const = 0;     ///< true lux at the rig's points
  [[nodiscard]] virtual std::vector<PointTruth> luxmeters() const = 0;  ///< true lux at the meters
  [[nodiscard]] virtual std::vector<double> levels() const = 0;         ///< true output over rated, per fixture
  [[nodiscard]] virtual const std::vector<FixtureTruth>& fixtures() const = 0;
  virtual void reset_peaks() = 0;
};

}  // namespace luxrig::sim
