#pragma once
/// The truth that a rig file only approximates: one seeded world behind every simulated device.
///
/// Deviations are drawn once from the seed: of lamps, dimmers, mounts, the room and meters (deviations.h).
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
#include "core/transport/evaluator.h"
#include "sim/world/deviations.h"

namespace luxrig::sim {

inline constexpr Duration kTick = std::chrono::milliseconds(10);

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
  /// fixtures   with which the light was computed; empty = as draw_fixtures() has them
  /// Cause::invalid if the shape does not fit or an entry is negative or not finite.
  static Result<std::unique_ptr<World>> make(const Rig& rig, const Deviations& deviations,
                                             const Eigen::MatrixXd& lux_per_level,
                                             std::unique_ptr<const HeadLight> heads = nullptr,
                                             const Eigen::VectorXd& fixed_lx = {}, const MeterResponse& response = {},
                                             std::vector<FixtureTruth> fixtures = {});

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
  /// To `now` in one stride, for hours in which nothing is sent and no head turns: lamps have warmed and aged as by
  /// advance(). Daylight, visits and peaks between are left out, and meters sample again after it. Never goes back.
  virtual void stride(Time now) = 0;
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

}  // namespace luxrig::sim
