#include "core/transport/candidates/reflected/weighted_rows.h"

#include <cstddef>

#include "core/check.h"

namespace luxrig {
namespace {

/// A strip of columns stays in registers while all rows pass.
template <std::size_t kStrip>
[[gnu::always_inline]] inline void add_strip(const float* rows, std::size_t stride, std::span<const WeightedRow> list,
                                             float* sums) {
  float kept[kStrip];
  for (std::size_t i = 0; i < kStrip; ++i) kept[i] = sums[i];
  for (const WeightedRow& entry : list) {
    const float* row = rows + entry.row * stride;
    for (std::size_t i = 0; i < kStrip; ++i) kept[i] += entry.weight * row[i];
  }
  for (std::size_t i = 0; i < kStrip; ++i) sums[i] = kept[i];
}

[[gnu::always_inline]] inline void add_strips(const float* rows, std::span<const WeightedRow> list,
                                              std::span<float> sums) {
  std::size_t from = 0;
  for (; from + 4 * kRowUnit <= sums.size(); from += 4 * kRowUnit)
    add_strip<4 * kRowUnit>(rows + from, sums.size(), list, sums.data() + from);
  for (; from < sums.size(); from += kRowUnit) add_strip<kRowUnit>(rows + from, sums.size(), list, sums.data() + from);
}

#if defined(__x86_64__)
[[gnu::target("avx2,fma")]] void add_strips_avx2(const float* rows, std::span<const WeightedRow> list,
                                                 std::span<float> sums) {
  add_strips(rows, list, sums);
}
#endif

}  // namespace

void add_weighted_rows(const float* rows, std::span<const WeightedRow> list, std::span<float> sums) {
  LUXRIG_CHECK(sums.size() % kRowUnit == 0, "{} columns", sums.size());
#if defined(__x86_64__)
  static const bool wide = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (wide) return add_strips_avx2(rows, list, sums);
#endif
  add_strips(rows, list, sums);
}

}  // namespace luxrig
