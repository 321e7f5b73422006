#pragma once
/// Internal to limited_least_squares: two ways to the same optimum, and how good an answer is.

#include <optional>

#include "core/solve/least_squares/limited_least_squares.h"

namespace luxrig {

/// What is further than this from the optimum's conditions is not taken; columns, rows and f are about 1.
inline constexpr double kVerified = 1e-11;

[[nodiscard]] std::vector<Eigen::Index> free_variables(const std::vector<BoundState>& state);

/// One constraint at a time (Nocedal & Wright, algorithm 16.3): right for every problem, but a step costs a cube of the
/// free unknowns, and from z = 0 there is one for each constraint that binds.
/// start   feasible, from which to go on; empty: z = 0
[[nodiscard]] LimitedLeastSquaresResult solve_by_active_set(const LimitedLeastSquares& problem,
                                                            const std::stop_token& stop,
                                                            LimitedLeastSquaresResult start = {});

/// From a guess near the optimum: all constraints that have a wrong sign change at once, round by round (a primal-dual
/// active set; Hintermüller, Ito & Kunisch 2002). True when that ends and the optimum's conditions are met within
/// kVerified; nothing is promised otherwise.
[[nodiscard]] bool settle_active_set(const LimitedLeastSquares& problem, LimitedLeastSquaresResult& at,
                                     const std::stop_token& stop);

/// Which constraints bind is guessed by the method of multipliers, which changes many at a time (limited_nnls.h). That
/// leaves ties to rounding: they are settled, or go one at a time from the guess. None unless the answer meets the
/// optimum's conditions.
[[nodiscard]] std::optional<LimitedLeastSquaresResult> solve_by_multipliers(const LimitedLeastSquares& problem,
                                                                            const std::stop_token& stop);

/// Largest violation of the optimum's conditions: stationarity, bounds and rows, signs and complementarity.
/// multiplier   of the working rows
[[nodiscard]] double kkt_violation(const LimitedLeastSquares& problem, const LimitedLeastSquaresResult& at,
                                   const Eigen::VectorXd& multiplier);

}  // namespace luxrig
