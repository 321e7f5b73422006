#pragma once
/// Where to begin a limited least squares of many unknowns: near its optimum, with nearly the right constraints. An
/// interior-point method by predictor and corrector (S. Mehrotra, 1992) goes through the inside of the limits in some
/// twenty steps however many constraints there are, and tells in the end which of them it is drawn to (A. El-Bakry,
/// R. Tapia, Y. Zhang, 1994). Internal to limited_least_squares: what it says is checked there.

#include "core/solve/free_step.h"

namespace luxrig {

struct LimitedStart {
  Eigen::VectorXd z;               ///< within bounds and limits
  std::vector<BoundState> state;   ///< z is at the bound where one is named
  std::vector<Eigen::Index> rows;  ///< of G, which z is near
  int iterations = 0;
};

[[nodiscard]] LimitedStart limited_start(const LimitedLeastSquares& problem, const ColumnProducts& products,
                                         const std::stop_token& stop);

}  // namespace luxrig
