#pragma once
/// A simulated rig on a stepped clock that is told levels and asked for readings, as luxrig calibrate does it of a daemon.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/calibration/meter_run.h"
#include "core/calibration/meter_timing.h"
#include "sim/world/world.h"

namespace luxrig {

class SteppedRig {
 public:
  /// Both outlive it.
  SteppedRig(sim::World& world, const Rig& rig) : world_(world), rig_(rig), now_(world.now()) {}

  /// Readings of all luxmeters under one light after the other (levels of all fixtures); per light. together: levels of
  /// all lamps at once, by which it learns before its first light how late each meter is.
  std::vector<std::vector<std::optional<SteadyReading>>> read(std::span<const std::vector<double>> plan,
                                                              std::span<const double> together);
  /// The whole of a run.
  void measure(MeterRun& run, std::span<const double> together);
  /// True light at the points.
  Eigen::VectorXd truth_lx(std::span<const double> level);
  /// True output of all fixtures over rated.
  std::vector<double> outputs(std::span<const double> level);
  [[nodiscard]] double seconds() const { return to_seconds(now_.time_since_epoch()); }

 private:
  void pass(double seconds);
  void send(std::span<const double> level);
  void set(std::span<const double> level);
  /// Samples all meters meanwhile.
  void watch(double duration_s);
  std::vector<std::optional<MeterTiming>> learn_timing(std::span<const double> together);

  sim::World& world_;
  const Rig& rig_;
  Time now_;
  std::vector<std::vector<TimedLux>> samples_{rig_.luxmeters.size()};  ///< per luxmeter
  std::vector<std::optional<MeterTiming>> timing_;                     ///< learnt at the first reading
};

}  // namespace luxrig
