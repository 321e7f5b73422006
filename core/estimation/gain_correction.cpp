/// GainEstimator::correct(): new levels from readings.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/estimation/gain_estimator.h"
#include "core/rig/point_goals.h"
#include "core/solve/emittance.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr double kMeteredWeight = 30;  ///< a metered goal comes before unmetered ones
/// Weight of "stay at the present level" against an unmetered goal, in units of the fixture's brightest point. Without
/// it, such goals move levels so far in one round that the next reading surprises (of 500 simulated rigs, five instead
/// of one or none missed a metered goal by more than 2 % after three rounds).
constexpr double kCaution = 0.5;
/// A metered goal that is missed by this share all the same may draw no unmetered one away from the compromise by more
/// than so many standard errors of the model's light there: then it no longer comes first.
constexpr double kMissed = 0.05, kDrawnAway = 2;
/// Slightly above 1, so that rounding does not call for a second cut.
constexpr double kAbove = 1 + 1e-12;
/// A limit that binds may leave this share unused; more is worth another solve. One that is exceeded by less than
/// kRoomOver is not: all light that is too much is dimmed away at the end.
constexpr double kRoomLeft = 0.005, kRoomOver = 0.001;

/// Where the lights of `set` alone exceed a limit, those in `dims` all dim by the same share. If that does not suffice,
/// the brightest at that point go off.
void keep_within(const VectorXd& max_lx, const VectorXd& daylight_lx, const MatrixXd& lux_per_level,
                 const std::vector<Index>& dims, VectorXd& set) {
  for (Index i = 0; i < lux_per_level.rows(); ++i) {
    const double over_lx = daylight_lx[i] + lux_per_level.row(i).dot(set) - max_lx[i];
    double dims_lx = 0;
    for (const Index k : dims) dims_lx += lux_per_level(i, k) * set[k];
    for (const Index k : dims)
      if (over_lx > 0 && lux_per_level(i, k) * set[k] > 0) set[k] *= std::max(0.0, 1 - over_lx / dims_lx * kAbove);
    while (set.size() > 0 && daylight_lx[i] + lux_per_level.row(i).dot(set) > max_lx[i]) {
      Index brightest = 0;
      if (!(lux_per_level.row(i).cwiseProduct(set.transpose()).maxCoeff(&brightest) > 0)) break;
      set[brightest] = 0;
    }
  }
}

}  // namespace

/// Fixtures × lights: level of a fixture per level of a light. Emitters of one housing are one light, at their present
/// shares (a meter sees no colour, and must not change it). A dark housing stays dark.
MatrixXd GainEstimator::fixtures_per_light(const VectorXd& present) const {
  MatrixXd per_light = MatrixXd::Zero(fixtures(), fixtures());
  Index lights = 0;
  for (Index first = 0, end = 0; first < fixtures(); first = end) {
    const std::size_t housing = housing_[static_cast<std::size_t>(first)];
    while (end < fixtures() && housing_[static_cast<std::size_t>(end)] == housing) ++end;
    const auto levels = present.segment(first, end - first);
    const double brightest = levels.maxCoeff();
    if (end - first == 1) {
      per_light(first, lights++) = 1;
    } else if (brightest > 0) {
      per_light.block(first, lights++, end - first, 1) = levels / brightest;
    }
  }
  return per_light.leftCols(lights);
}

/// Why the levels that `problem` asks for miss goals. on_or_off, held: lights, which are set as in `set`.
void GainEstimator::explain(const EmittanceProblem& problem, const MatrixXd& lux_per_level,
                            const std::vector<Index>& on_or_off, const std::vector<Index>& held, const VectorXd& set,
                            const std::vector<Row>& rows, Correction& correction) const {
  const auto solution = solve_emittance(problem);
  if (!solution) return;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const PointOutcome& outcome = solution->points[i];
    std::string& why = correction.why[i];
    why = outcome.reason;
    if (why.empty()) continue;
    for (const Index k : on_or_off)
      if (set[k] == 0 && lux_per_level(static_cast<Index>(i), k) > 0)
        why += fmt::format(" ('{}', which is on or off, stays off)", problem.light_name[static_cast<std::size_t>(k)]);
    std::string by_hand;
    for (const Index k : held)
      if (lux_per_level(static_cast<Index>(i), k) > 0)
        by_hand += fmt::format("{}'{}'", by_hand.empty() ? "" : ", ", problem.light_name[static_cast<std::size_t>(k)]);
    if (!by_hand.empty()) why += fmt::format(" ({} held by hand)", by_hand);
    if (outcome.limit_points.empty()) continue;
    const auto first = static_cast<std::size_t>(outcome.limit_points.front());
    why += fmt::format(" (of the limit of {:.4g} lx, {:.3g} lx are kept free for the error of {})",
                       *points_[first].max_lx, *points_[first].max_lx - problem.max_lx[static_cast<Index>(first)],
                       rows[first].luxmeter ? "the meter" : "the model: no meter confirms it");
  }
}

