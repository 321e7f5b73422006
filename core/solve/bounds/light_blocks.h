#pragma once
/// Groups of points that the same lights reach, found from a matrix alone: for light, the rooms of a flat.
///
/// The similarity of two points is the number of lights that reach both, divided by the number that reach either. The
/// most similar blocks are joined (average linkage) until none are as similar as `min_similarity`. Blocks of less
/// than a fiftieth of the points join the most similar block, unless they share no light with any.

#include <cstdint>
#include <span>
#include <vector>

#include "core/solve/least_squares/columns_view.h"

namespace luxrig {

inline constexpr std::uint32_t kNoBlock = 0xffffffff;

struct LightBlocks {
  std::vector<std::uint32_t> of_row;    ///< kNoBlock = no light reaches it
  std::vector<std::uint32_t> of_light;  ///< the block with most of its squared light; kNoBlock = none
  std::size_t count = 0;
};

/// light_of_column   below `lights`; emitters of one light share a number
/// row_weight        ≥ 0, one per row; no light reaches a row of weight 0
[[nodiscard]] LightBlocks light_blocks(const ColumnsView& columns, const Eigen::VectorXd& row_weight,
                                       std::span<const std::uint32_t> light_of_column, std::size_t lights,
                                       double min_similarity);

}  // namespace luxrig
