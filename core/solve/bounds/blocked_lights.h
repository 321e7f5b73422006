#pragma once
/// The lights of a placement problem, cut into blocks of rows that share few lights. Internal to error_bound.

#include <memory>
#include <span>
#include <vector>

#include "core/solve/bounds/block_bound.h"
#include "core/solve/bounds/error_bound.h"
#include "core/solve/bounds/light_blocks.h"

namespace luxrig {

/// W A with columns of norm 1, W b with norm 1, and the lights by block.
struct BlockedLights {
  /// The part of one column in one block.
  struct Piece {
    std::uint32_t block = 0;
    std::vector<std::uint32_t> row;  ///< of the block
    std::vector<double> value;
  };
  struct Column {
    std::vector<Piece> pieces;
    double most = 0;  ///< level that no useful solution exceeds
    std::uint32_t number = 0;
  };
  LightBlocks blocks;
  Eigen::VectorXd goal;
  std::vector<std::vector<Column>> of_light;  ///< without zero columns
  std::vector<std::uint32_t> light_of;        ///< of each column
  std::vector<std::vector<Eigen::Index>> rows_of_block;
  std::vector<std::uint32_t> row_in_block;
  double dark = 0;  ///< squared error of rows that no light reaches

  /// `of` must have no complaint(); goal_norm = ‖W b‖ > 0.
  BlockedLights(const BoundProblem& of, double goal_norm, double min_similarity);
  /// One bound per block. Light that spills from one block into another has these prices; any prices are valid.
  [[nodiscard]] std::vector<std::unique_ptr<BlockBound>> priced(const Eigen::VectorXd& price_of_row,
                                                                std::size_t max_lights, int threads) const;

 private:
  [[nodiscard]] Column cut(std::span<const std::uint32_t> rows, std::span<const double> values) const;
  [[nodiscard]] double price(const Piece& piece, const Eigen::VectorXd& price_of_row) const;
};

}  // namespace luxrig
