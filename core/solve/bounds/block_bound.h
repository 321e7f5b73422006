#pragma once
/// Certified lower bound on the squared error of one block of rows with at most c lights of its own. More work improves
/// it. Internal to error_bound.
///
///   f(c) = min ‖A x + F s − b‖² − 2 pᵀx + 2 qᵀs    x, s ≥ 0; at most c home lights of this block have x > 0
///
/// A: columns whose home is this block; p: the saving elsewhere per unit of level, at the prices there.
/// F: columns whose home is another block; any number of their lights may burn here, at the price q.
/// Columns have norm 1 over all rows of the problem.
///
/// Branch and bound over the positions of the c lights. A node names a cell for each light. Its relaxation lets any
/// number of lights burn in these cells (non-negative least squares); levels need no upper bound for that. The node's
/// bound is the one its dual point proves: the residual y of the best x found gives, for every x,
///   ‖A x + F s − b‖² ≥ 2 yᵀb − ‖y‖² − 2 yᵀ(A x + F s).
/// Columns for which rounding left aᵀy + p > 0 or aᵀy > q are charged at the largest level they can have.

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "core/solve/least_squares/nnls_of_few.h"

namespace luxrig {

/// Error bound of a sum over this many rows, relative to the sum of magnitudes, with a margin for later steps.
[[nodiscard]] inline double rounding_of_sums(Eigen::Index rows) {
  return 4 * static_cast<double>(rows + 16) * std::numeric_limits<double>::epsilon();
}

/// A light's columns in one block.
struct BlockLight {
  std::vector<std::vector<std::uint32_t>> row;  ///< by column; rows of the block, rising
  std::vector<std::vector<double>> value;       ///< of columns scaled to norm 1 over all rows
  std::vector<double> price;                    ///< by column: p at home, otherwise q
  std::vector<double> most;                     ///< by column: level that no useful solution exceeds
  std::vector<std::uint32_t> column;            ///< by column: the caller's number for it
};

/// A column that burns in a relaxation.
struct BurningColumn {
  std::uint32_t column = 0;
  double level = 0;
  bool home = false;
};

class BlockBound {
 public:
  /// max_foreign   lights that may burn elsewhere
  /// rounding       error of a product with a column, for |y| = 1 and a price of 1
  BlockBound(const Eigen::VectorXd& goal, std::vector<BlockLight> home, const std::vector<BlockLight>& foreign,
             std::size_t max_foreign, double rounding);

  [[nodiscard]] std::size_t lights() const { return home_; }
  /// Lower bound on f(count).
  [[nodiscard]] double value(std::size_t count);
  /// Splits up to `nodes` of the worst nodes of f(count). False when f(count) cannot improve further.
  bool refine(std::size_t count, std::size_t nodes);
  /// Columns that burn at the least f(count) known so far.
  [[nodiscard]] std::vector<BurningColumn> burning(std::size_t count);
  [[nodiscard]] std::size_t nodes() const { return evaluated_; }

 private:
  struct Cell {
    std::uint32_t first, count;         ///< lights, in the order of the tree
    std::uint32_t left = 0, right = 0;  ///< 0 = a single light
  };
  struct Node {
    double bound = 0;
    bool closed = false;               ///< the relaxation needs no more lights than allowed
    std::vector<std::uint32_t> cells;  ///< one per light, rising
    std::vector<ColumnsView::Index> support;
    std::vector<double> level;  ///< of columns in the support
  };
  struct Tree {
    std::vector<Node> open;  ///< a heap, least bound first
    bool made = false;
  };

  void sort_into_cells(std::vector<BlockLight>& home);
  std::uint32_t cell_of(std::vector<std::uint32_t>& order, std::uint32_t first, std::uint32_t count);
  void evaluate(Node& node, std::span<const ColumnsView::Index> start);
  [[nodiscard]] double proven(const Node& node, const Eigen::VectorXd& residual);
  [[nodiscard]] bool is_integral(const Node& node) const;
  void split(const Node& node, Tree& tree);
  void push(Tree& tree, Node node);
  Tree& tree(std::size_t count);
  void products(std::size_t first_column, std::size_t columns, const Eigen::VectorXd& vector);
  [[nodiscard]] std::size_t first_column(const Cell& cell) const { return column_begin_[cell.first]; }
  [[nodiscard]] std::size_t end_column(const Cell& cell) const { return column_begin_[cell.first + cell.count]; }

  Eigen::VectorXd goal_;  ///< without the price row
  std::size_t home_ = 0, home_columns_ = 0, max_foreign_ = 0;
  double rounding_ = 0, price_goal_ = 0, price_norm_ = 0;
  std::vector<std::uint64_t> begin_ = {0};
  std::vector<std::uint32_t> row_;
  std::vector<double> value_;
  std::vector<double> inverse_norm_, max_;
  std::vector<std::uint32_t> number_;        ///< the caller's number of each column
  std::vector<std::uint32_t> column_begin_;  ///< of each light, home lights first
  std::vector<Cell> cells_ = {Cell{0, 0}};   ///< the first is a placeholder
  std::vector<Tree> trees_;                  ///< by count
  std::unique_ptr<NnlsOfFew> few_;
  Node anywhere_;                  ///< first node of every tree except the tree of no lights
  Eigen::VectorXd root_residual_;  ///< of that node
  Eigen::VectorXd product_;
  std::size_t evaluated_ = 0;
  std::uint32_t root_ = 0;
};

}  // namespace luxrig
