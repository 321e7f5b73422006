#include "core/solve/emittance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/solve/emittance_reasons.h"
#include "core/solve/limited_least_squares.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Weight of the tie term relative to a light's column: small against any tolerance, large against rounding.
constexpr double kTie = 1e-5;
constexpr double kLargestEntry = 1e100;

std::string point_text(const EmittanceProblem& p, Index i) {
  const auto at = static_cast<std::size_t>(i);
  return at < p.point_name.size() ? fmt::format("point '{}'", p.point_name[at]) : fmt::format("point {}", i);
}

std::optional<std::string> complaint(const EmittanceProblem& p) {
  const Index points = p.lux_per_level.rows(), lights = p.lux_per_level.cols();
  const auto entries = [](const auto& values, const char* what) -> std::optional<std::string> {
    for (Index j = 0; j < values.cols(); ++j)
      for (Index i = 0; i < values.rows(); ++i)
        if (!(values(i, j) >= 0 && values(i, j) <= kLargestEntry))
          return fmt::format("{} must be from 0 to {:g}; entry ({}, {}) is {:g}", what, kLargestEntry, i, j,
                             values(i, j));
    return std::nullopt;
  };
  const auto size = [](const char* what, Index has, Index wants) {
    return fmt::format("{} has {} entries, {} are needed", what, has, wants);
  };
  if (p.fixed_lx.size() != points) return size("fixed_lx", p.fixed_lx.size(), points);
  if (p.goal_lx.size() != points) return size("goal_lx", p.goal_lx.size(), points);
  if (p.weight.size() != points) return size("weight", p.weight.size(), points);
  if (p.max_lx.size() != points) return size("max_lx", p.max_lx.size(), points);
  if (p.max_level.size() != lights) return size("max_level", p.max_level.size(), lights);
  if (p.near_level.size() != lights) return size("near_level", p.near_level.size(), lights);
  if (auto text = entries(p.lux_per_level, "lux_per_level")) return text;
  if (auto text = entries(p.fixed_lx, "fixed_lx")) return text;
  if (auto text = entries(p.weight, "weight")) return text;
  if (auto text = entries(p.max_level, "max_level")) return text;
  if (auto text = entries(p.near_level, "near_level")) return text;
  for (Index i = 0; i < points; ++i) {
    if (!std::isnan(p.goal_lx[i]) && !(p.goal_lx[i] >= 0 && p.goal_lx[i] <= kLargestEntry))
      return fmt::format("{}: a goal of {:g} lx", point_text(p, i), p.goal_lx[i]);
    if (!(p.max_lx[i] >= p.fixed_lx[i]))
      return fmt::format("{}: the limit of {:g} lx is below the {:g} lx that are there anyway", point_text(p, i),
                         p.max_lx[i], p.fixed_lx[i]);
  }
  return std::nullopt;
}

EmittanceProblem completed(EmittanceProblem p) {
  const Index points = p.lux_per_level.rows(), lights = p.lux_per_level.cols();
  if (p.fixed_lx.size() == 0) p.fixed_lx = VectorXd::Zero(points);
  if (p.weight.size() == 0) p.weight = VectorXd::Ones(points);
  if (p.goal_lx.size() == 0) p.goal_lx = VectorXd::Constant(points, std::numeric_limits<double>::quiet_NaN());
  if (p.max_lx.size() == 0) p.max_lx = VectorXd::Constant(points, kInfinity);
  if (p.max_level.size() == 0) p.max_level = VectorXd::Ones(lights);
  if (p.near_level.size() == 0) p.near_level = VectorXd::Zero(lights);
  return p;
}

double power_of_two_near(double value) { return value > 0 ? std::ldexp(1.0, std::ilogb(value)) : 0; }

/// The problem in variables z_j = level_j · unit_j, in which every light's column and the right-hand side are about 1.
struct ScaledProblem {
  LimitedLeastSquares least_squares;
  MatrixXd objective;  ///< W T without tie rows
  VectorXd target;     ///< W (g − b)
  VectorXd unit;
  std::vector<Index> limited;  ///< points of the rows of G
};

