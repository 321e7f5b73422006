#include "core/solve/emittance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/solve/emittance_reasons.h"
#include "core/solve/least_squares/limited_least_squares.h"
#include "core/solve/least_squares/switched_least_squares.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Weight of the tie term relative to a light's column: small against any tolerance, large against rounding.
constexpr double kTie = 1e-5;
constexpr double kLargestEntry = 1e100;

Fault fault(Cause cause, std::string detail) {
  Fault f;
  f.cause = cause;
  f.detail = std::move(detail);
  return f;
}

std::string point_text(const EmittanceProblem& p, Index i) {
  const auto at = static_cast<std::size_t>(i);
  return at < p.point_name.size() ? fmt::format("point '{}'", p.point_name[at]) : fmt::format("point {}", i);
}

std::optional<std::string> complaint_of_colour(const EmittanceProblem& p) {
  const Index points = p.lux_per_level.rows(), lights = p.lux_per_level.cols();
  if (p.rgb_per_level.empty()) return std::nullopt;
  if (p.rgb_per_level.size() != 3) return fmt::format("rgb_per_level has {} primaries", p.rgb_per_level.size());
  const auto bad = [](const MatrixXd& m, Index rows, Index columns) {
    return m.rows() != rows || m.cols() != columns || !m.allFinite() ||
           (m.size() > 0 && m.cwiseAbs().maxCoeff() > kLargestEntry);
  };
  for (const MatrixXd& primary : p.rgb_per_level)
    if (bad(primary, points, lights)) return "rgb_per_level has the wrong size, or an entry that is not finite";
  if (bad(p.fixed_rgb, points, 3)) return "fixed_rgb has the wrong size, or an entry that is not finite";
  if (p.goal_rgb.rows() != points || p.goal_rgb.cols() != 3) return "goal_rgb has the wrong size";
  for (Index i = 0; i < points; ++i)
    if (!std::isnan(p.goal_lx[i]) && !(p.goal_rgb.row(i).allFinite() && p.goal_rgb.row(i).minCoeff() >= 0))
      return fmt::format("{}: its goal has no colour, or a negative one", point_text(p, i));
  return std::nullopt;
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
  if (p.start_level.size() != 0 && p.start_level.size() != lights)
    return size("start_level", p.start_level.size(), lights);
  if (auto text = entries(p.start_level, "start_level")) return text;
  if (p.watts.size() != lights) return size("watts", p.watts.size(), lights);
  if (auto text = entries(p.watts, "watts")) return text;
  if (!(p.max_watts >= 0)) return fmt::format("a limit of {:g} W", p.max_watts);
  if (static_cast<Index>(p.switched.size()) != lights)
    return size("switched", static_cast<Index>(p.switched.size()), lights);
  if (auto text = complaint_of_colour(p)) return text;
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
  if (p.watts.size() == 0) p.watts = VectorXd::Zero(lights);
  if (p.switched.empty()) p.switched.assign(static_cast<std::size_t>(lights), false);
  if (!p.rgb_per_level.empty() && p.fixed_rgb.size() == 0) p.fixed_rgb = MatrixXd::Zero(points, 3);
  return p;
}

double power_of_two_near(double value) { return value > 0 ? std::ldexp(1.0, std::ilogb(value)) : 0; }

/// The problem in variables z_j = level_j · unit_j, in which every light's column and the right-hand side are about 1.
struct ScaledProblem {
  LimitedLeastSquares least_squares;
  MatrixXd objective;  ///< W T without tie rows
  VectorXd target;     ///< W (g − b)
  VectorXd unit;
  VectorXd rounding;           ///< per row of G: rounding error of sums, with a margin
  std::vector<Index> limited;  ///< points of the rows of G, except a last one that limits power
};

bool power_limited(const EmittanceProblem& p) {
  return std::isfinite(p.max_watts) && p.watts.size() > 0 && p.watts.maxCoeff() > 0;
}

/// W T and W (g − b) of the points with goals; with colour, channel after channel.
void set_goals(const EmittanceProblem& p, const std::vector<Index>& goals, ScaledProblem& s) {
  const Index channels = p.rgb_per_level.empty() ? 1 : 3;
  s.objective.resize(static_cast<Index>(goals.size()) * channels, p.lux_per_level.cols());
  s.target.resize(s.objective.rows());
  Index row = 0;
  // Lights only add: a point that exceeds its goal without them asks for none, and does not hold others down.
  for (const Index i : goals) {
    if (channels == 1) {
      s.objective.row(row) = p.weight[i] * p.lux_per_level.row(i);
      s.target[row++] = p.weight[i] * std::max(0.0, p.goal_lx[i] - p.fixed_lx[i]);
      continue;
    }
    const double weight = p.weight[i] / std::sqrt(3.0);
    for (Index c = 0; c < 3; ++c) {
      s.objective.row(row) = weight * p.rgb_per_level[static_cast<std::size_t>(c)].row(i);
      s.target[row++] = weight * std::max(0.0, p.goal_lx[i] * p.goal_rgb(i, c) - p.fixed_rgb(i, c));
    }
  }
}

