#pragma once
/// Weighted sums of matrix rows: nearly all arithmetic of indirect light.

#include <cstdint>
#include <span>

namespace luxrig {

struct WeightedRow {
  std::uint32_t row;
  float weight;
};

/// Rows of matrices for add_weighted_rows() have a multiple of this many floats.
inline constexpr std::size_t kRowUnit = 16;

/// sums += Σ weight · rows[row], in the order of the list. Uses AVX2 and FMA if the processor has them.
/// rows     row-major, sums.size() floats each
void add_weighted_rows(const float* rows, std::span<const WeightedRow> list, std::span<float> sums);

}  // namespace luxrig
