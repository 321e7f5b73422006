#pragma once
/// min ‖A x − b‖₂ subject to x ≥ 0 (Lawson & Hanson 1974, algorithm NNLS).

#include <Eigen/Core>

namespace luxrig {

struct NnlsResult {
  Eigen::VectorXd x;
  double residual_norm = 0;  ///< ‖A x − b‖₂
  double kkt_residual = 0;  ///< max violation of x ≥ 0, w = Aᵀ(b − A x) ≤ 0 where x = 0, w = 0 where x > 0; relative to
                            ///< the columns' norms times ‖b‖
  int iterations = 0;
  bool converged = false;
};

/// A may be rank-deficient or badly scaled, have zero or equal columns, or none; never cycles, never returns NaN
/// for finite input (asserted finite).
[[nodiscard]] NnlsResult solve_nnls(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

}  // namespace luxrig
