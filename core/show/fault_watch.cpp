#include "core/show/fault_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace luxrig {
namespace {

using Eigen::Index;
using Kind = ChangeCause::Kind;

/// Samples before a meter's usual reading is known, and those over which a change is seen.
constexpr int kKnown = 20;
constexpr std::size_t kRecent = 5;
/// What is usual follows slow changes (ageing, warming up) with this time constant, in samples of a second.
constexpr double kFollows = 1800;
/// A change counts from so many standard errors and this share on.
constexpr double kDiffers = 6, kSmallestShare = 0.02;
/// Beside noise: what people, clouds and the last digit do to a reading, as a share.
constexpr double kUnquiet = 0.004, kDark_lx = 0.5;
/// Samples in a row that lead to the same cause; and how long it may take until several are told.
constexpr int kSame = 4;
constexpr double kTellSeveral_s = 40;
/// Samples in a row as usual end a finding.
constexpr int kOver = 10;
/// When levels have changed so much that kLampShare of that is more than this share of a reading, what is usual is learnt
/// anew.
constexpr double kMostOfLevels = 0.01;
/// The slowest meters of the field answer this late.
constexpr Duration kSlowestMeter = std::chrono::milliseconds(2500);
constexpr Duration kLookEvery = std::chrono::seconds(1);
/// Less than this is no fault: lamps warm up by so much, meters drift.
constexpr double kFaultShare = 0.08;

bool is_benign(const ChangeCause& cause) {
  switch (cause.kind) {
    case Kind::none:
    case Kind::all_light:
    case Kind::daylight:
      return true;
    case Kind::lamp:
    case Kind::meter:
      return std::abs(cause.share - 1) < kFaultShare;
    case Kind::unclear:
    case Kind::meters_swapped:
    case Kind::lamps_swapped:
    case Kind::lamp_moved:
      return false;
  }
  return false;
}

bool same(const std::vector<ChangeCause>& a, const std::vector<ChangeCause>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const ChangeCause& x, const ChangeCause& y) { return x.kind == y.kind && x.who == y.who; });
}

}  // namespace

void FaultWatch::Usual::learn(double now) {
  ++samples;
  const double weight = std::max(1.0 / samples, 1 / kFollows);
  const double off = now - ratio;
  ratio += weight * off;
  // The first sample has no scatter.
  const double of_variance = samples < 2 ? 0 : std::max(1.0 / (samples - 1), 1 / kFollows);
  variance += of_variance * ((1 - weight) * off * off - variance);
}

bool FaultWatch::Usual::known() const { return samples >= kKnown; }

double FaultWatch::Usual::deviation() const { return std::sqrt(variance); }

bool FaultWatch::Usual::differs() const {
  if (!known() || recent.size() < kRecent) return false;
  double mean = 0;
  for (const double each : recent) mean += each / static_cast<double>(recent.size());
  const double noise = std::hypot(deviation() / std::sqrt(static_cast<double>(kRecent)), kUnquiet * ratio);
  return std::abs(mean - ratio) > std::max(kDiffers * noise, kSmallestShare * ratio);
}

FaultWatch::FaultWatch(const Rig& rig) : usual_(rig.luxmeters.size()), heard_(rig.luxmeters.size()) {
  for (const Fixture& fixture : rig.fixtures) fixtures_.push_back(fixture.name);
  for (const Luxmeter& meter : rig.luxmeters) meters_.push_back(meter.name);
}

void FaultWatch::forget() {
  usual_.assign(usual_.size(), {});
  heard_.assign(heard_.size(), {});
  learnt_at_.clear();
  last_levels_.clear();
  changed_ = false;
  quiet_ = same_ = 0;
  candidate_.clear();
  found_.reset();
}

void FaultWatch::light_changes(Time settled) {
  steady_from_ = settled + kSlowestMeter;
  heard_.assign(heard_.size(), {});
}

void FaultWatch::hear(const LuxReading& reading) {
  if (reading.taken < steady_from_) return;
  Heard& heard = heard_[reading.luxmeter];
  heard.sum_lx += reading.lux;
  ++heard.count;
  heard.last = reading.taken;
}

