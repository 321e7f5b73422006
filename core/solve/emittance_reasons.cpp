#include "core/solve/emittance_reasons.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kMet = 0.01;
constexpr std::size_t kMostNames = 3;  ///< in a sentence; the lists have them all

std::string name_of(const std::vector<std::string>& names, int index, const char* kind) {
  const auto at = static_cast<std::size_t>(index);
  return at < names.size() ? fmt::format("'{}'", names[at]) : fmt::format("{} {}", kind, index);
}

std::string list(const std::vector<std::string>& names, const std::vector<int>& indices, const char* kind) {
  std::string text;
  for (std::size_t k = 0; k < std::min(indices.size(), kMostNames); ++k)
    text += (k == 0 ? "" : ", ") + name_of(names, indices[k], kind);
  if (indices.size() > kMostNames) text += fmt::format(" and {} more", indices.size() - kMostNames);
  return text;
}

std::string limits_text(const EmittanceProblem& problem, const std::vector<int>& points) {
  std::string text;
  for (std::size_t k = 0; k < std::min(points.size(), kMostNames); ++k)
    text += fmt::format("{}the limit of {:.4g} lx at {}", k == 0 ? "" : ", ", problem.max_lx[points[k]],
                        name_of(problem.point_name, points[k], "point"));
  if (points.size() > kMostNames) text += fmt::format(" and {} more", points.size() - kMostNames);
  return text;
}

bool share_a_light(const EmittanceProblem& problem, Index one, Index other) {
  return (problem.lux_per_level.row(one).array() > 0 && problem.lux_per_level.row(other).array() > 0).any();
}

}  // namespace

bool misses_goal(const EmittanceProblem& problem, Index point, double lux) {
  const double goal = problem.goal_lx[point];
  if (std::isnan(goal)) return false;
  double scale = goal;
  if (goal == 0)
    for (const double other : problem.goal_lx) scale = std::max(scale, std::isnan(other) ? 0 : other);
  return std::abs(goal - lux) > kMet * scale;
}

void explain(const EmittanceProblem& problem, const VectorXd& level, const Held& held, const WhatIf& what_if,
             Index point, PointOutcome& outcome) {
  const auto row = problem.lux_per_level.row(point);
  const double goal = problem.goal_lx[point];
  const double miss = std::abs(outcome.shortfall_lx);
  const bool dark = outcome.shortfall_lx > 0;
  const std::string wanted = fmt::format("goal {:.4g} lx", goal);

  for (Index j = 0; j < row.size(); ++j)
    if (row[j] > 0 && held.light_at_max[static_cast<std::size_t>(j)])
      outcome.limit_lights.push_back(static_cast<int>(j));
  for (Index i = 0; i < problem.lux_per_level.rows(); ++i)
    if (held.point[static_cast<std::size_t>(i)] && (i == point || share_a_light(problem, i, point)))
      outcome.limit_points.push_back(static_cast<int>(i));

  const auto set = [&](Binding binding, bool points, bool lights, std::string reason) {
    outcome.binding = binding;
    if (!points) outcome.limit_points.clear();
    if (!lights) outcome.limit_lights.clear();
    outcome.reason = std::move(reason);
  };

  if (dark && !(row.size() > 0 && row.maxCoeff() > 0))
    return set(Binding::out_of_reach, false, false,
               fmt::format("no light reaches it: {:.4g} lx there anyway, {}", outcome.lux, wanted));
  const bool all_off = !(row.size() > 0 && (row.transpose().array() > 0 && level.array() > 0).any());
  if (!dark && (all_off || misses_goal(problem, point, std::max(goal, problem.fixed_lx[point]))))
    return set(Binding::min_level, false, false,
               fmt::format("{:.4g} lx are there with all its lights off, {}", problem.fixed_lx[point], wanted));

  // Which relief would help? More than half of the miss gone counts as "it binds".
  const auto left = [&](const VectorXd& lux) { return std::abs(goal - lux[point]); };
  const double without_limits = left(what_if.no_max_lx), without_levels = left(what_if.no_max_level);
  const bool limits = without_limits < 0.5 * miss && !outcome.limit_points.empty();
  const bool levels = without_levels < 0.5 * miss && !outcome.limit_lights.empty();
  const bool together = left(what_if.neither) < 0.5 * miss;
  const bool own = dark && held.point[static_cast<std::size_t>(point)];
  const std::string verb = fmt::format("held at {:.4g} lx by", outcome.lux);

  if (own && (limits || together))
    return set(Binding::max_lux_here, true, false,
               fmt::format("{} its own limit of {:.4g} lx, {}", verb, problem.max_lx[point], wanted));
  if (limits && (!levels || without_limits <= without_levels))
    return set(Binding::max_lux_elsewhere, true, levels,
               fmt::format("{} {}, {}", verb, limits_text(problem, outcome.limit_points), wanted));
  if (levels)
    return set(Binding::max_level, limits, true,
               fmt::format("{} the highest level of {}, {}", verb,
                           list(problem.light_name, outcome.limit_lights, "light"), wanted));
  if (together && !outcome.limit_points.empty() && !outcome.limit_lights.empty())
    return set(
        Binding::max_lux_elsewhere, true, true,
        fmt::format("{} {} together with the highest level of {}, {}", verb, limits_text(problem, outcome.limit_points),
                    list(problem.light_name, outcome.limit_lights, "light"), wanted));
  if (problem.weight[point] == 0)
    return set(Binding::traded, false, false, fmt::format("its weight is 0: {:.4g} lx, {}", outcome.lux, wanted));
  set(Binding::traded, false, false,
      fmt::format("{:.4g} lx is the compromise with the goals of other points that the same lights reach, {}",
                  outcome.lux, wanted));
}

}  // namespace luxrig
