#pragma once
/// The lights of a placement problem cut into blocks of rows that hardly share lights. Internal to error_bound.

#include <memory>
#include <span>
#include <vector>

#include "core/solve/bounds/block_bound.h"
#include "core/solve/bounds/error_bound.h"
#include "core/solve/bounds/light_blocks.h"

namespace luxrig {

/// All columns with norm 1 and a goal of norm 1, in W; lights in blocks.
struct BlockedLights {
  /// What one column does in one block.
  struct Piece {
    std::uint32_t block = 0;
    std::vector<std::uint32_t> row;  ///< of the block
    std::vector<double> value;
  };
  struct Column {
    std::vector<Piece> pieces;
    double most = 0;  ///< level that no solution worth considering exceeds
    std::uint32_t number = 0;
  };
  LightBlocks blocks;
  Eigen::VectorXd goal;
  std::vector<std::vector<Column>> of_light;  ///< without those that are zero
  std::vector<std::uint32_t> light_of;        ///< of each column
  std::vector<std::vector<Eigen::Index>> rows_of_block;
  std::vector<std::uint32_t> row_in_block;
  double dark = 0;  ///< squared error of what nothing reaches

  /// of must have no complaint(), goal_norm is ‖W b‖ > 0.
  BlockedLights(const BoundProblem& of, double goal_norm, double least_similarity);
  /// A bound for each block, with light that falls from one to another at these prices, which may be any.
  [[nodiscard]] std::vector<std::unique_ptr<BlockBound>> priced(const Eigen::VectorXd& price_of_row,
                                                                std::size_t most_lights, int threads) const;

 private:
  [[nodiscard]] Column cut(std::span<const std::uint32_t> rows, std::span<const double> values) const;
  [[nodiscard]] double price(const Piece& piece, const Eigen::VectorXd& price_of_row) const;
};

}  // namespace luxrig
