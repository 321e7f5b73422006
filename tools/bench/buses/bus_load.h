#pragma once
/// Further columns of the rows of bus traffic, and what the traffic costs the process.

#include <cstdint>
#include <optional>
#include <string>

#include "tools/bench/bench_row.h"
#include "tools/bench/buses/frame_intervals.h"

namespace luxrig {

/// Deviation of intervals from their period [s].
struct IntervalJitter {
  double p50_s = 0, p99_s = 0, p999_s = 0, worst_s = 0;
};
[[nodiscard]] IntervalJitter jitter_of(const TimeCounts& deviations);

struct BusLoad {
  std::optional<double> core_share;  ///< of one core
  std::optional<IntervalJitter> jitter;
  std::optional<std::uint64_t> lost;         ///< frames or packets sent but not received
  std::optional<std::int64_t> growth_bytes;  ///< growth of resident memory after the start
  std::string note;                          ///< without commas
};

/// The same columns on each row, empty without a value.
void add_columns(BenchRow& row, const BusLoad& load);

[[nodiscard]] std::int64_t resident_bytes();
/// Whether memory of `before_bytes` that grew by this much is not flat: by more than 256 KiB and 1 %.
[[nodiscard]] constexpr bool memory_grows(std::int64_t before_bytes, std::int64_t growth_bytes) {
  return growth_bytes > 256 * 1024 && growth_bytes > before_bytes / 100;
}
/// Processor time of the whole process, and of the calling thread [s].
[[nodiscard]] double process_cpu_s();
[[nodiscard]] double thread_cpu_s();

}  // namespace luxrig