Correction GainEstimator::correct(std::span<const double> present, Time now, For what) const {
  EmittanceProblem problem;
  problem.explained = false;
  const auto points = static_cast<Index>(points_.size());
  const VectorXd present_level = vector_of(present).head(fixtures()).cwiseMax(0).cwiseMin(max_level_);
  const MatrixXd per_light = fixtures_per_light(present_level);
  // After the points, one row per light, whose goal is its present level.
  const Index lights = per_light.cols(), all = points + lights;
  problem.lux_per_level.setZero(all, lights);
  problem.fixed_lx.setZero(all);
  problem.goal_lx.setConstant(all, std::numeric_limits<double>::quiet_NaN());
  problem.weight.setConstant(all, kCaution);
  problem.max_lx.setConstant(all, std::numeric_limits<double>::infinity());
  problem.max_level.resize(lights);
  problem.near_level.resize(lights);
  std::vector<Index> on_or_off, held;
  std::vector<std::size_t> brightest_of;  // per light, the fixture whose name it has
  for (Index k = 0; k < lights; ++k) {
    Index brightest = 0;
    per_light.col(k).maxCoeff(&brightest);  // its share is 1
    problem.near_level[k] = present_level[brightest];
    problem.max_level[k] = std::numeric_limits<double>::infinity();
    for (Index j = 0; j < fixtures(); ++j)
      if (per_light(j, k) > 0) problem.max_level[k] = std::min(problem.max_level[k], max_level_[j] / per_light(j, k));
    brightest_of.push_back(static_cast<std::size_t>(brightest));
    bool by_hand = false;
    for (Index j = 0; j < fixtures(); ++j)
      by_hand = by_hand || (per_light(j, k) > 0 && held_[static_cast<std::size_t>(j)] != 0);
    if (switched_[static_cast<std::size_t>(brightest)] != 0) {
      on_or_off.push_back(k);
    } else if (by_hand) {
      held.push_back(k);
    }
  }
  problem.watts = (watts_.transpose() * per_light).transpose();
  problem.max_watts = max_watts_;
  std::vector<Row> rows;
  const PointGoals asked = point_goals(points_, false);
  problem.goal_lx.head(points) = asked.goal_lx;
  for (Index i = 0; i < points; ++i) {
    rows.push_back(row_of_point(static_cast<std::size_t>(i)));
    const RowVectorXd lux = rows.back().lux_per_level.cwiseProduct(rows.back().factor);
    problem.lux_per_level.row(i) = lux.head(fixtures()) * per_light;
    if (lux.size() > fixtures()) problem.fixed_lx[i] = lux[fixtures()];
    problem.weight[i] = asked.weight[i] * (rows.back().luxmeter ? kMeteredWeight : 1);
  }
  for (Index j = 0; j < lights && points > 0; ++j) {
    const double brightest = problem.lux_per_level.col(j).head(points).maxCoeff();
    problem.lux_per_level(points + j, j) = brightest;
    if (brightest > 0 && what != For::hands) problem.goal_lx[points + j] = brightest * problem.near_level[j];
  }

  // Lamps that do not respond are fixed light.
  for (Index k = 0; k < lights; ++k) {
    Index brightest = 0;
    per_light.col(k).maxCoeff(&brightest);
    if (!is_lost(brightest)) continue;
    problem.fixed_lx.head(points) += problem.lux_per_level.col(k).head(points) * problem.near_level[k];
    problem.lux_per_level.col(k).setZero();
    problem.goal_lx[points + k] = std::numeric_limits<double>::quiet_NaN();
    problem.near_level[k] = problem.max_level[k] = 0;
    std::erase(on_or_off, k);
    std::erase(held, k);
  }
  // So are on-or-off lamps and those held by hand.
  const VectorXd daylight_lx = problem.fixed_lx.head(points);
  const MatrixXd lux_per_level = problem.lux_per_level.topRows(points);
  VectorXd set = VectorXd::Zero(lights);
  for (const Index k : on_or_off) set[k] = problem.near_level[k] < 1 ? 0 : 1;
  for (const Index k : held) set[k] = problem.near_level[k];
  std::vector<Index> fixed = on_or_off;
  fixed.insert(fixed.end(), held.begin(), held.end());
  for (const Index k : fixed) {
    problem.lux_per_level.col(k).setZero();
    problem.goal_lx[points + k] = std::numeric_limits<double>::quiet_NaN();
    problem.near_level[k] = problem.max_level[k] = 0;
  }

  Correction correction;
  correction.why.resize(points_.size());
  VectorXd level = problem.near_level + set;
  const auto lux_at = [&](Index i, const VectorXd& of) { return daylight_lx[i] + lux_per_level.row(i).dot(of); };
  std::optional<VectorXd> compromise;  // in which no goal comes first: what a plan would ask for
  const auto is_drawn_away = [&](Index i) {
    const Row& row = rows[static_cast<std::size_t>(i)];
    if (row.luxmeter || !std::isfinite(problem.goal_lx[i])) return false;
    const double error_lx = kDrawnAway * predict(row, vector_of(list_of(per_light * level))).standard_error_lx;
    if (std::abs(lux_at(i, level) - problem.goal_lx[i]) <= error_lx) return false;
    if (!compromise) {
      EmittanceProblem equal = problem;
      equal.weight.head(points) = asked.weight;
      const auto solution = solve_emittance(equal);
      compromise = solution ? VectorXd(solution->level + set) : level;
    }
    return std::abs(lux_at(i, level) - lux_at(i, *compromise)) > error_lx;
  };
  /// Whether a metered goal lost its precedence.
  const auto give_way = [&] {
    std::vector<Index> missed;
    for (Index i = 0; i < points; ++i)
      if (rows[static_cast<std::size_t>(i)].luxmeter && problem.weight[i] > asked.weight[i] &&
          std::abs(lux_at(i, level) - problem.goal_lx[i]) > kMissed * problem.goal_lx[i])
        missed.push_back(i);
    bool any = false;
    for (Index i = 0; !missed.empty() && !any && i < points; ++i) any = is_drawn_away(i);
    for (const Index i : missed)
      if (any) problem.weight[i] = asked.weight[i];
    return any;
  };
  // Limits hold for the worst case, which depends on the new levels: solve, check, set anew, solve again.
  VectorXd max_lx = problem.max_lx;
  VectorXd day_lx = VectorXd::Zero(points);  // of daylight and lost lamps, at most
  for (Index i = 0; i < points; ++i)
    if (points_[static_cast<std::size_t>(i)].max_lx)
      day_lx[i] = max_without_fixtures(rows[static_cast<std::size_t>(i)], now);
  problem.start_level = problem.near_level;
  for (int round = 0; round < kLimitRounds; ++round) {
    bool again = round == 0;
    const VectorXd at_level = vector_of(list_of(per_light * level));
    for (Index i = 0; i < points; ++i) {
      const auto& limit_lx = points_[static_cast<std::size_t>(i)].max_lx;
      if (!limit_lx) continue;
      const Row& row = rows[static_cast<std::size_t>(i)];
      const double room = std::max(0.0, *limit_lx - day_lx[i]);
      const double lux = lux_per_level.row(i).dot(level);
      const double most = max_lux(row, at_level, now) - day_lx[i];
      const bool binds = round > 0 && daylight_lx[i] + lux > (1 - kRoomLeft) * problem.max_lx[i];
      again = again || most > room * (1 + kRoomOver) || (binds && most < (1 - kRoomLeft) * room);
      max_lx[i] = daylight_lx[i] + (lux > 0 && most > 0 ? room * std::min(1.0, lux / most) : room / local_);
    }
    if (round > 0 && give_way()) again = true;
    if (!again) break;
    problem.max_lx = max_lx;
    keep_within(problem.max_lx, daylight_lx, lux_per_level, held, set);
    problem.fixed_lx.head(points) = daylight_lx + lux_per_level * set;
    problem.max_lx = problem.max_lx.cwiseMax(problem.fixed_lx);  // already so, except for rounding
    problem.max_watts = std::max(0.0, max_watts_ - problem.watts.dot(set));
    const auto solution = solve_emittance(problem);
    if (!solution) break;
    level = solution->level + set;
    problem.start_level = solution->level;
  }
  if (what != For::drift) {
    problem.explained = true;
    for (const std::size_t fixture : brightest_of) problem.light_name.push_back(fixture_names_[fixture]);
    for (const Point& point : points_) problem.point_name.push_back(point.name);
    explain(problem, lux_per_level, on_or_off, held, set, rows, correction);
  }
  correction.level = within_limits(list_of((per_light * level).cwiseMin(max_level_)), now);
  for (std::size_t j = 0; j < correction.level.size(); ++j)
    if (is_lost(static_cast<Index>(j))) correction.level[j] = present[j];
  const VectorXd corrected = vector_of(correction.level), uncorrected = vector_of(present);
  for (const Row& row : rows) {
    const RowVectorXd lux = row.lux_per_level.cwiseProduct(row.factor);
    correction.aimed_lx.push_back(lux.dot(corrected));
    correction.now_lx.push_back(lux.dot(uncorrected));
  }
  return correction;
}

}  // namespace luxrig