bool FaultWatch::take_heard(const GainEstimator& estimator, const std::vector<double>& levels) {
  bool differs = false;
  for (std::size_t m = 0; m < usual_.size(); ++m) {
    const Heard heard = std::exchange(heard_[m], {});
    const double stated_lx = estimator.stated_lux(m, levels);
    if (heard.count == 0 || !(stated_lx > kDark_lx)) continue;
    const double lux = heard.sum_lx / heard.count;
    if (estimator.judge({m, lux, heard.last}, levels).stuck) continue;
    Usual& usual = usual_[m];
    const double ratio = lux / stated_lx;
    if (usual.recent.size() == kRecent) usual.recent.erase(usual.recent.begin());
    usual.recent.push_back(ratio);
    usual.fresh = true;
    if (changed_) {
      usual.since_sum += ratio;
      ++usual.since_samples;
    }
    differs = differs || usual.differs();
  }
  return differs;
}

double FaultWatch::error_of_levels(const GainEstimator& estimator, std::size_t luxmeter,
                                   const std::vector<double>& levels) const {
  std::vector<double> one(levels.size(), 0.0);
  const double dark_lx = estimator.stated_lux(luxmeter, one);
  double sum = 0;
  for (std::size_t f = 0; f < levels.size(); ++f) {
    const double by = levels[f] - learnt_at_[f];
    if (by == 0) continue;
    one[f] = std::abs(by);
    sum += std::pow(kLampShare * (estimator.stated_lux(luxmeter, one) - dark_lx), 2);
    one[f] = 0;
  }
  return usual_[luxmeter].ratio * std::sqrt(sum);
}

void FaultWatch::look(Time now, const GainEstimator& estimator, const std::vector<double>& levels) {
  if (now < steady_from_ || now - looked_at_ < kLookEvery) return;
  looked_at_ = now;
  if (last_levels_ != levels) {
    last_levels_ = levels;
    bool other = learnt_at_.size() != levels.size();
    // Under other levels a model that is wrong of one lamp makes another ratio.
    for (std::size_t m = 0; m < usual_.size() && !other && !changed_; ++m)
      other = error_of_levels(estimator, m, levels) > kMostOfLevels * usual_[m].ratio * estimator.stated_lux(m, levels);
    if (other) {
      forget();
      last_levels_ = learnt_at_ = levels;
    }
  }
  const bool differs = take_heard(estimator, levels);
  if (!differs && !changed_) {
    for (Usual& usual : usual_)
      if (std::exchange(usual.fresh, false)) usual.learn(usual.recent.back());
    return;
  }
  if (!changed_) {
    changed_ = true;
    changed_since_ = now;
    quiet_ = same_ = 0;
    for (Usual& usual : usual_) usual.since_sum = usual.since_samples = 0;
    return;
  }
  quiet_ = differs ? 0 : quiet_ + 1;
  if (quiet_ >= kOver) {
    changed_ = false;
    found_.reset();
    return;
  }
  judge(now, change(estimator, levels));
}

LightChange FaultWatch::change(const GainEstimator& estimator, const std::vector<double>& levels) const {
  const auto meters = static_cast<Index>(usual_.size()), fixtures = static_cast<Index>(levels.size());
  LightChange change;
  change.before_lx.setZero(meters);
  change.now_lx.setConstant(meters, std::numeric_limits<double>::quiet_NaN());
  change.error_lx.setConstant(meters, kDark_lx);
  change.of_fixture.setZero(meters, fixtures);
  change.daylight.setZero(meters);
  change.level = Eigen::Map<const Eigen::VectorXd>(levels.data(), fixtures);
  std::vector<double> one(levels.size(), 0.0);
  for (std::size_t m = 0; m < usual_.size(); ++m) {
    const Usual& usual = usual_[m];
    const auto row = static_cast<Index>(m);
    const double stated_lx = estimator.stated_lux(m, levels);
    if (!usual.known() || usual.since_samples == 0 || !(stated_lx > kDark_lx)) continue;
    change.before_lx[row] = usual.ratio * stated_lx;
    change.now_lx[row] = usual.since_sum / usual.since_samples * stated_lx;
    const double share = std::hypot(usual.deviation() / usual.ratio / std::sqrt(usual.since_samples), kUnquiet,
                                    estimator.curve_error_at_meter(m, learnt_at_, levels));
    change.error_lx[row] = std::hypot(share * change.before_lx[row], error_of_levels(estimator, m, levels), 1e-3);
    const double dark_lx = estimator.stated_lux(m, one);
    change.daylight[row] = usual.ratio * dark_lx;
    for (std::size_t f = 0; f < levels.size(); ++f) {
      if (!(levels[f] > 0)) continue;
      one[f] = levels[f];
      change.of_fixture(row, static_cast<Index>(f)) = usual.ratio * (estimator.stated_lux(m, one) - dark_lx);
      one[f] = 0;
    }
  }
  if (change.daylight.isZero()) change.daylight.resize(0);
  return change;
}

