#pragma once
/// Sums of rows of a matrix: where nearly all arithmetic of indirect light is done.

#include <cstdint>
#include <span>

namespace luxrig {

struct WeightedRow {
  std::uint32_t row;
  float weight;
};

/// Rows of matrices for add_weighted_rows() have a multiple of this many floats.
inline constexpr std::size_t kRowUnit = 16;

/// sums += Σ weight · rows[row], in the order of the list. Uses AVX2 and FMA where the processor has them.
/// rows     row-major, sums.size() floats each
void add_weighted_rows(const float* rows, std::span<const WeightedRow> list, std::span<float> sums);

}  // namespace luxrig
