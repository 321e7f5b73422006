/// GainEstimator: the most light that the evidence allows, and levels within limits by it.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/estimation/gain_estimator.h"
#include "core/output/output_program.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr int kFadeSamples = 8;

}  // namespace

RowVectorXd GainEstimator::unmeasured_worst(const Row& row) const {
  RowVectorXd worst = row.lux_per_level + 3 * row.standard_error;
  for (Index j = 0; j < worst.size(); ++j) worst[j] *= upper_gain(static_cast<std::size_t>(j)) * local_;
  return worst;
}

double GainEstimator::max_lux(const Row& row, const VectorXd& level, Time now) const {
  const double unmeasured = unmeasured_worst(row).dot(level);
  if (!row.luxmeter || latest(*row.luxmeter) == nullptr) return unmeasured + row.unseen_lx;
  const bool over = contradicted(*row.luxmeter);
  const Evidence& e = over ? *over_[*row.luxmeter] : *latest(*row.luxmeter);
  // max Σ A_j w_j over lower ≤ A ≤ upper, A · (levels of the reading) ≤ the true value at most: a fractional knapsack,
  // filled by best w_j per level. w_j: level, times the most that the dimmer's true curve may add on the way there.
  const Index n = level.size();
  const double tolerance = std::min(0.9, luxmeters_[e.luxmeter].tolerance);
  VectorXd lower(n), upper(n), w(n), worth(n);
  double least = 0;
  for (Index j = 0; j < n; ++j) {
    const double m = row.lux_per_level[j], x = row.factor[j], sd = row.factor_error[j];
    // What is learned of lamps is what the meter shows of them. If it shows too little by its tolerance, then of all.
    const double bound = gain_max_ * local_;
    const bool doubted = over || doubted_(static_cast<Index>(*row.luxmeter), j);
    const double most = doubted ? bound : std::min(bound, (x + 3 * sd) / (1 - tolerance));
    upper[j] = m * most + (m > 0 ? 0 : 3 * row.standard_error[j] * gain_max_);
    lower[j] = std::min(upper[j], m * std::max(gain_min_ / local_, x - 3 * sd));
    w[j] = level[j] *
           std::exp(e.level[j] > 0 && level[j] > 0 ? kCurveError * std::abs(std::log(level[j] / e.level[j])) : 0);
    // A ratio, not products compared: with a lamp that was and is dark, those would be no order.
    worth[j] = e.level[j] > 0 ? w[j] / e.level[j] : w[j] > 0 ? std::numeric_limits<double>::infinity() : 0;
    least += lower[j] * e.level[j];
  }
  const double truth =
      e.lux / (1 - tolerance) * (1 + 2 * kRepeatability + kDriftPerMinute * minutes_between(e.taken, now));
  if (least > truth) lower *= truth / least;
  double left = std::max(0.0, truth - least);
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return worth[a] > worth[b]; });
  double most = lower.dot(w);
  for (const Index j : order) {
    const double room = upper[j] - lower[j];
    const double taken = e.level[j] > 0 ? std::min(room, left / e.level[j]) : room;
    most += taken * w[j];
    left = std::max(0.0, left - taken * e.level[j]);
  }
  return most + row.unseen_lx;
}

/// Light of daylight and of lamps that do not respond.
double GainEstimator::max_without_fixtures(const Row& row, Time now) const {
  if (meter_.cols() == fixtures() && !any_lost()) return 0;
  return max_lux(row, vector_of(std::vector<double>(static_cast<std::size_t>(fixtures()), 0.0)), now);
}

double GainEstimator::max_lux_at_point(std::size_t point, std::span<const double> level, Time now) const {
  return max_lux(row_of_point(point), vector_of(level), now);
}

double GainEstimator::max_lux_as_given(std::size_t point, std::span<const double> level, Time now) const {
  Row row = row_of_point(point);
  row.unseen_lx = 0;
  return max_lux(row, as_given(level), now);
}

bool GainEstimator::any_lost() const {
  return std::any_of(lost_.begin(), lost_.end(), [](const auto& lost) { return lost.has_value(); });
}

RowVectorXd GainEstimator::without_lost(RowVectorXd row) const {
  for (Index j = 0; j < row.size(); ++j)
    if (is_lost(j)) row[j] = 0;
  return row;
}

