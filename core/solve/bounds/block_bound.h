#pragma once
/// Least squared error of one block of rows with at most so many lights of its own: a certified lower bound that gets
/// better with work. Internal to error_bound.
///
///   f(c) = min ‖A x + F s − b‖² − 2 pᵀx + 2 qᵀs    x, s ≥ 0; at most c lights that are at home here have
///                                                  x > 0
///
/// A: columns at home here; F: columns at home elsewhere, which any number of lights may burn in at the price q; p:
/// what a level at home saves elsewhere at the prices there. Columns have norm 1 over all rows of the problem.
///
/// Branch and bound over where the c lights are: a node says for each light in which cell it is, and its bound lets any
/// number of lights burn in these cells (non-negative least squares). No level needs a bound for that. A node is worth
/// what its dual point proves, whatever that is: the residual y of the best x found gives, for every x,
///   ‖A x + F s − b‖² ≥ 2 yᵀb − ‖y‖² − 2 yᵀ(A x + F s),
/// and columns for which rounding left aᵀy + p > 0 or aᵀy > q are charged at the largest level they can have.

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "core/solve/least_squares/nnls_of_few.h"

namespace luxrig {

/// How far off a sum over so many rows may be, relative to the sum of magnitudes; with room for what is done to it.
[[nodiscard]] inline double rounding_of_sums(Eigen::Index rows) {
  return 4 * static_cast<double>(rows + 16) * std::numeric_limits<double>::epsilon();
}

/// A light's columns in one block.
struct BlockLight {
  std::vector<std::vector<std::uint32_t>> row;  ///< by column; rows of the block, rising
  std::vector<std::vector<double>> value;       ///< of columns of norm 1 over all rows
  std::vector<double> price;                    ///< by column: p at home, q else
  std::vector<double> most;                     ///< by column: level that no solution worth considering exceeds
  std::vector<std::uint32_t> column;            ///< by column: its number, for the caller
};

/// A column that burns in a relaxation.
struct BurningColumn {
  std::uint32_t column = 0;
  double level = 0;
  bool home = false;
};

class BlockBound {
 public:
  /// most_foreign: lights that may burn elsewhere. rounding: how far off products of a column may be, for |y| = 1 and a
  /// price of 1.
  BlockBound(const Eigen::VectorXd& goal, std::vector<BlockLight> home, const std::vector<BlockLight>& foreign,
             std::size_t most_foreign, double rounding);

  [[nodiscard]] std::size_t lights() const { return home_; }
  /// No c lights have f(c) below this.
  [[nodiscard]] double value(std::size_t count);
  /// Looks into the worst nodes of f(count), so many of them. False when f(count) is as good as it gets.
  bool refine(std::size_t count, std::size_t nodes);
  /// What burns where f(count) is least, as far as that is known.
  [[nodiscard]] std::vector<BurningColumn> burning(std::size_t count);
  [[nodiscard]] std::size_t nodes() const { return evaluated_; }

 private:
  struct Cell {
    std::uint32_t first, count;         ///< lights, in the order of the tree
    std::uint32_t left = 0, right = 0;  ///< 0: a single light
  };
  struct Node {
    double bound = 0;
    bool closed = false;               ///< the relaxation needs no more lights than are allowed
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

  Eigen::VectorXd goal_;  ///< without the row of prices
  std::size_t home_ = 0, home_columns_ = 0, most_foreign_ = 0;
  double rounding_ = 0, price_goal_ = 0, price_norm_ = 0;
  std::vector<std::uint64_t> begin_ = {0};
  std::vector<std::uint32_t> row_;
  std::vector<double> value_;
  std::vector<double> inverse_norm_, most_;
  std::vector<std::uint32_t> number_;        ///< of each column, the caller's
  std::vector<std::uint32_t> column_begin_;  ///< of each light, home first
  std::vector<Cell> cells_ = {Cell{0, 0}};   ///< the first is nothing
  std::vector<Tree> trees_;                  ///< by count
  std::unique_ptr<NnlsOfFew> few_;
  Node anywhere_;                  ///< the node of all trees but that of no light to begin with
  Eigen::VectorXd root_residual_;  ///< of that node
  Eigen::VectorXd product_;
  std::size_t evaluated_ = 0;
  std::uint32_t root_ = 0;
};

}  // namespace luxrig