void FaultWatch::judge(Time now, const LightChange& change) {
  std::vector<ChangeCause> causes = causes_of(change);
  std::erase_if(causes, [](const ChangeCause& cause) { return cause.kind == Kind::none; });
  same_ = same(causes, candidate_) ? same_ + 1 : 1;
  candidate_ = causes;
  const bool clear = causes.size() == 1 && causes.front().kind != Kind::unclear;
  const bool long_enough = to_seconds(now - changed_since_) > kTellSeveral_s;
  if (same_ < kSame || causes.empty() || (!clear && !long_enough)) return;
  if (std::any_of(causes.begin(), causes.end(), is_benign)) return found_.reset();
  std::string text;
  for (const ChangeCause& cause : causes) text += (text.empty() ? "" : ", or ") + words(cause);
  if (causes.size() > 1) text = "either " + text;
  found_ = Finding{std::move(causes), text + "; " + evidence(change), changed_since_};
}

std::string FaultWatch::words(const ChangeCause& cause) const {
  const auto lamp = [&](std::size_t k) { return "\"" + fixtures_[cause.who[k]] + "\""; };
  const auto meter = [&](std::size_t k) { return "\"" + meters_[cause.who[k]] + "\""; };
  const double percent = 100 * std::max(0.0, cause.share);
  switch (cause.kind) {
    case Kind::lamp:
      if (cause.share < 0.05) return fmt::format("lamp {} gives no light, though its device reports no fault", lamp(0));
      return fmt::format("lamp {} gives {:.0f} % of its light: dirt, a filter, or a failing lamp", lamp(0), percent);
    case Kind::meter:
      return cause.share < 1
                 ? fmt::format("luxmeter {} shows {:.0f} % of its light: it is covered, or wrong", meter(0), percent)
                 : fmt::format("luxmeter {} shows {:.0f} % of its light: other light falls on it, or it is wrong",
                               meter(0), percent);
    case Kind::meters_swapped:
      return fmt::format("luxmeters {} and {} were exchanged", meter(0), meter(1));
    case Kind::lamps_swapped:
      return fmt::format("lamps {} and {} get each other's level: patch or addresses were exchanged", lamp(0), lamp(1));
    case Kind::lamp_moved:
      return fmt::format("lamp {} shines elsewhere than before: knocked, or turned by hand", lamp(0));
    case Kind::none:
    case Kind::unclear:
    case Kind::all_light:
    case Kind::daylight:
      break;
  }
  return "the light is not as before, and no single fault explains it";
}

std::string FaultWatch::evidence(const LightChange& change) const {
  std::string list;
  int others = 0;
  for (Index m = 0; m < change.now_lx.size(); ++m) {
    const double off = change.now_lx[m] - change.before_lx[m];
    if (!std::isfinite(off)) continue;
    if (std::abs(off) < 3 * change.error_lx[m]) {
      ++others;
      continue;
    }
    list += fmt::format("{}\"{}\" {:.4g} lx, before {:.4g}", list.empty() ? "" : ", ",
                        meters_[static_cast<std::size_t>(m)], change.now_lx[m], change.before_lx[m]);
  }
  if (others > 0) list += fmt::format("; {} as before", others);
  return "readings: " + list;
}

void FaultWatch::tell(ShowStatus& status) const {
  if (found_) status.alarms.push_back({false, "", found_->text, found_->since});
}

}  // namespace luxrig