void GainEstimator::set_lost(std::vector<std::optional<Lost>> lost, std::vector<std::uint8_t> watched) {
  if (lost != lost_) knows_more();
  lost_ = std::move(lost);
  watched_ = std::move(watched);
}

double GainEstimator::beyond_last_level(const Row& row) const {
  const RowVectorXd worst = unmeasured_worst(row);
  double lux = 0;
  for (std::size_t j = 0; j < lost_.size(); ++j)
    if (lost_[j]) lux += worst[static_cast<Index>(j)] * std::max(0.0, lost_[j]->most - lost_[j]->level);
  return lux;
}

double GainEstimator::unseen_lux(std::size_t point, const Row& row) const {
  if (!any_lost() || !points_[point].max_lx) return 0;
  if (const auto meter = meter_of_point_[point]; meter && *meter < watched_.size() && watched_[*meter] != 0) return 0;
  const double unseen_lx = beyond_last_level(row);
  const VectorXd dark = vector_of(std::vector<double>(static_cast<std::size_t>(fixtures()), 0.0));
  return unmeasured_worst(row).dot(dark) + unseen_lx < *points_[point].max_lx ? unseen_lx : 0;
}

std::vector<std::size_t> GainEstimator::beyond_dimming() const {
  std::vector<std::size_t> points;
  if (!any_lost()) return points;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    if (!points_[p].max_lx) continue;
    if (const auto meter = meter_of_point_[p]; meter && *meter < watched_.size() && watched_[*meter] != 0) continue;
    const Row row = row_of_point(p);
    if (row.unseen_lx == 0 && beyond_last_level(row) > 0) points.push_back(p);
  }
  return points;
}

double GainEstimator::share_at_meter(std::size_t luxmeter, std::span<const std::uint8_t> chosen,
                                     std::span<const double> level) const {
  const Row row = row_of_meter(luxmeter);
  double lux = 0;
  for (std::size_t j = 0; j < chosen.size(); ++j)
    if (chosen[j] != 0) lux += row.lux_per_level[static_cast<Index>(j)];
  const double all_lx = predict(row, vector_of(level)).lux;
  return lux > 0 ? lux / std::max(lux, all_lx) : 0;
}

WorstCase GainEstimator::worst_case(std::span<const double> from, std::span<const double> to, Time now) const {
  const VectorXd begin = vector_of(from), end = vector_of(to);
  WorstCase worst;
  for (std::size_t p = 0; p < points_.size(); ++p)
    if (points_[p].max_lx) worst.points.push_back(p);
  const auto count = static_cast<Index>(worst.points.size());
  worst.worst_lux_per_level.resize(count, fixtures());
  worst.max_lx.resize(count);
  for (Index k = 0; k < count; ++k) {
    const std::size_t p = worst.points[static_cast<std::size_t>(k)];
    const double max_lx = *points_[p].max_lx;
    const Row row = row_of_point(p);
    // max_lux() is convex in the levels: beyond its value without fixtures, it grows at most in proportion.
    const double daylight_lx = max_without_fixtures(row, now);
    worst.max_lx[k] = std::max(0.0, max_lx - daylight_lx);
    worst.worst_lux_per_level.row(k) = without_lost(unmeasured_worst(row).head(fixtures()));
    if (!row.luxmeter) continue;
    // One factor on the best estimate, large enough wherever the limit could be near on the way.
    const RowVectorXd estimate =
        without_lost((row.lux_per_level.cwiseProduct(row.factor) + 3 * row.standard_error).head(fixtures()));
    double factor = 0;
    for (int s = 0; s <= kFadeSamples; ++s) {
      VectorXd level = end;
      for (Index j = 0; j < fixtures(); ++j)
        level[j] = level_on_the_way(begin[j], end[j], static_cast<double>(s) / kFadeSamples,
                                    switched_[static_cast<std::size_t>(j)] != 0);
      const double lux = estimate.dot(level.head(fixtures())), most = max_lux(row, level, now);
      if (lux > 0 && (s == kFadeSamples || most >= 0.9 * max_lx)) factor = std::max(factor, (most - daylight_lx) / lux);
    }
    if (factor > 0) worst.worst_lux_per_level.row(k) = factor * estimate;
  }
  return worst;
}

