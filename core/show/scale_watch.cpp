#include "core/show/scale_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

/// The common scale is off beyond this many standard errors; correct rigs are within.
constexpr double kSurelyOff = 3;
/// Once raised, an alarm stands until the error is below this share of its threshold, so that noise does not make it
/// come and go.
constexpr double kStands = 0.8;
/// A change of reading over model at one place counts as drift above this, beyond what a dimmer's curve and ageing
/// explain.
constexpr double kDrift = 0.08;
constexpr double kAgeingPerHour = 0.001;
/// This many samples in a row, so that a person walking past is no drift.
constexpr int kDriftSeen = 3;
/// Below this, a meter's offset matters.
constexpr double kDarkForDrift_lx = 2;

std::string less_or_more(double log_share) {
  return fmt::format("{:.0f} % {}", 100 * std::abs(std::exp(log_share) - 1), log_share < 0 ? "less" : "more");
}

std::string drift_together_text(double log_share) {
  return fmt::format(
      "most meters read {} than before at the same levels: either the lamps or other light, or the meters' "
      "calibration drifts; compare one with a reference meter; applying the plan again takes the light as it is",
      less_or_more(log_share));
}

}  // namespace

ScaleWatch::ScaleWatch(const Rig& rig) : drifts_(rig.luxmeters.size()) {
  for (const Luxmeter& meter : rig.luxmeters) names_.push_back(meter.name);
}

void ScaleWatch::look(Time now, const GainEstimator& estimator, Measured measured, const std::vector<double>& levels) {
  std::vector<LuxReading> readings;
  for (const auto& reading : measured)
    if (reading) readings.push_back(*reading);
  const auto scale = estimator.common_scale(readings, levels);
  const bool off =
      scale && std::abs(scale->log_scale) > (off_together_ ? kStands : 1) * kSurelyOff * scale->log_standard_error;
  if (off && !off_together_) off_together_since_ = now;
  off_together_ = off ? std::optional(scale->log_scale) : std::nullopt;

  for (std::size_t i = 0; i < drifts_.size(); ++i) {
    Drift& drift = drifts_[i];
    if (!measured[i] || measured[i]->lux <= 0) continue;
    const double stated_lx = estimator.stated_lux(i, levels);
    if (!(stated_lx > kDarkForDrift_lx)) continue;
    const double log_ratio = std::log(measured[i]->lux / stated_lx);
    if (!drift.anchored) {
      drift = Drift{true, log_ratio, levels, now, 0, 0, {}};
      continue;
    }
    const double allowed = kDrift + kAgeingPerHour * to_seconds(now - drift.since) / 3600 +
                           estimator.curve_error_at_meter(i, drift.levels, levels);
    drift.log_change = log_ratio - drift.log_ratio;
    drift.seen = std::abs(drift.log_change) > (drifts_away(i) ? kStands : 1) * allowed ? drift.seen + 1 : 0;
    if (drift.seen == kDriftSeen) drift.known_since = now;
  }
}

bool ScaleWatch::drifts_away(std::size_t luxmeter) const { return drifts_[luxmeter].seen >= kDriftSeen; }

/// Median change if more than half of the meters drift one way: what the model learned from them has then moved, too.
std::optional<double> ScaleWatch::drift_together(Measured measured) const {
  std::vector<double> less, more;
  std::size_t known = 0;
  for (std::size_t i = 0; i < drifts_.size(); ++i) {
    if (!drifts_[i].anchored || !measured[i]) continue;
    ++known;
    if (drifts_away(i)) (drifts_[i].log_change < 0 ? less : more).push_back(drifts_[i].log_change);
  }
  std::vector<double>& change = less.size() > more.size() ? less : more;
  if (change.size() < 2 || 2 * change.size() <= known) return std::nullopt;
  std::nth_element(change.begin(), change.begin() + static_cast<std::ptrdiff_t>(change.size() / 2), change.end());
  return change[change.size() / 2];
}

ScaleWatch::Doubt ScaleWatch::doubt_at(std::optional<std::size_t> meter, Measured measured) const {
  Doubt doubt;
  const auto take = [&](double log_share, std::string reason) {
    if (std::abs(log_share) <= std::abs(doubt.log_share)) return;
    doubt = {log_share, std::move(reason)};
  };
  if (off_together_) take(*off_together_, off_together_text());
  if (const auto together = drift_together(measured)) take(*together, drift_together_text(*together));
  if (meter && measured[*meter] && drifts_away(*meter)) take(drifts_[*meter].log_change, drift_text(*meter));
  return doubt;
}

std::string ScaleWatch::off_together_text() const {
  return fmt::format(
      "all meters read {} than the model says: either the photometry, the reflectances or the lamps' age, or the "
      "meters' calibration; compare one with a reference meter, and mend the rig file or the meters",
      less_or_more(*off_together_));
}

std::string ScaleWatch::drift_text(std::size_t luxmeter) const {
  return fmt::format(
      "luxmeter \"{}\" reads {} than before at the same levels: either the lamps or other light there, or its "
      "calibration drifts; compare it with a reference meter; applying the plan again takes the light as it is",
      names_[luxmeter], less_or_more(drifts_[luxmeter].log_change));
}

void ScaleWatch::tell(ShowStatus& status, Measured measured) const {
  if (off_together_) status.alarms.push_back({false, "", off_together_text(), off_together_since_});
  const auto together = drift_together(measured);
  Time since = Time::max();
  for (std::size_t i = 0; i < drifts_.size(); ++i) {
    if (!measured[i] || !drifts_away(i)) continue;
    if (together && (drifts_[i].log_change < 0) == (*together < 0))
      since = std::min(since, drifts_[i].known_since);
    else
      status.alarms.push_back({false, names_[i], drift_text(i), drifts_[i].known_since});
  }
  if (together) status.alarms.push_back({false, "", drift_together_text(*together), since});
}

void ScaleWatch::forget_drift() {
  for (std::size_t i = 0; i < drifts_.size(); ++i)
    if (drifts_away(i)) drifts_[i] = Drift{};
}

}  // namespace luxrig