ScaledProblem scaled(const EmittanceProblem& p) {
  ScaledProblem s;
  const Index lights = p.lux_per_level.cols();
  std::vector<Index> goals;
  for (Index i = 0; i < p.goal_lx.size(); ++i) {
    if (!std::isnan(p.goal_lx[i]) && p.weight[i] > 0) goals.push_back(i);
    if (std::isfinite(p.max_lx[i]) && p.lux_per_level.row(i).size() > 0 && p.lux_per_level.row(i).maxCoeff() > 0)
      s.limited.push_back(i);
  }
  const auto rows = static_cast<Index>(goals.size()), limits = static_cast<Index>(s.limited.size());
  s.objective.resize(rows, lights);
  s.target.resize(rows);
  for (Index k = 0; k < rows; ++k) {
    const Index i = goals[static_cast<std::size_t>(k)];
    s.objective.row(k) = p.weight[i] * p.lux_per_level.row(i);
    // Lights only add: a point that has more than its goal without them asks for none, and holds no other point down.
    s.target[k] = p.weight[i] * std::max(0.0, p.goal_lx[i] - p.fixed_lx[i]);
  }
  const double right =
      s.target.size() > 0 && s.target.cwiseAbs().maxCoeff() > 0 ? power_of_two_near(s.target.stableNorm()) : 1.0;
  s.target /= right;
  s.unit.resize(lights);
  for (Index j = 0; j < lights; ++j) {
    double norm = rows > 0 ? s.objective.col(j).stableNorm() : 0;
    if (norm == 0) norm = p.lux_per_level.rows() > 0 ? p.lux_per_level.col(j).stableNorm() : 0;
    s.unit[j] = norm > 0 ? power_of_two_near(norm) / right : 1;
    s.objective.col(j) /= s.unit[j] * right;
  }
  LimitedLeastSquares& q = s.least_squares;
  q.E.resize(rows + lights, lights);
  if (rows > 0) q.E.topRows(rows) = s.objective;
  if (lights > 0) q.E.bottomRows(lights) = kTie * MatrixXd::Identity(lights, lights);
  q.f.resize(rows + lights);
  q.f.head(rows) = s.target;
  q.f.tail(lights) = kTie * p.near_level.cwiseProduct(s.unit);
  q.upper = p.max_level.cwiseProduct(s.unit);
  q.G.resize(limits, lights);
  q.slack.resize(limits);
  for (Index k = 0; k < limits; ++k) {
    const Index i = s.limited[static_cast<std::size_t>(k)];
    q.G.row(k) = p.lux_per_level.row(i).cwiseQuotient(s.unit.transpose());
    const double norm = power_of_two_near(q.G.row(k).stableNorm());
    q.G.row(k) /= norm;
    q.slack[k] = (p.max_lx[i] - p.fixed_lx[i]) / norm;
  }
  return s;
}

VectorXd levels_of(const EmittanceProblem& p, const ScaledProblem& s, const LimitedLeastSquaresResult& at) {
  VectorXd level = at.z.cwiseQuotient(s.unit).cwiseMin(p.max_level);
  for (Index j = 0; j < level.size(); ++j)
    if (at.state[static_cast<std::size_t>(j)] == BoundState::upper) level[j] = p.max_level[j];
  return level;
}

/// Takes the last rounding off: T_i c + b_i ≤ m_i holds whatever the order of summation, since the room left is more
/// than the error of a sum of so many terms.
void keep_limits(const EmittanceProblem& p, VectorXd& level) {
  const double rounding = static_cast<double>(level.size() + 4) * std::numeric_limits<double>::epsilon();
  for (Index i = 0; i < p.max_lx.size(); ++i) {
    if (!std::isfinite(p.max_lx[i])) continue;
    const auto row = p.lux_per_level.row(i);
    const double room = (p.max_lx[i] - p.fixed_lx[i]) - rounding * p.max_lx[i];
    for (int attempt = 0;; ++attempt) {
      const double lux = row.dot(level);
      if (lux <= room || lux == 0) break;
      const double share =
          room <= 0 || attempt > 20 ? 0 : room / lux * (1 - 4 * std::numeric_limits<double>::epsilon());
      for (Index j = 0; j < level.size(); ++j)
        if (row[j] > 0) level[j] *= share;
    }
  }
}