WorstCase GainEstimator::worst_of_any(Time now) const {
  WorstCase worst;
  for (std::size_t p = 0; p < points_.size(); ++p)
    if (points_[p].max_lx) worst.points.push_back(p);
  const auto count = static_cast<Index>(worst.points.size());
  worst.worst_lux_per_level.resize(count, fixtures());
  worst.max_lx.resize(count);
  for (Index k = 0; k < count; ++k) {
    const std::size_t p = worst.points[static_cast<std::size_t>(k)];
    const Row row = row_of_point(p);
    worst.max_lx[k] = std::max(0.0, *points_[p].max_lx - max_without_fixtures(row, now));
    worst.worst_lux_per_level.row(k) = without_lost(unmeasured_worst(row).head(fixtures()));
  }
  return worst;
}

std::vector<double> opening_levels(const Rig& rig, const LightModel& model, std::span<const double> level) {
  return GainEstimator(rig, model).within_limits(level, Time{});
}

LampWorth GainEstimator::worth() const {
  LampWorth worth{std::vector<double>(static_cast<std::size_t>(fixtures()), 0.0), housing_};
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const double goal_lx = points_[p].goal_lx.value_or(0);
    if (!(goal_lx > 0)) continue;
    for (Index j = 0; j < fixtures(); ++j) {
      const double share = points_[p].weight * point_(static_cast<Index>(p), j) / goal_lx;
      worth.per_level_squared[static_cast<std::size_t>(j)] += share * share;
    }
  }
  return worth;
}

/// Of the on-or-off fixtures, by the model.
void GainEstimator::switch_off_brightest(const Row& row, std::span<double> level) const {
  std::size_t brightest = level.size();
  double worst_case_lx = 0;
  for (std::size_t j = 0; j < level.size(); ++j) {
    const double lux = level[j] > 0 && switched_[j] != 0 ? row.lux_per_level[static_cast<Index>(j)] : 0;
    if (lux <= worst_case_lx) continue;
    brightest = j;
    worst_case_lx = lux;
  }
  if (brightest < level.size()) level[brightest] = 0;
}

std::vector<double> GainEstimator::within_limits(std::span<const double> given, Time now) const {
  std::vector<double> level = dimmed_to_limits(given, now);
  for (std::size_t j = 0; j < lost_.size(); ++j)
    if (lost_[j]) level[j] = given[j];  // it does not respond, so dimming it does not help
  return level;
}

std::vector<double> GainEstimator::dimmed_to_limits(std::span<const double> given, Time now) const {
  std::vector<double> level = list_of(vector_of(given).head(fixtures()).cwiseMax(0).cwiseMin(max_level_));
  for (std::size_t j = 0; j < level.size(); ++j)
    if (switched_[j] != 0 && level[j] < 1) level[j] = 0;
  const LampWorth of_goals = worth();
  for (int round = 0; round < kLimitRounds; ++round) {
    const WorstCase worst = worst_case(level, level, now);
    const std::vector<double> before = level;
    scale_to_limits(worst.worst_lux_per_level, worst.max_lx, level, 0, switched_, of_goals);
    if (level == before) return level;
  }
  // Not converged: each scaling may need a little more (the curve's uncertainty). So a last step that is certain.
  for (std::size_t p = 0; p < points_.size(); ++p) {
    if (!points_[p].max_lx) continue;
    const Row row = row_of_point(p);
    const auto max_at = [&](std::span<const double> at) { return max_lux(row, vector_of(at), now); };
    const auto set_alone = [&] {
      std::vector<double> set = level;
      for (std::size_t j = 0; j < set.size(); ++j)
        if (switched_[j] == 0) set[j] = 0;
      return set;
    };
    if (max_at(level) <= *points_[p].max_lx) continue;
    double set_lx = max_at(set_alone());  // with daylight
    for (std::size_t j = 0; j < level.size() && set_lx > *points_[p].max_lx; ++j) {
      switch_off_brightest(row, level);
      set_lx = max_at(set_alone());
    }
    const double most = max_at(level), room = *points_[p].max_lx - set_lx;
    if (most <= *points_[p].max_lx) continue;
    const double share = room > 0 ? std::pow(room / (most - set_lx), 1 / (1 - kCurveError)) : 0;
    for (std::size_t j = 0; j < level.size(); ++j)
      if (row.lux_per_level[static_cast<Index>(j)] > 0 && switched_[j] == 0) level[j] *= share;
  }
  return level;
}

}  // namespace luxrig
