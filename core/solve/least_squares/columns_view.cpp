#include "core/solve/least_squares/columns_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/check.h"

namespace luxrig {
namespace {

using Index = Eigen::Index;

/// Eight doubles, in as many registers as the processor needs.
using Eight [[gnu::vector_size(64)]] = double;

/// Entries of one column, in any storage type.
template <class Value>
struct SparseEntries {
  const std::uint32_t* rows;
  const Value* values;
  std::size_t count;
  [[nodiscard]] std::size_t row(std::size_t k) const { return rows[k]; }
  [[nodiscard]] double value(std::size_t k) const { return static_cast<double>(values[k]); }
};
struct DenseEntries {
  const double* values;
  std::size_t count;
  [[nodiscard]] static std::size_t row(std::size_t k) { return k; }
  [[nodiscard]] double value(std::size_t k) const { return values[k]; }
};

/// Four parallel sums: a single one would wait for its own latency.
template <class Entries>
[[gnu::always_inline]] inline double dot_of(const Entries& a, const double* vector) {
  double sum[4] = {0, 0, 0, 0};
  std::size_t k = 0;
  for (; k + 4 <= a.count; k += 4)
    for (std::size_t i = 0; i < 4; ++i) sum[i] += a.value(k + i) * vector[a.row(k + i)];
  for (; k < a.count; ++k) sum[0] += a.value(k) * vector[a.row(k)];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

template <class Entries>
[[gnu::always_inline]] inline void tile_of(const Entries& a, const double* tile, double* result) {
  Eight even{}, odd{}, one, other;
  std::size_t k = 0;
  for (; k + 2 <= a.count; k += 2) {
    std::memcpy(&one, tile + a.row(k) * ColumnsView::kTile, sizeof one);
    std::memcpy(&other, tile + a.row(k + 1) * ColumnsView::kTile, sizeof other);
    even += one * a.value(k);
    odd += other * a.value(k + 1);
  }
  if (k < a.count) {
    std::memcpy(&one, tile + a.row(k) * ColumnsView::kTile, sizeof one);
    even += one * a.value(k);
  }
  even += odd;
  std::memcpy(result, &even, sizeof even);
}

/// Without a branch per entry, since nearly all are sound.
template <class Entries>
bool is_sound(const Entries& a, std::size_t rows) {
  bool sound = a.count == 0 || a.row(a.count - 1) < rows;
  for (std::size_t k = 1; k < a.count; ++k) sound &= a.row(k - 1) < a.row(k);
  for (std::size_t k = 0; k < a.count; ++k) sound &= std::abs(a.value(k)) <= ColumnsView::kLargestEntry;
  return sound;
}

template <class Of>
[[gnu::always_inline]] inline void dots(Index columns, const Of& of, const double* vector, const double* scale,
                                        double* result) {
  for (Index j = 0; j < columns; ++j) result[j] = scale[j] == 0 ? 0 : scale[j] * dot_of(of(j), vector);
}
template <class Of>
[[gnu::always_inline]] inline void tiles(std::span<const Index> columns, const Of& of, const double* tile,
                                         double* result) {
  for (std::size_t k = 0; k < columns.size(); ++k) tile_of(of(columns[k]), tile, result + ColumnsView::kTile * k);
}

template <class Of>
void dots_plain(Index columns, const Of& of, const double* vector, const double* scale, double* result) {
  dots(columns, of, vector, scale, result);
}
template <class Of>
void tiles_plain(std::span<const Index> columns, const Of& of, const double* tile, double* result) {
  tiles(columns, of, tile, result);
}
#if defined(__x86_64__)
template <class Of>
[[gnu::target("avx2,fma")]] void dots_avx2(Index columns, const Of& of, const double* vector, const double* scale,
                                           double* result) {
  dots(columns, of, vector, scale, result);
}
template <class Of>
[[gnu::target("avx2,fma")]] void tiles_avx2(std::span<const Index> columns, const Of& of, const double* tile,
                                            double* result) {
  tiles(columns, of, tile, result);
}
bool wide() {
  static const bool has = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return has;
}
#endif

template <class Value>
auto sparse_of(std::span<const std::uint64_t> begin, std::span<const std::uint32_t> row, std::span<const Value> value) {
  return [begin = begin.data(), row = row.data(), value = value.data()](Index j) {
    const auto first = static_cast<std::size_t>(begin[j]);
    return SparseEntries<Value>{row + first, value + first, static_cast<std::size_t>(begin[j + 1]) - first};
  };
}
auto dense_of(const double* values, Index rows) {
  return [values, rows](Index j) { return DenseEntries{values + j * rows, static_cast<std::size_t>(rows)}; };
}

}  // namespace

/// Runs its argument with `of`, which returns a column's entries in their own type.
#define LUXRIG_WITH_COLUMNS(...)                         \
  do {                                                   \
    if (dense_ != nullptr) {                             \
      const auto of = dense_of(dense_, rows_);           \
      __VA_ARGS__;                                       \
    } else if (!doubles_.empty()) {                      \
      const auto of = sparse_of(begin_, row_, doubles_); \
      __VA_ARGS__;                                       \
    } else {                                             \
      const auto of = sparse_of(begin_, row_, floats_);  \
      __VA_ARGS__;                                       \
    }                                                    \
  } while (false)

ColumnsView::ColumnsView(Index rows, std::span<const std::uint64_t> begin, std::span<const std::uint32_t> row,
                         std::span<const float> value)
    : rows_(rows), columns_(static_cast<Index>(begin.size()) - 1), begin_(begin), row_(row), floats_(value) {}

ColumnsView::ColumnsView(Index rows, std::span<const std::uint64_t> begin, std::span<const std::uint32_t> row,
                         std::span<const double> value)
    : rows_(rows), columns_(static_cast<Index>(begin.size()) - 1), begin_(begin), row_(row), doubles_(value) {}

ColumnsView::ColumnsView(const Eigen::MatrixXd& dense)
    : rows_(dense.rows()), columns_(dense.cols()), dense_(dense.data()) {
  static const double kNothing = 0;
  if (dense_ == nullptr) dense_ = &kNothing;  // it has no entries
}

std::string ColumnsView::complaint() const {
  if (rows_ < 0 || columns_ < 0) return fmt::format("{} rows, {} columns", rows_, columns_);
  if (dense_ == nullptr && !begin_.empty()) {
    if (row_.size() != std::max(floats_.size(), doubles_.size()))
      return fmt::format("{} rows for {} entries", row_.size(), std::max(floats_.size(), doubles_.size()));
    if (begin_.front() != 0 || begin_.back() != row_.size() || !std::is_sorted(begin_.begin(), begin_.end()))
      return "begin must rise from 0 to the number of entries";
  }
  std::string text;
  LUXRIG_WITH_COLUMNS(for (Index j = 0; j < columns_ && text.empty(); ++j) {
    const auto a = of(j);
    if (is_sound(a, static_cast<std::size_t>(rows_))) continue;
    std::size_t next = 0;
    for (std::size_t k = 0; k < a.count && text.empty(); ++k) {
      const std::size_t row = a.row(k);
      if (row < next || row >= static_cast<std::size_t>(rows_))
        text = fmt::format("column {}: row {} is out of range or order", j, row);
      else if (!(std::abs(a.value(k)) <= kLargestEntry))
        text = fmt::format("entry ({}, {}) is {}", row, j, a.value(k));
      next = row + 1;
    }
  });
  return text;
}

double ColumnsView::dot(Index column, const double* vector) const {
  LUXRIG_WITH_COLUMNS(return dot_of(of(column), vector));
}

void ColumnsView::add(Index column, double times, double* to) const {
  LUXRIG_WITH_COLUMNS(const auto a = of(column);
                      for (std::size_t k = 0; k < a.count; ++k) to[a.row(k)] += times * a.value(k));
}

void ColumnsView::add(Index column, long double times, long double* to) const {
  LUXRIG_WITH_COLUMNS(const auto a = of(column); for (std::size_t k = 0; k < a.count; ++k) to[a.row(k)] +=
                                                 times * static_cast<long double>(a.value(k)));
}

void ColumnsView::clear(Index column, double* to) const {
  LUXRIG_WITH_COLUMNS(const auto a = of(column); for (std::size_t k = 0; k < a.count; ++k) to[a.row(k)] = 0);
}

void ColumnsView::entries(Index column, std::vector<std::uint32_t>& rows, std::vector<double>& values) const {
  rows.clear();
  values.clear();
  LUXRIG_WITH_COLUMNS(const auto a = of(column); for (std::size_t k = 0; k < a.count; ++k) if (a.value(k) != 0) {
    rows.push_back(static_cast<std::uint32_t>(a.row(k)));
    values.push_back(a.value(k));
  });
}

double ColumnsView::squared_norm(Index column, const double* weight) const {
  double sum = 0;
  LUXRIG_WITH_COLUMNS(const auto a = of(column);
                      for (std::size_t k = 0; k < a.count; ++k) sum += weight[a.row(k)] * (a.value(k) * a.value(k)));
  return sum;
}

void ColumnsView::dot_all(const double* vector, const double* scale, double* result) const {
#if defined(__x86_64__)
  if (wide()) {
    LUXRIG_WITH_COLUMNS(return dots_avx2(columns_, of, vector, scale, result));
  }
#endif
  LUXRIG_WITH_COLUMNS(dots_plain(columns_, of, vector, scale, result));
}

void ColumnsView::dot_tile(std::span<const Index> columns, const double* tile, double* result) const {
#if defined(__x86_64__)
  if (wide()) {
    LUXRIG_WITH_COLUMNS(return tiles_avx2(columns, of, tile, result));
  }
#endif
  LUXRIG_WITH_COLUMNS(tiles_plain(columns, of, tile, result));
}

}  // namespace luxrig