ScaledProblem scaled(const EmittanceProblem& p) {
  ScaledProblem s;
  const Index lights = p.lux_per_level.cols();
  std::vector<Index> goals;
  for (Index i = 0; i < p.goal_lx.size(); ++i) {
    if (!std::isnan(p.goal_lx[i]) && p.weight[i] > 0) goals.push_back(i);
    if (std::isfinite(p.max_lx[i]) && p.lux_per_level.row(i).size() > 0 && p.lux_per_level.row(i).maxCoeff() > 0)
      s.limited.push_back(i);
  }
  set_goals(p, goals, s);
  const auto rows = s.objective.rows(), limits = static_cast<Index>(s.limited.size());
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
  if (p.start_level.size() > 0) q.start = p.start_level.cwiseProduct(s.unit);
  q.G.resize(limits + (power_limited(p) ? 1 : 0), lights);
  q.slack.resize(q.G.rows());
  s.rounding.resize(q.G.rows());
  const double rounding = 4 * static_cast<double>(lights + 4) * std::numeric_limits<double>::epsilon();
  for (Index k = 0; k < limits; ++k) {
    const Index i = s.limited[static_cast<std::size_t>(k)];
    q.G.row(k) = p.lux_per_level.row(i).cwiseQuotient(s.unit.transpose());
    const double norm = power_of_two_near(q.G.row(k).stableNorm());
    q.G.row(k) /= norm;
    q.slack[k] = (p.max_lx[i] - p.fixed_lx[i]) / norm;
    s.rounding[k] = rounding * p.max_lx[i] / norm;
  }
  if (power_limited(p)) {
    q.G.row(limits) = p.watts.cwiseQuotient(s.unit).transpose();
    const double norm = power_of_two_near(q.G.row(limits).stableNorm());
    q.G.row(limits) /= norm;
    q.slack[limits] = p.max_watts / norm;
    s.rounding[limits] = rounding * q.slack[limits];
  }
  return s;
}

/// Sets the switched lights and leaves a problem of the dimmable ones. Also returns the light if all could dim.
Result<LightAtPoints> set_switched(const EmittanceProblem& p, ScaledProblem& s, VectorXd& level,
                                   EmittanceSolution& solution, const Watch& watch) {
  std::vector<Index> switched;
  for (Index j = 0; j < level.size(); ++j)
    if (p.switched[static_cast<std::size_t>(j)]) switched.push_back(j);
  LimitedLeastSquares with_room = s.least_squares;
  with_room.slack = (with_room.slack - s.rounding).cwiseMax(0);
  SwitchedSettings settings = solve_switched_least_squares(with_room, switched, watch.stop);
  if (settings.stopped) return tl::unexpected(fault(Cause::cancelled, "stopped on request"));
  solution.switches_proven = settings.proven;
  solution.iterations += settings.nodes;
  for (const Index j : switched) {
    if (!settings.on[static_cast<std::size_t>(j)]) continue;
    level[j] = p.max_level[j];
    s.target -= s.objective.col(j) * s.least_squares.upper[j];
  }
  s.least_squares = with_set(s.least_squares, switched, settings.on);
  s.least_squares.slack = s.least_squares.slack.cwiseMax(0);
  return light_at_points(p, settings.relaxed.cwiseQuotient(s.unit).cwiseMin(p.max_level));
}

VectorXd levels_of(const EmittanceProblem& p, const ScaledProblem& s, const LimitedLeastSquaresResult& at) {
  VectorXd level = at.z.cwiseQuotient(s.unit).cwiseMin(p.max_level);
  for (Index j = 0; j < level.size(); ++j)
    if (at.state[static_cast<std::size_t>(j)] == BoundState::upper && s.least_squares.upper[j] > 0)
      level[j] = p.max_level[j];
  return level;
}

/// Removes the last rounding from dimmable lights: row · c ≤ room then holds for any order of summation, since the
/// remaining room is more than the error of a sum of that many terms. Switched lights alone are below it (they were set
/// with that room).
void keep_limit(const Eigen::RowVectorXd& row, double room, const std::vector<bool>& switched, VectorXd& level) {
  double set = 0;
  for (Index j = 0; j < level.size(); ++j)
    if (switched[static_cast<std::size_t>(j)]) set += row[j] * level[j];
  for (int attempt = 0;; ++attempt) {
    const double used = row.dot(level), dims = used - set, left = room - set;
    if (used <= room || dims <= 0) return;
    const double share = left <= 0 || attempt > 20 ? 0 : left / dims * (1 - 4 * std::numeric_limits<double>::epsilon());
    for (Index j = 0; j < level.size(); ++j)
      if (row[j] > 0 && !switched[static_cast<std::size_t>(j)]) level[j] *= share;
    if (share == 0) return;
  }
}