/// Largest violation of stationarity, signs and complementarity of the problem without tie term, in scaled variables:
/// relative to the columns' norms times the norm of the right-hand side.
double kkt_residual(const ScaledProblem& s, const LimitedLeastSquaresResult& at, const VectorXd& level) {
  if (at.z.size() == 0) return 0;
  const LimitedLeastSquares& q = s.least_squares;
  const VectorXd z = level.cwiseProduct(s.unit);
  VectorXd gradient = s.objective.transpose() * (s.objective * z - s.target);
  const VectorXd multiplier = row_multipliers(q.G, at, gradient);
  double worst = 0;
  for (std::size_t k = 0; k < at.working_rows.size(); ++k) {
    const Index row = at.working_rows[k];
    const double lambda = multiplier[static_cast<Index>(k)];
    gradient += lambda * q.G.row(row).transpose();
    worst = std::max({worst, -lambda, std::abs(lambda * (q.slack[row] - q.G.row(row).dot(z)))});
  }
  for (Index j = 0; j < z.size(); ++j) {
    if (q.upper[j] == 0) continue;
    const BoundState state = at.state[static_cast<std::size_t>(j)];
    const double g = gradient[j];
    worst = std::max(worst, state == BoundState::free ? std::abs(g) : state == BoundState::lower ? -g : g);
  }
  return worst;
}

Fault fault(Cause cause, std::string detail) {
  Fault f;
  f.cause = cause;
  f.detail = std::move(detail);
  return f;
}

/// Lux of the same problem with some constraints lifted.
Result<VectorXd> lux_without(EmittanceProblem p, bool max_lx, bool max_level, const Watch& watch) {
  if (max_lx) p.max_lx.setConstant(kInfinity);
  if (max_level) p.max_level.setConstant(kInfinity);
  const ScaledProblem s = scaled(p);
  const LimitedLeastSquaresResult at = solve_limited_least_squares(s.least_squares, watch.stop);
  if (at.stopped) return tl::unexpected(fault(Cause::cancelled, "stopped on request"));
  return VectorXd(p.lux_per_level * levels_of(p, s, at) + p.fixed_lx);
}

Held held_at(const EmittanceProblem& p, const VectorXd& level, const VectorXd& lux) {
  constexpr double kTouching = 1e-6;
  Held held;
  for (Index i = 0; i < lux.size(); ++i) held.point.push_back(lux[i] >= p.max_lx[i] * (1 - kTouching));
  for (Index j = 0; j < level.size(); ++j) held.light_at_max.push_back(level[j] >= p.max_level[j] * (1 - kTouching));
  return held;
}

}  // namespace

Result<EmittanceSolution> solve_emittance(const EmittanceProblem& given, const Watch& watch) {
  const EmittanceProblem p = completed(given);
  if (auto text = complaint(p)) return tl::unexpected(fault(Cause::invalid, *text));

  const ScaledProblem s = scaled(p);
  const LimitedLeastSquaresResult at = solve_limited_least_squares(s.least_squares, watch.stop);
  if (at.stopped) return tl::unexpected(fault(Cause::cancelled, "stopped on request"));

  EmittanceSolution solution;
  solution.level = levels_of(p, s, at);
  keep_limits(p, solution.level);
  solution.iterations = at.iterations;
  solution.kkt_residual = kkt_residual(s, at, solution.level);

  const VectorXd lux = p.lux_per_level * solution.level + p.fixed_lx;
  const Held held = held_at(p, solution.level, lux);
  std::optional<WhatIf> what_if;
  double error = 0, goals = 0;
  for (Index i = 0; i < lux.size(); ++i) {
    PointOutcome outcome;
    outcome.lux = lux[i];
    if (!std::isnan(p.goal_lx[i])) {
      outcome.shortfall_lx = p.goal_lx[i] - lux[i];
      error = std::hypot(error, outcome.shortfall_lx);
      goals = std::hypot(goals, p.goal_lx[i]);
    }
    if (misses_goal(p, i, lux[i])) {
      if (!what_if) {
        auto no_max_lx = lux_without(p, true, false, watch), no_max_level = lux_without(p, false, true, watch),
             neither = lux_without(p, true, true, watch);
        for (const auto* each : {&no_max_lx, &no_max_level, &neither})
          if (!*each) return tl::unexpected(each->error());
        what_if = WhatIf{*no_max_lx, *no_max_level, *neither};
      }
      explain(p, solution.level, held, *what_if, i, outcome);
    }
    solution.points.push_back(std::move(outcome));
  }
  solution.normalised_error = goals > 0 ? error / goals : 0;
  if (watch.progress) watch.progress(1);
  return solution;
}

}  // namespace luxrig
