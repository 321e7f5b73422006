#pragma once
/// How well a fixed-rate cycle keeps its time: written by the cycle's thread, read by any, without locks.

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstdlib>

#include "core/time.h"

namespace luxrig {

class CycleStatistics {
 public:
  explicit CycleStatistics(Duration period) : period_(period) {}

  /// One interval between the starts of two cycles.
  void record(Duration interval) {
    const auto deviation = std::abs((interval - period_).count()) / 1000;
    const auto slot = std::min<std::int64_t>(deviation / kSlotUs, kSlots - 1);
    slots_[static_cast<std::size_t>(slot)].fetch_add(1, std::memory_order_relaxed);
    count_.fetch_add(1, std::memory_order_relaxed);
    if (deviation > max_us_.load(std::memory_order_relaxed)) max_us_.store(deviation, std::memory_order_relaxed);
  }

  [[nodiscard]] std::uint64_t count() const { return count_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::int64_t max_us() const { return max_us_.load(std::memory_order_relaxed); }
  /// |interval − period| [µs] that the given share of the intervals stays within, to 10 µs, up to 20 ms.
  [[nodiscard]] std::int64_t quantile_us(double share) const {
    const auto wanted = share * static_cast<double>(count());
    double seen = 0;
    for (std::size_t i = 0; i < kSlots; ++i) {
      seen += static_cast<double>(slots_[i].load(std::memory_order_relaxed));
      if (seen >= wanted && seen > 0) return (static_cast<std::int64_t>(i) + 1) * kSlotUs;
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
  static constexpr std::int64_t kSlotUs = 10;
  static constexpr std::size_t kSlots = 2000;
  Duration period_;
  std::array<std::atomic<std::uint32_t>, kSlots> slots_{};
  std::atomic<std::uint64_t> count_{0};
  std::atomic<std::int64_t> max_us_{0};
};

}  // namespace luxrig
