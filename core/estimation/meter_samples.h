#pragma once
/// The latest readings of each luxmeter, and a value fit for use: the median of several taken since the light became
/// steady. A median, so that one garbled reading among four does not count.

#include <optional>
#include <vector>

#include "core/output/devices.h"

namespace luxrig {

class MeterSamples {
 public:
  /// Readings per sample. With four, six meters with 0.3 % noise at 10 Hz take 0.4 s for a sample.
  static constexpr std::size_t kReadings = 4;

  explicit MeterSamples(std::size_t luxmeters);

  /// Returns false and changes nothing if the index does not exist, lux is negative or not finite, or the reading was
  /// taken in the future or not after the meter's previous one.
  bool add(Time now, const LuxReading& reading);

  /// The light changes: drops all samples. From now on, only readings taken at or after `settled` count.
  void restart(Time settled);

  /// Starts the next sample of every meter, under the same light.
  void next();

  /// Whether the meter has a sample: kReadings that agree to 3 %, or to 1 % if they only rise or only fall, since lamp
  /// and meter are then still settling. Readings that do not agree count after two seconds (a flickering light is
  /// measured as it is). Readings that only rise or fall count after ten seconds (nothing takes that long to settle).
  [[nodiscard]] bool ready(Time now, std::size_t luxmeter) const;

  /// Median of the last kReadings since restart() or next(), with the time of the newest; nullopt with fewer than two.
  [[nodiscard]] std::optional<LuxReading> sample(std::size_t luxmeter) const;

  /// The last reading that add() accepted, under any light.
  [[nodiscard]] const std::optional<LuxReading>& last(std::size_t luxmeter) const { return meters_[luxmeter].last; }

 private:
  struct Meter {
    std::optional<LuxReading> last;
    std::vector<LuxReading> window;  ///< oldest first, at most kReadings
    Time full_since{};
  };
  std::vector<Meter> meters_;
  Time settled_{};
};

}  // namespace luxrig
