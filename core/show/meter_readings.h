#pragma once
/// The readings of each luxmeter that the show uses: the last one, the last one while it was not lost, and its samples
/// under steady light.

#include <optional>
#include <span>
#include <vector>

#include "core/estimation/meter_samples.h"
#include "core/output/devices.h"

namespace luxrig {

class MeterReadings {
 public:
  using PerLuxmeter = std::vector<std::optional<LuxReading>>;

  explicit MeterReadings(std::size_t luxmeters)
      : samples_(luxmeters),
        heard_(luxmeters),
        believed_(luxmeters),
        measured_(luxmeters),
        sampled_lx_(luxmeters),
        changed_(luxmeters, false) {}

  /// Returns false and changes nothing for a reading that MeterSamples refuses.
  /// lost   its luxmeter is not believed
  bool hear(Time now, const LuxReading& reading, bool lost);

  /// The light changes: only readings from then on make a sample.
  void restart(Time settled) { samples_.restart(settled); }
  [[nodiscard]] bool has_sample(Time now, std::size_t luxmeter) const { return samples_.ready(now, luxmeter); }
  [[nodiscard]] LuxReading sample(std::size_t luxmeter) const { return *samples_.sample(luxmeter); }
  /// These are one sample of the light at `now`; the next one begins.
  void take(Time now, std::span<const LuxReading> sample);
  void believe(const LuxReading& sample) { measured_[sample.luxmeter] = sample; }
  void disbelieve(std::size_t luxmeter) { measured_[luxmeter].reset(); }
  void disbelieve_all() { measured_.assign(measured_.size(), std::nullopt); }
  /// Drops all its readings.
  void forget(std::size_t luxmeter);

  [[nodiscard]] const PerLuxmeter& heard() const { return heard_; }        ///< the last one, believed or not
  [[nodiscard]] const PerLuxmeter& believed() const { return believed_; }  ///< the last one while it was not lost
  [[nodiscard]] const PerLuxmeter& measured() const { return measured_; }  ///< the last believed sample
  /// Whether its last sample, believed or not, differed from the one before.
  [[nodiscard]] bool changed(std::size_t luxmeter) const { return changed_[luxmeter]; }
  [[nodiscard]] Time sampled_at() const { return sampled_at_; }  ///< of the last sample

 private:
  MeterSamples samples_;
  PerLuxmeter heard_, believed_, measured_;
  std::vector<std::optional<double>> sampled_lx_;  ///< last sample, believed or not
  std::vector<bool> changed_;
  Time sampled_at_{};
};

}  // namespace luxrig
