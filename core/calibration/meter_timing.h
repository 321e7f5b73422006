#pragma once
/// Luxmeters show a light some time after it is there. Once that time is known for each, the next light can be set before
/// the slowest has shown the last: a sample counts for the light that the meter shows then.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/calibration/lamp_steps.h"

namespace luxrig {

struct TimedLux {
  double at_s = 0, lux = 0;
};

struct MeterTiming {
  double delay_s = 0;    ///< it shows the old light for so long after a change has begun
  double settled_s = 0;  ///< and the new one so long after that has arrived
  double period_s = 0;   ///< between samples
};

/// From samples in ascending time. The light was dark and steady until `begun_s`, and has stood still since `arrived_s`.
/// none = no clear change, or the meter was still moving at the end.
[[nodiscard]] std::optional<MeterTiming> timing_of(std::span<const TimedLux> samples, double begun_s, double arrived_s);

/// How long a light stays, so that every meter with a timing yields kSteadySamples of it.
[[nodiscard]] double dwell_s(std::span<const std::optional<MeterTiming>> timing);

inline constexpr std::size_t kSteadySamples = 3;

/// Which samples belong to which light.
class ReadingLog {
 public:
  /// timing: per luxmeter; those without say nothing.
  explicit ReadingLog(std::vector<std::optional<MeterTiming>> timing);

  /// A light that stood still from `arrived_s`, until it was changed at `left_s`; later than those before (asserted).
  void light(double arrived_s, double left_s);
  /// In ascending time for each meter.
  void sample(std::size_t luxmeter, TimedLux sample) { samples_[luxmeter].push_back(sample); }

  /// When every meter has shown the last light to its end.
  [[nodiscard]] double whole_at_s() const;
  /// Per light, per luxmeter; none = fewer than kSteadySamples, not steady, samples held up on their way, or no timing. A meter's noise, as a share of the
  /// light, is taken to be alike in all its readings: a few samples alone do not tell it.
  [[nodiscard]] std::vector<std::vector<std::optional<SteadyReading>>> readings() const;

 private:
  struct Span {
    double arrived_s, left_s;
  };
  /// Its samples paused while this light was there.
  [[nodiscard]] bool held_up(std::size_t luxmeter, const Span& light) const;
  [[nodiscard]] std::vector<double> samples_of(std::size_t luxmeter, const Span& light) const;

  std::vector<std::optional<MeterTiming>> timing_;
  std::vector<Span> lights_;
  std::vector<std::vector<TimedLux>> samples_;  ///< per luxmeter
};

}  // namespace luxrig
