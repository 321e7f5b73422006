#pragma once
/// Certified lower bounds on how closely lights at given candidates can meet a goal:
///
///   ‖W (A x − b)‖₂ / ‖W b‖₂   over x ≥ 0,
///
/// with any number of lights, and with at most k. They show when the goal, not the search, is the problem.
///
/// Every bound is proven by a dual point derived from the given x (weak duality). A better x gives a tighter bound, but
/// any x gives a valid one. Rounding is charged, so a bound is about 1e-13 below the true optimum.
///
/// At most k: the rows fall into blocks that share few lights (light_blocks.h). Light between blocks gets a price per
/// block, which makes the blocks independent (Lagrangian decomposition; Guignard & Kim 1987). Branch and bound
/// (block_bound.h) bounds the least error of each block with c lights of its own, and dynamic programming distributes
/// the k lights. Any prices give a valid bound; the residuals of a good solution are good prices.

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
  /// Emitters of one light share a number; empty = one light per column. A light counts once, however many of its
  /// emitters burn.
  std::vector<std::uint32_t> light_of_column;

  /// Empty, or the error: sizes that disagree, entries that are negative or not finite.
  [[nodiscard]] std::string complaint() const;
  [[nodiscard]] Eigen::VectorXd weights() const;  ///< never empty
};

/// Rows of weight above 0 that no candidate reaches. They stay dark with any lights; the bounds account for that.
[[nodiscard]] std::vector<Eigen::Index> unreachable_rows(const BoundProblem& of);

/// Bound with any number of lights. x: the best known levels, ≥ 0 or not. 0 for a goal of zero.
/// Asserted: no complaint(), and as many levels as columns.
[[nodiscard]] double error_bound(const BoundProblem& of, const Eigen::VectorXd& x);

/// A solution whose residual sets the prices of light between blocks, from a search for example. It may use other
/// candidates.
struct PriceGuess {
  std::size_t lights = 0;
  Eigen::VectorXd residual;  ///< W (b − A x)
};

/// When stopped, the result is the bounds proven so far.
struct CountBoundOptions : Run {
  std::size_t max_lights = 20;
  /// Bounds are made for these numbers of lights; they also hold for fewer. Empty = greedy solutions of max_lights and
  /// of three fractions of it.
  std::vector<PriceGuess> guesses;
  /// Cost of a guess, and quality of its bound: rounds that improve prices, nodes split per round, nodes split at the
  /// end. In a flat of 300 points and 18 500 candidates a node takes about a millisecond.
  std::size_t price_rounds = 12, nodes_a_round = 150, nodes = 1000;
  /// Points that share a smaller fraction of their lights belong to different blocks (light_blocks.h).
  double min_similarity = 0.12;
};

/// [k], k = 0 … max_lights: lower bound with k lights. Never rises with k. Asserted: no complaint().
[[nodiscard]] std::vector<double> error_bounds_by_count(const BoundProblem& of, const CountBoundOptions& options);

}  // namespace luxrig
