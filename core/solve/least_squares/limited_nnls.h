#pragma once
/// Bounded least squares under linear limits:
///
///   min ‖W (A x − b)‖₂²   subject to   0 ≤ x ≤ upper   and   C (x, t) ≤ d,  t ≥ 0
///
/// t are auxiliary unknowns that appear only in limits (lux_limits.h needs them for ratios).
///
/// Method of multipliers (Rockafellar 1976; Bertsekas 1982): each round is a bounded least-squares problem with the
/// limits, and a slack for each, as extra rows. It starts from the last solution. Limits and columns may be dependent.
/// First the same solver checks whether the limits are feasible: the least violation is itself such a problem, and its
/// residual is a proof (Farkas) that names the limits in conflict.

#include <Eigen/SparseCore>
#include <vector>

#include "core/solve/least_squares/nnls.h"

namespace luxrig {

struct LinearLimits {
  Eigen::SparseMatrix<double> rows;  ///< C: one row per limit; columns of A, then the auxiliary unknowns
  Eigen::VectorXd most;              ///< d; +inf = no limit
};

struct LimitedNnlsSolution {
  NnlsSolution least_squares;  ///< x, residual and KKT of the whole; `primal` includes limits, relative to a row's norm
  Eigen::VectorXd auxiliary;   ///< t
  Eigen::VectorXd multiplier;  ///< ≥ 0: fall of half the squared error per unit of d
  /// Limits that cannot hold together; the conflict needs each of them. Empty when some x keeps all limits. If not
  /// empty, x is the least violation of all limits together, and nothing else is set.
  std::vector<Eigen::Index> conflict;
  int rounds = 0;
};

/// Cause::invalid with the problem's complaint, or for limits of wrong size, not finite or beyond 1e±140.
[[nodiscard]] Result<LimitedNnlsSolution> solve_limited_nnls(const NnlsProblem& problem, const LinearLimits& limits,
                                                             const NnlsOptions& options = {});

}  // namespace luxrig
