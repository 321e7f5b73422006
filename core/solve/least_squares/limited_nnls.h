#pragma once
/// Bounded least squares under linear limits:
///
///   min ‖W (A x − b)‖₂²   subject to   0 ≤ x ≤ upper   and   C (x, t) ≤ d,  t ≥ 0
///
/// t are auxiliary unknowns that only limits mention (lux_limits.h needs them for ratios).
///
/// Method of multipliers (Rockafellar 1976; Bertsekas 1982): each round is a bounded least squares with the limits, and
/// a slack for each, as further rows, solved from where the last ended; limits may be dependent, and columns too.
/// Whether the limits can be kept at all is asked of the same solver first: the least violation is itself such a
/// problem, and what it leaves is a proof (Farkas) that names the limits in conflict.

#include <Eigen/SparseCore>
#include <vector>

#include "core/solve/least_squares/nnls.h"

namespace luxrig {

struct LinearLimits {
  Eigen::SparseMatrix<double> rows;  ///< C: a row per limit; columns of A, then the auxiliary unknowns
  Eigen::VectorXd most;              ///< d; +inf where there is none
};

struct LimitedNnlsSolution {
  NnlsSolution least_squares;  ///< x, residual and KKT of the whole; `primal` counts limits, relative to a row's norm
  Eigen::VectorXd auxiliary;   ///< t
  Eigen::VectorXd multiplier;  ///< ≥ 0: by how much half the squared error would fall per unit more of d
  /// Limits that cannot be kept together, none of which can be left out of the conflict; empty when there is an x that
  /// keeps all. If not empty, x violates all limits together least and nothing else is set.
  std::vector<Eigen::Index> conflict;
  int rounds = 0;
};

/// Cause::invalid with the problem's complaint, or for limits of wrong size, not finite or beyond 1e±140.
[[nodiscard]] Result<LimitedNnlsSolution> solve_limited_nnls(const NnlsProblem& problem, const LinearLimits& limits,
                                                             const NnlsOptions& options = {});

}  // namespace luxrig
