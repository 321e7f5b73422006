#pragma once
/// Two ways to the same optimum, and the check of an answer. Internal to limited_least_squares.

#include <optional>

#include "core/solve/least_squares/limited_least_squares.h"

namespace luxrig {

/// An answer that violates the optimality conditions by more than this is rejected; columns, rows and f are about 1.
inline constexpr double kVerified = 1e-11;

[[nodiscard]] std::vector<Eigen::Index> free_variables(const std::vector<BoundState>& state);

/// One constraint at a time (Nocedal & Wright, algorithm 16.3). Right for every problem, but a step costs the cube of
/// the free unknowns, and z = 0 needs one step for each binding constraint.
/// start   feasible point to start from; empty = z = 0
[[nodiscard]] LimitedLeastSquaresResult solve_by_active_set(const LimitedLeastSquares& problem,
                                                            const std::stop_token& stop,
                                                            LimitedLeastSquaresResult start = {});

/// From a guess near the optimum: all constraints with a wrong sign change at once, round by round (a primal-dual
/// active set; Hintermüller, Ito & Kunisch 2002). True when that ends and the optimality conditions hold within
/// kVerified. If false, `at` has no guarantees.
[[nodiscard]] bool settle_active_set(const LimitedLeastSquares& problem, LimitedLeastSquaresResult& at,
                                     const std::stop_token& stop);

/// The method of multipliers, which changes many constraints at a time, guesses which bind (limited_nnls.h). Ties are
/// then decided by rounding: settle_active_set or the single-constraint method corrects them. Empty unless the answer
/// meets the optimality conditions.
[[nodiscard]] std::optional<LimitedLeastSquaresResult> solve_by_multipliers(const LimitedLeastSquares& problem,
                                                                            const std::stop_token& stop);

/// Largest violation of the optimality conditions: stationarity, bounds and rows, signs and complementarity.
/// multiplier   of the working rows
[[nodiscard]] double kkt_violation(const LimitedLeastSquares& problem, const LimitedLeastSquaresResult& at,
                                   const Eigen::VectorXd& multiplier);

}  // namespace luxrig
