#pragma once
/// Timing accuracy of a fixed-rate cycle: written by the cycle's thread, read by any thread, without locks.

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <cstdlib>

#include "core/time.h"

namespace luxrig {

class CycleStatistics {
 public:
  explicit CycleStatistics(Duration period) : period_(period) {}

  /// interval: between the starts of two successive cycles.
  void record(Duration interval) {
    const auto deviation_us = std::abs((interval - period_).count()) / 1000;
    slots_[slot_of(static_cast<std::uint64_t>(deviation_us))].fetch_add(1, std::memory_order_relaxed);
    count_.fetch_add(1, std::memory_order_relaxed);
    if (deviation_us > max_us_.load(std::memory_order_relaxed)) max_us_.store(deviation_us, std::memory_order_relaxed);
  }

  [[nodiscard]] std::uint64_t count() const { return count_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::int64_t max_us() const { return max_us_.load(std::memory_order_relaxed); }
  /// Quantile of |interval − period| [µs]: the given share of intervals stays within it. Resolution 10 µs up to 2.56
  /// ms, 1 % above that, up to half a day.
  [[nodiscard]] std::int64_t quantile_us(double share) const {
    const auto wanted = share * static_cast<double>(count());
    double seen = 0;
    for (std::size_t i = 0; i < kSlots; ++i) {
      seen += static_cast<double>(slots_[i].load(std::memory_order_relaxed));
      if (seen >= wanted && seen > 0) return end_of_slot_us(i);
    }
    return 0;
  }
  [[nodiscard]] Duration period() const { return period_; }

  struct Copy {
    std::uint64_t count = 0;
    std::int64_t p50_us = 0, p99_us = 0, max_us = 0;
  };
  [[nodiscard]] Copy copy() const { return {count(), quantile_us(0.5), quantile_us(0.99), max_us()}; }

 private:
  // Slots of equal width, then kPerDoubling slots for each doubling: each step is 1/128 of the doubling's start.
  static constexpr std::uint64_t kSlotUs = 10, kEven = 256, kPerDoubling = kEven / 2;
  static constexpr int kDoublings = 24;  ///< half a day
  static constexpr std::size_t kSlots = kEven + kDoublings * kPerDoubling;

  static std::size_t slot_of(std::uint64_t deviation_us) {
    const std::uint64_t steps = deviation_us / kSlotUs;
    if (steps < kEven) return steps;
    const auto doublings = static_cast<std::uint64_t>(std::bit_width(steps / kEven));
    return std::min<std::size_t>(kEven + (doublings - 1) * kPerDoubling + (steps >> doublings) - kPerDoubling,
                                 kSlots - 1);
  }
  static std::int64_t end_of_slot_us(std::size_t slot) {
    if (slot < kEven) return static_cast<std::int64_t>((slot + 1) * kSlotUs);
    const std::size_t doublings = (slot - kEven) / kPerDoubling + 1;
    return static_cast<std::int64_t>((((slot - kEven) % kPerDoubling + kPerDoubling + 1) << doublings) * kSlotUs);
  }

  Duration period_;
  std::array<std::atomic<std::uint32_t>, kSlots> slots_{};
  std::atomic<std::uint64_t> count_{0};
  std::atomic<std::int64_t> max_us_{0};
};

}  // namespace luxrig
