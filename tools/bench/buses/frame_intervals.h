#pragma once
/// Regularity of events. Counted in microseconds, so that a day takes no more memory than a second.

#include <array>
#include <cstdint>
#include <string>

namespace luxrig {

class TimeCounts {
 public:
  void add(double seconds);
  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// The time [s] within which `share` (0…1) of them stay, to a microsecond up to 100 ms; 0 without any.
  [[nodiscard]] double quantile(double share) const;
  [[nodiscard]] double largest() const { return largest_; }  ///< [s]
  /// A line for each step from 50 µs to 50 ms: count, percentage, bar.
  [[nodiscard]] std::string histogram() const;

 private:
  static constexpr std::size_t kMax_us = 100'000;
  std::array<std::uint32_t, kMax_us + 1> counts_{};  ///< [i]: more than i-1, at most i; the last has all longer ones
  std::uint64_t count_ = 0;
  double largest_ = 0;
};

}  // namespace luxrig
