#pragma once
/// The latest readings of each luxmeter, and a value that can be acted on: the median of several taken since the light
/// stands still. The median, since one garbled reading among four must not count.

#include <optional>
#include <vector>

#include "core/output/devices.h"

namespace luxrig {

class MeterSamples {
 public:
  /// Readings that make one sample. Four: of six meters with 0.3 % noise at 10 Hz, a sample takes 0.4 s.
  static constexpr std::size_t kReadings = 4;

  explicit MeterSamples(std::size_t luxmeters);

  /// False, and nothing changes: an index that does not exist, lux that is not finite or negative, taken in the
  /// future, or not after the meter's reading before.
  bool add(Time now, const LuxReading& reading);

  /// The light changes: forgets all samples; only readings taken at or after `settled` count from now on.
  void restart(Time settled);

  /// Starts the next sample of every meter, under the same light.
  void next();

  /// The meter has kReadings that agree to 3 %, and to 1 % where each is above, or each below, the one before: lamp and
  /// meter still settle then. Or it has had them for two seconds and they will not agree (a flickering light is
  /// measured as it is), or they go one way for ten seconds (nothing settles for so long).
  [[nodiscard]] bool ready(Time now, std::size_t luxmeter) const;

  /// Median of the last kReadings since restart() or next(), with the time of the newest; nothing with fewer than two.
  [[nodiscard]] std::optional<LuxReading> sample(std::size_t luxmeter) const;

  /// The last reading that add() took, under whatever light.
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