void keep_limits(const EmittanceProblem& p, VectorXd& level) {
  const double rounding = static_cast<double>(level.size() + 4) * std::numeric_limits<double>::epsilon();
  for (Index i = 0; i < p.max_lx.size(); ++i)
    if (std::isfinite(p.max_lx[i]))
      keep_limit(p.lux_per_level.row(i), (p.max_lx[i] - p.fixed_lx[i]) - rounding * p.max_lx[i], p.switched, level);
  if (power_limited(p)) keep_limit(p.watts.transpose(), p.max_watts * (1 - rounding), p.switched, level);
}

/// Largest violation of stationarity, signs and complementarity of the problem without the tie term, in scaled
/// variables: relative to the columns' norms times the norm of the right-hand side.
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

/// Light of the same problem with some constraints lifted.
Result<LightAtPoints> light_without(EmittanceProblem p, bool max_lx, bool max_level, bool max_watts,
                                    const Watch& watch) {
  if (max_lx) p.max_lx.setConstant(kInfinity);
  if (max_level) p.max_level.setConstant(kInfinity);
  if (max_watts) p.max_watts = kInfinity;
  const ScaledProblem s = scaled(p);
  const LimitedLeastSquaresResult at = solve_limited_least_squares(s.least_squares, watch.stop);
  if (at.stopped) return tl::unexpected(fault(Cause::cancelled, "stopped on request"));
  return light_at_points(p, levels_of(p, s, at));
}

Result<WhatIf> what_if_lifted(const EmittanceProblem& p, const Held& held, const Watch& watch) {
  WhatIf what_if;
  const auto solve = [&](bool max_lx, bool max_level, bool max_watts, LightAtPoints& light) -> Result<void> {
    auto lifted = light_without(p, max_lx, max_level, max_watts, watch);
    if (!lifted) return tl::unexpected(lifted.error());
    light = std::move(*lifted);
    return {};
  };
  if (auto done = solve(true, false, false, what_if.no_max_lx); !done) return tl::unexpected(done.error());
  if (auto done = solve(false, true, false, what_if.no_max_level); !done) return tl::unexpected(done.error());
  if (auto done = solve(true, true, true, what_if.none); !done) return tl::unexpected(done.error());
  if (!held.power) return what_if;
  if (auto done = solve(false, false, true, what_if.no_max_watts); !done) return tl::unexpected(done.error());
  return what_if;
}

Held held_at(const EmittanceProblem& p, const VectorXd& level, const VectorXd& lux) {
  constexpr double kTouching = 1e-6;
  Held held;
  for (Index i = 0; i < lux.size(); ++i) held.point.push_back(lux[i] >= p.max_lx[i] * (1 - kTouching));
  for (Index j = 0; j < level.size(); ++j) held.light_at_max.push_back(level[j] >= p.max_level[j] * (1 - kTouching));
  held.power = power_limited(p) && p.watts.dot(level) >= p.max_watts * (1 - kTouching);
  return held;
}

}  // namespace

Result<EmittanceSolution> solve_emittance(const EmittanceProblem& given, const Watch& watch) {
  const EmittanceProblem p = completed(given);
  if (auto text = complaint(p)) return tl::unexpected(fault(Cause::invalid, *text));

  ScaledProblem s = scaled(p);
  EmittanceSolution solution;
  VectorXd set = VectorXd::Zero(p.lux_per_level.cols());
  std::optional<LightAtPoints> could_all_dim;
  if (std::find(p.switched.begin(), p.switched.end(), true) != p.switched.end()) {
    auto light = set_switched(p, s, set, solution, watch);
    if (!light) return tl::unexpected(std::move(light.error()));
    could_all_dim = std::move(*light);
  }
  const LimitedLeastSquaresResult at = solve_limited_least_squares(s.least_squares, watch.stop);
  if (at.stopped) return tl::unexpected(fault(Cause::cancelled, "stopped on request"));

  solution.level = levels_of(p, s, at) + set;
  keep_limits(p, solution.level);
  solution.iterations += at.iterations;
  solution.kkt_residual = kkt_residual(s, at, solution.level - set);

  const LightAtPoints light = light_at_points(p, solution.level);
  const Held held = held_at(p, solution.level, light.lux);
  std::optional<WhatIf> what_if;
  double error = 0, goals = 0;
  for (Index i = 0; i < light.lux.size(); ++i) {
    PointOutcome outcome;
    outcome.lux = light.lux[i];
    if (!std::isnan(p.goal_lx[i])) {
      outcome.shortfall_lx = p.goal_lx[i] - outcome.lux;
      error = std::hypot(error, distance_lx(p, i, light));
      goals = std::hypot(goals, goal_norm_lx(p, i));
    }
    if (p.explained && misses_goal(p, i, light)) {
      if (!what_if) {
        auto lifted = what_if_lifted(p, held, watch);
        if (!lifted) return tl::unexpected(lifted.error());
        what_if = std::move(*lifted);
        what_if->could_all_dim = std::move(could_all_dim);
      }
      explain(p, solution.level, held, *what_if, light, i, outcome);
    }
    solution.points.push_back(std::move(outcome));
  }
  solution.normalised_error = goals > 0 ? error / goals : 0;
  if (watch.progress) watch.progress(1);
  return solution;
}

}  // namespace luxrig
