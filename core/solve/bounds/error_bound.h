#pragma once
/// How close lights at given candidates can come to a goal at all: certified lower bounds on
///
///   ‖W (A x − b)‖₂ / ‖W b‖₂   over x ≥ 0,
///
/// with any number of lights, and with at most k. So that a person knows when the goal, not the search, is the problem.
///
/// Every bound is proven by a dual point worked out from whatever x is at hand (weak duality): how good x is decides
/// how good the bound is, not whether it holds. Rounding is charged, so a bound is below the true optimum, by 1e-13 or
/// so.
///
/// At most k: the rows fall into blocks that hardly share lights (light_blocks.h), and light between blocks gets a
/// price per block, which makes them independent (Lagrangian decomposition; Guignard & Kim 1987). In each block the
/// least error with c lights of its own is bounded by branch and bound (block_bound.h), and the k lights are shared out
/// by dynamic programming. Any prices give a valid bound; good ones are the residuals of a good solution.

#include <Eigen/Core>
#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "core/run.h"
#include "core/solve/least_squares/columns_view.h"

namespace luxrig {

/// A, b and W. Entries of A are ≥ 0; a column whose norm in W A is below 1e-140 counts as zero.
struct BoundProblem {
  ColumnsView columns;
  Eigen::VectorXd goal;
  Eigen::VectorXd row_weight;  ///< ≥ 0; empty = 1
  /// Columns that are emitters of one light have the same number; empty: a light per column. A light counts once,
  /// however many of its emitters burn.
  std::vector<std::uint32_t> light_of_column;

  /// Empty, or what is wrong: sizes, entries that are negative or not finite.
  [[nodiscard]] std::string complaint() const;
  [[nodiscard]] Eigen::VectorXd weights() const;  ///< never empty
};

/// Rows of weight above 0 that no candidate reaches. They stay dark with any lights, which the bounds account for.
[[nodiscard]] std::vector<Eigen::Index> unreachable_rows(const BoundProblem& of);

/// With any number of lights. x: levels as good as one has them, ≥ 0 or not. 0 for a goal of zero.
/// Asserted: no complaint(), and as many levels as columns.
[[nodiscard]] double error_bound(const BoundProblem& of, const Eigen::VectorXd& x);

/// A solution by whose residual light between blocks is priced: of a search, say. Need not be of these candidates.
struct PriceGuess {
  std::size_t lights = 0;
  Eigen::VectorXd residual;  ///< W (b − A x)
};

/// A stop returns what is proven so far.
struct CountBoundOptions : Run {
  std::size_t most_lights = 20;
  /// Bounds are made for these numbers of lights, and hold for fewer as well. Empty: greedy solutions of most_lights
  /// and of three fractions of it.
  std::vector<PriceGuess> guesses;
  /// What a guess costs, and how good its bound gets: times that its prices are improved; cells looked into each time,
  /// and at the end. In a flat of 300 points and 18 500 candidates a cell takes about a millisecond.
  std::size_t price_rounds = 12, nodes_a_round = 150, nodes = 1000;
  /// Points that share fewer of their lights than this are apart (light_blocks.h).
  double least_similarity = 0.12;
};

/// [k], k = 0 … most_lights: no k lights come closer. Never rises. Asserted: no complaint().
[[nodiscard]] std::vector<double> error_bounds_by_count(const BoundProblem& of, const CountBoundOptions& options);

}  // namespace luxrig
