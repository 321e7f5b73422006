#pragma once
/// min ‖E z − f‖₂ subject to 0 ≤ z ≤ upper and G z ≤ slack, by a feasible primal active-set method (Nocedal & Wright,
/// Numerical Optimization (2006), algorithm 16.3; null space by QR). With few unknowns it starts from z = 0. With many
/// it starts near the optimum, from the result of the method of multipliers. If the answer then fails the optimality
/// conditions, it solves again from z = 0.

#include <Eigen/Core>
#include <stop_token>
#include <vector>

namespace luxrig {

struct LimitedLeastSquares {
  Eigen::MatrixXd E;      ///< full column rank; columns of norm about 1
  Eigen::VectorXd f;      ///< norm about 1
  Eigen::VectorXd upper;  ///< ≥ 0, may be +inf
  Eigen::MatrixXd G;      ///< rows of norm about 1
  Eigen::VectorXd slack;  ///< ≥ 0: upper limit of G z
  /// z near the optimum, as of a problem that differs a little. What binds there is tried first, all at once: the
  /// optimum is the same up to rounding, sooner. Need not be feasible; empty = none.
  Eigen::VectorXd start{};
};

enum class BoundState : char { free, lower, upper };

struct LimitedLeastSquaresResult {
  Eigen::VectorXd z;                       ///< exactly within bounds; within the rows to rounding
  std::vector<BoundState> state;           ///< of each variable
  std::vector<Eigen::Index> working_rows;  ///< rows of G held as equalities
  int iterations = 0;
  bool converged = false;
  bool stopped = false;
};

[[nodiscard]] LimitedLeastSquaresResult solve_limited_least_squares(const LimitedLeastSquares& problem,
                                                                    const std::stop_token& stop);

/// λ of the working rows for a gradient of the objective at z: argmin ‖gradient_F + G_WFᵀ λ‖ over the free variables.
[[nodiscard]] Eigen::VectorXd row_multipliers(const Eigen::MatrixXd& G, const LimitedLeastSquaresResult& at,
                                              const Eigen::VectorXd& gradient);

}  // namespace luxrig
