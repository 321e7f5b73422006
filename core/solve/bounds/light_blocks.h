#pragma once
/// Points that the same lights reach, found from a matrix alone: the rooms of a flat, as far as light knows them.
///
/// Similarity of two points is the share of lights that reach both among those that reach either; the most similar
/// blocks are joined, by average linkage, until none are as similar as `least_similarity`. Blocks of less than a
/// fiftieth of the points go to the one that is most like them, unless they share no light with any.

#include <cstdint>
#include <span>
#include <vector>

#include "core/solve/least_squares/columns_view.h"

namespace luxrig {

inline constexpr std::uint32_t kNoBlock = 0xffffffff;

struct LightBlocks {
  std::vector<std::uint32_t> of_row;    ///< kNoBlock: no light reaches it
  std::vector<std::uint32_t> of_light;  ///< where most of its squared light falls; kNoBlock: it reaches nothing
  std::size_t count = 0;
};

/// light_of_column: columns that are emitters of one light have the same number, below `lights`.
/// row_weight ≥ 0, as many as rows; a row of weight 0 is reached by nothing.
[[nodiscard]] LightBlocks light_blocks(const ColumnsView& columns, const Eigen::VectorXd& row_weight,
                                       std::span<const std::uint32_t> light_of_column, std::size_t lights,
                                       double least_similarity);

}  // namespace luxrig
