#include "core/solve/emittance_reasons.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/photometry/light_colour.h"
#include "core/solve/least_squares/nnls.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMet = 0.01;
constexpr std::size_t kMaxNames = 3;  ///< in a sentence; the lists have all of them

std::string name_of(const std::vector<std::string>& names, int index, const char* kind) {
  const auto at = static_cast<std::size_t>(index);
  return at < names.size() ? fmt::format("'{}'", names[at]) : fmt::format("{} {}", kind, index);
}

std::string list(const std::vector<std::string>& names, const std::vector<int>& indices, const char* kind) {
  std::string text;
  for (std::size_t k = 0; k < std::min(indices.size(), kMaxNames); ++k)
    text += (k == 0 ? "" : ", ") + name_of(names, indices[k], kind);
  if (indices.size() > kMaxNames) text += fmt::format(" and {} more", indices.size() - kMaxNames);
  return text;
}

std::string limits_text(const EmittanceProblem& problem, const std::vector<int>& points) {
  std::string text;
  for (std::size_t k = 0; k < std::min(points.size(), kMaxNames); ++k)
    text += fmt::format("{}the limit of {:.4g} lx at {}", k == 0 ? "" : ", ", problem.max_lx[points[k]],
                        name_of(problem.point_name, points[k], "point"));
  if (points.size() > kMaxNames) text += fmt::format(" and {} more", points.size() - kMaxNames);
  return text;
}

bool share_a_light(const EmittanceProblem& problem, Index one, Index other) {
  return (problem.lux_per_level.row(one).array() > 0 && problem.lux_per_level.row(other).array() > 0).any();
}

Vec3 goal_rgb_lx(const EmittanceProblem& problem, Index point) {
  return problem.goal_lx[point] * problem.goal_rgb.row(point).transpose();
}

/// "312 lx", and its colour if that matters.
std::string light_text(double lux, const std::optional<Vec3>& rgb) {
  if (!rgb || !(rgb->sum() > 0)) return fmt::format("{:.4g} lx", lux);
  const Chromaticity xy = xy_of_rgb(*rgb);
  return fmt::format("{:.4g} lx of xy ({:.3f}, {:.3f})", lux, xy.x(), xy.y());
}

double met_within_lx(const EmittanceProblem& problem, Index point) {
  double scale = goal_norm_lx(problem, point);
  if (scale == 0)
    for (const double other : problem.goal_lx) scale = std::max(scale, std::isnan(other) ? 0 : other);
  return kMet * scale;
}

/// Distance of the nearest mix of the lights that reach a point, with free levels.
double nearest_mix_lx(const EmittanceProblem& problem, Index point) {
  MatrixXd columns(3, problem.lux_per_level.cols());
  for (Index c = 0; c < 3; ++c) columns.row(c) = problem.rgb_per_level[static_cast<std::size_t>(c)].row(point);
  const VectorXd wanted = (goal_rgb_lx(problem, point) - problem.fixed_rgb.row(point).transpose());
  return solve_nnls(columns, wanted).residual_norm / std::sqrt(3.0);
}

}  // namespace

LightAtPoints light_at_points(const EmittanceProblem& problem, const VectorXd& level) {
  LightAtPoints light{problem.lux_per_level * level + problem.fixed_lx, {}};
  if (problem.rgb_per_level.empty()) return light;
  light.rgb = problem.fixed_rgb;
  for (Index c = 0; c < 3; ++c) light.rgb.col(c) += problem.rgb_per_level[static_cast<std::size_t>(c)] * level;
  return light;
}

double distance_lx(const EmittanceProblem& problem, Index point, const LightAtPoints& light) {
  if (light.rgb.size() == 0) return std::abs(problem.goal_lx[point] - light.lux[point]);
  return (goal_rgb_lx(problem, point) - light.rgb.row(point).transpose()).norm() / std::sqrt(3.0);
}

double goal_norm_lx(const EmittanceProblem& problem, Index point) {
  if (problem.rgb_per_level.empty()) return problem.goal_lx[point];
  return goal_rgb_lx(problem, point).norm() / std::sqrt(3.0);
}

bool misses_goal(const EmittanceProblem& problem, Index point, const LightAtPoints& light) {
  return !std::isnan(problem.goal_lx[point]) && distance_lx(problem, point, light) > met_within_lx(problem, point);
}

