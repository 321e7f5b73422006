#pragma once
/// Bounded least squares under linear limits:
///
///   min ‖W (A x − b)‖₂²   subject to   0 ≤ x ≤ upper   and   C x ≤ d,  C ≥ 0,  d ≥ 0
///
/// Method of multipliers (Rockafellar 1976; Bertsekas 1982): each round is a bounded least-squares problem with the
/// limits, and a slack for each, as extra rows. It starts from the last solution. Limits and columns may be dependent.
/// x = 0 keeps all limits. A limit of 0 closes its columns, and its multiplier is left at 0.

#include <Eigen/SparseCore>

#include "core/solve/least_squares/nnls.h"

namespace luxrig {

struct LinearLimits {
  Eigen::SparseMatrix<double> rows;  ///< C ≥ 0: one row per limit
  Eigen::VectorXd most;              ///< d ≥ 0; +inf = no limit
};

struct LimitedNnlsSolution {
  NnlsSolution least_squares;  ///< x, residual and KKT of the whole; `primal` includes limits, relative to a row's norm
  Eigen::VectorXd multiplier;  ///< ≥ 0: fall of half the squared error per unit of d
  int rounds = 0;
};

/// Cause::invalid with the problem's complaint, or for limits of wrong size, or with entries below 0, not finite or beyond
/// 1e±140.
[[nodiscard]] Result<LimitedNnlsSolution> solve_limited_nnls(const NnlsProblem& problem, const LinearLimits& limits,
                                                             const NnlsOptions& options = {});

}  // namespace luxrig
