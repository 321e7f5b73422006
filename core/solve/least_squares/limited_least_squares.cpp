#include "core/solve/least_squares/limited_least_squares.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "core/solve/least_squares/limited_methods.h"
#include "core/solve/least_squares/limited_nnls.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// From this many unknowns on, changing many constraints at a time is faster (`luxrig bench nnls --only levels`).
constexpr Index kMany = 200;

/// A row of a start that uses more of its slack than this may bind at the optimum.
constexpr double kNearlyBinds = 0.99;

/// Which constraints bind at the optimum, as the start has it.
LimitedLeastSquaresResult guess_of_start(const LimitedLeastSquares& p) {
  LimitedLeastSquaresResult guess;
  guess.z = p.start.cwiseMax(0.0).cwiseMin(p.upper);
  guess.state.assign(static_cast<std::size_t>(guess.z.size()), BoundState::free);
  for (Index j = 0; j < guess.z.size(); ++j)
    if (guess.z[j] == 0 || guess.z[j] == p.upper[j])
      guess.state[static_cast<std::size_t>(j)] = guess.z[j] == 0 ? BoundState::lower : BoundState::upper;
  const VectorXd used = p.G * guess.z;
  for (Index i = 0; i < used.size(); ++i)
    if (used[i] > 0 && used[i] > kNearlyBinds * p.slack[i]) guess.working_rows.push_back(i);
  return guess;
}

}  // namespace

std::vector<Index> free_variables(const std::vector<BoundState>& state) {
  std::vector<Index> free;
  for (std::size_t j = 0; j < state.size(); ++j)
    if (state[j] == BoundState::free) free.push_back(static_cast<Index>(j));
  return free;
}

VectorXd row_multipliers(const MatrixXd& G, const LimitedLeastSquaresResult& at, const VectorXd& gradient) {
  const std::vector<Index> free = free_variables(at.state);
  if (at.working_rows.empty() || free.empty()) return VectorXd::Zero(static_cast<Index>(at.working_rows.size()));
  const MatrixXd rows = G(at.working_rows, free).transpose();
  const VectorXd part = -gradient(free);
  return rows.colPivHouseholderQr().solve(part);
}

double kkt_violation(const LimitedLeastSquares& p, const LimitedLeastSquaresResult& at, const VectorXd& multiplier) {
  if (!at.z.allFinite() || !multiplier.allFinite()) return HUGE_VAL;
  VectorXd gradient = p.E.transpose() * (p.E * at.z - p.f);
  const VectorXd over = p.G * at.z - p.slack;
  double worst = over.size() > 0 ? std::max(0.0, over.maxCoeff()) : 0;
  for (std::size_t k = 0; k < at.working_rows.size(); ++k) {
    const Index row = at.working_rows[k];
    const double lambda = multiplier[static_cast<Index>(k)];
    gradient += lambda * p.G.row(row).transpose();
    worst = std::max({worst, -lambda, std::abs(lambda * over[row])});
  }
  for (Index j = 0; j < at.z.size(); ++j) {
    worst = std::max({worst, -at.z[j], at.z[j] - p.upper[j]});
    if (p.upper[j] == 0) continue;
    if (at.z[j] > 0) worst = std::max(worst, gradient[j]);
    if (at.z[j] < p.upper[j]) worst = std::max(worst, -gradient[j]);
  }
  return worst;
}

std::optional<LimitedLeastSquaresResult> solve_by_multipliers(const LimitedLeastSquares& p,
                                                              const std::stop_token& stop) {
  const NnlsProblem problem{ColumnsView(p.E), p.f, {}, p.upper};
  const LinearLimits limits{p.G.sparseView(1, 0), p.slack};
  NnlsOptions options;
  options.stop = stop;
  const auto guess = solve_limited_nnls(problem, limits, options);
  LimitedLeastSquaresResult at;
  at.stopped = stop.stop_requested();
  if (at.stopped) return at;
  if (!guess) return std::nullopt;
  at.z = guess->least_squares.x;
  at.iterations = guess->least_squares.iterations;
  at.state.assign(static_cast<std::size_t>(at.z.size()), BoundState::free);
  for (Index j = 0; j < at.z.size(); ++j)
    if (at.z[j] == 0 || at.z[j] == p.upper[j])
      at.state[static_cast<std::size_t>(j)] = at.z[j] == 0 ? BoundState::lower : BoundState::upper;
  for (Index i = 0; i < guess->multiplier.size(); ++i)
    if (guess->multiplier[i] > 0) at.working_rows.push_back(i);
  if (LimitedLeastSquaresResult settled = at; settle_active_set(p, settled, stop)) return settled;
  at = solve_by_active_set(p, stop, std::move(at));
  if (at.stopped) return at;
  const VectorXd gradient = p.E.transpose() * (p.E * at.z - p.f);
  if (!at.converged || kkt_violation(p, at, row_multipliers(p.G, at, gradient)) > kVerified) return std::nullopt;
  return at;
}

LimitedLeastSquaresResult solve_limited_least_squares(const LimitedLeastSquares& problem, const std::stop_token& stop) {
  if (problem.E.cols() == 0) {
    LimitedLeastSquaresResult none;
    none.z.resize(0);
    none.converged = true;
    return none;
  }
  if (problem.E.cols() >= kMany)
    if (auto result = solve_by_multipliers(problem, stop)) return std::move(*result);
  if (problem.start.size() == problem.E.cols() && problem.start.allFinite())
    if (LimitedLeastSquaresResult at = guess_of_start(problem); settle_active_set(problem, at, stop)) return at;
  return solve_by_active_set(problem, stop);
}

}  // namespace luxrig