void explain(const EmittanceProblem& problem, const VectorXd& level, const Held& held, const WhatIf& what_if,
             const LightAtPoints& light, Index point, PointOutcome& outcome) {
  const auto row = problem.lux_per_level.row(point);
  const bool coloured = light.rgb.size() > 0;
  const double goal = problem.goal_lx[point], miss = distance_lx(problem, point, light);
  const bool dark = outcome.shortfall_lx > 0;
  const auto text_of = [&](double lux, const MatrixXd& rgb) {
    return light_text(lux, coloured ? std::optional<Vec3>(rgb.row(point).transpose()) : std::nullopt);
  };
  const std::string wanted = "goal " + text_of(goal, problem.goal_rgb), is = text_of(outcome.lux, light.rgb);

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
               fmt::format("no light reaches it: {} there anyway, {}", is, wanted));
  const bool all_off = !(row.size() > 0 && (row.transpose().array() > 0 && level.array() > 0).any());
  const double too_bright_lx = problem.fixed_lx[point] - goal;
  if (!dark && (all_off || too_bright_lx > met_within_lx(problem, point)))
    return set(Binding::min_level, false, false,
               fmt::format("{} are there with all its lights off, {}",
                           text_of(problem.fixed_lx[point], problem.fixed_rgb), wanted));

  // Which relief would help? "It binds" if more than half of the miss goes.
  const auto left = [&](const LightAtPoints& lifted) { return distance_lx(problem, point, lifted); };
  const double without_limits = left(what_if.no_max_lx), without_levels = left(what_if.no_max_level);
  const double without_power = held.power ? left(what_if.no_max_watts) : miss;
  const bool limits = without_limits < 0.5 * miss && !outcome.limit_points.empty();
  const bool levels = without_levels < 0.5 * miss && !outcome.limit_lights.empty();
  const bool power = without_power < 0.5 * miss;
  const bool together = left(what_if.none) < 0.5 * miss;
  const bool own = dark && held.point[static_cast<std::size_t>(point)];
  const std::string verb = fmt::format("held at {} by", is);
  const std::string of_power = fmt::format("the limit of {:g} W on power", problem.max_watts);

  std::vector<int> switched;
  for (Index j = 0; j < row.size(); ++j)
    if (row[j] > 0 && problem.switched[static_cast<std::size_t>(j)]) switched.push_back(static_cast<int>(j));
  if (!switched.empty() && what_if.could_all_dim && left(*what_if.could_all_dim) < 0.5 * miss)
    return set(Binding::switched, false, false,
               fmt::format("{} is the nearest while {} can only be on or off, {}", is,
                           list(problem.light_name, switched, "light"), wanted));
  if (own && (limits || (together && !power)))
    return set(Binding::max_lux_here, true, false,
               fmt::format("{} its own limit of {:.4g} lx, {}", verb, problem.max_lx[point], wanted));
  if (power && (!limits || without_power <= without_limits) && (!levels || without_power <= without_levels))
    return set(Binding::power, false, false, fmt::format("{} {}, {}", verb, of_power, wanted));
  if (limits && (!levels || without_limits <= without_levels))
    return set(Binding::max_lux_elsewhere, true, levels,
               fmt::format("{} {}, {}", verb, limits_text(problem, outcome.limit_points), wanted));
  if (levels)
    return set(Binding::max_level, limits, true,
               fmt::format("{} the highest level of {}, {}", verb,
                           list(problem.light_name, outcome.limit_lights, "light"), wanted));
  const bool any_points = !outcome.limit_points.empty(), any_lights = !outcome.limit_lights.empty();
  if (together && any_points + any_lights + held.power > 1) {
    std::vector<std::string> parts;
    if (any_points) parts.push_back(limits_text(problem, outcome.limit_points));
    if (any_lights) parts.push_back("the highest level of " + list(problem.light_name, outcome.limit_lights, "light"));
    if (held.power) parts.push_back(of_power);
    return set(any_points ? Binding::max_lux_elsewhere : Binding::power, true, true,
               fmt::format("{} {}, {}", verb, fmt::join(parts, " together with "), wanted));
  }
  if (problem.weight[point] == 0)
    return set(Binding::traded, false, false, fmt::format("its weight is 0: {}, {}", is, wanted));
  if (coloured && nearest_mix_lx(problem, point) > 0.5 * miss)
    return set(Binding::colour, false, false,
               fmt::format("no mix of the lights that reach it comes nearer in colour than {}, {}", is, wanted));
  set(Binding::traded, false, false,
      fmt::format("{} is the compromise with the goals of other points that the same lights reach, {}", is, wanted));
}

}  // namespace luxrig
