#pragma once
/// min ‖E z − f‖² + tie² ‖z − near‖² subject to 0 ≤ z ≤ upper and G z ≤ slack, by a primal active-set method that
/// starts from the feasible z = 0 and stays feasible (Nocedal & Wright, Numerical Optimization (2006), algorithm 16.3).
/// Few unknowns: null space by QR. Many, with a tie: it starts beside the optimum, where an interior point leads
/// (limited_start.h), and steps by a Cholesky factor that follows the set of free unknowns (free_step.h).

#include <Eigen/Core>
#include <stop_token>
#include <vector>

namespace luxrig {

struct LimitedLeastSquares {
  Eigen::MatrixXd E;       ///< columns of norm about 1; full column rank where tie = 0
  Eigen::VectorXd f;       ///< norm about 1
  Eigen::VectorXd upper;   ///< ≥ 0, may be +inf
  Eigen::MatrixXd G;       ///< rows of norm about 1
  Eigen::VectorXd slack;   ///< ≥ 0: what G z may be
  double tie = 0;          ///< small, or 0
  Eigen::VectorXd near{};  ///< needed where tie > 0
};

/// The same with the tie as further rows of E and f.
[[nodiscard]] LimitedLeastSquares tie_in_rows(LimitedLeastSquares problem);

enum class BoundState : char { free, lower, upper };

struct LimitedLeastSquaresResult {
  Eigen::VectorXd z;                       ///< within bounds exactly, within the rows to rounding
  std::vector<BoundState> state;           ///< of each variable
  std::vector<Eigen::Index> working_rows;  ///< rows of G held as equalities
  Eigen::VectorXd multiplier;              ///< of these, at z
  int iterations = 0;
  bool converged = false;
  bool stopped = false;
};

[[nodiscard]] LimitedLeastSquaresResult solve_limited_least_squares(const LimitedLeastSquares& problem,
                                                                    const std::stop_token& stop);

}  // namespace luxrig
