#include "core/show/fault_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "core/output/dimming.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Kind = ChangeCause::Kind;

/// Beside noise: what people, clouds and the last digit do to a reading, as a share; and within the time of a dip.
constexpr double kUnquiet = 0.0025, kUnquietInDip = 0.001, kDark_lx = 0.5;
/// Samples in a row that lead to the same cause, before a dip and after one; how long until several are told.
constexpr int kSame = 4, kSameAfterDip = 2;
constexpr double kTellSeveral_s = 48;
/// A lamp that gives more than this may give nothing, and one that gives less may give this.
constexpr double kPerhapsDead = 0.3, kPerhapsDim = 0.6;
/// A lamp gives none below this share.
constexpr double kNone = 0.1;
/// A meter sees a lamp that gives this share of its light.
constexpr double kSeen = 0.05;
/// A lamp is told without a dip of its own after this: it may be held by hand, or its dip would show nothing.
constexpr double kConfirmed_s = 12;
/// A lamp is dimmed once the change has lasted for so long (a person in the light moves on), and not much later. Each
/// change that went by itself doubles that, up to a visitor's minute: where people pass, no lamp is dimmed for them.
constexpr double kBeforeDip_s = 8, kForDips_s = 34;
constexpr int kMostPassedBy = 3;
constexpr std::size_t kMostDips = 3;
/// Samples under a dip.
constexpr int kDipSamples = 5;
/// Samples in a row as usual end a finding; sooner, if the meters that changed by so many standard errors are back.
constexpr int kOver = 10;
constexpr double kChanged = 6;
/// The slowest meters of the field answer this late.
constexpr Duration kSlowestMeter = std::chrono::milliseconds(2500);
constexpr Duration kLookEvery = std::chrono::seconds(1);
/// Corrections wait so long for a cause.
constexpr double kExamines_s = 60;
/// Less than this is no fault: lamps warm up by so much, meters drift.
constexpr double kFaultShare = 0.08;
/// How well the light of a lamp at a meter is known that no calibration has read, as a share, beside what is said of
/// it; and of one that it has read.
constexpr double kStatedShare = 0.3, kCalibratedShare = 0.03;
/// How wrong the light may be that is expected of a changed level, as a share of the change.
constexpr double kStatedStep = 1, kCalibratedStep = 0.1;
constexpr double kUnchangedLevel = 1e-6;
/// No lamp's light is less certain than by this share: it is not nothing, and not twice as much.
constexpr double kLeastKnown = 0.5;
/// The same of the exponent of a dimmer's curve.
constexpr double kStatedCurve = 0.4, kMeasuredCurve = 0.05;

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

double curve_error_of(const Fixture& fixture) { return fixture.measured_curve.empty() ? kStatedCurve : kMeasuredCurve; }

}  // namespace

FaultWatch::FaultWatch(const Rig& rig)
    : fixtures_(std::make_shared<const std::vector<Fixture>>(rig.fixtures)),
      usual_(rig.luxmeters.size()),
      heard_(rig.luxmeters.size()),
      since_(rig.luxmeters.size()) {
  for (const Luxmeter& meter : rig.luxmeters) meters_.push_back(meter.name);
}

void FaultWatch::forget() {
  usual_.assign(usual_.size(), {});
  heard_.assign(heard_.size(), {});
  since_.assign(since_.size(), {});
  last_levels_.clear();
  changed_ = false;
  search_.reset();
  quiet_ = same_ = 0;
  likely_.clear();
  candidate_.clear();
  dip_.reset();
  dips_.clear();
  barred_.reset();
  found_.reset();
}

void FaultWatch::light_changes(Time settled) {
  steady_from_ = settled + kSlowestMeter;
  search_.reset();  // it is of the light before
  heard_.assign(heard_.size(), {});
}

void FaultWatch::hear(const LuxReading& reading) {
  if (reading.taken < steady_from_) return;
  Heard& heard = heard_[reading.luxmeter];
  heard.sum_lx += reading.lux;
  ++heard.count;
  heard.last_lx = reading.lux;
  heard.last = reading.taken;
}

std::vector<std::optional<double>> FaultWatch::take_heard(const GainEstimator& estimator,
                                                          const std::vector<double>& levels) {
  std::vector<std::optional<double>> ratio(usual_.size());
  for (std::size_t m = 0; m < usual_.size(); ++m) {
    const Heard heard = std::exchange(heard_[m], {});
    const double stated_lx = estimator.stated_lux(m, levels);
    if (heard.count == 0 || !(stated_lx > kDark_lx)) continue;
    const double lux = heard.sum_lx / heard.count;
    if (dip_ || !estimator.judge({m, lux, heard.last}, levels).stuck) ratio[m] = lux / stated_lx;
  }
  return ratio;
}

void FaultWatch::follow_levels(const GainEstimator& estimator, const std::vector<double>& levels) {
  if (last_levels_ == levels) return;
  const std::vector<double> before = std::exchange(last_levels_, levels);
  if (before.size() != levels.size()) return;
  for (std::size_t m = 0; m < usual_.size(); ++m) {
    const double stated_lx = estimator.stated_lux(m, levels);
    if (!(stated_lx > kDark_lx)) continue;
    double variance = 0;
    for (std::size_t f = 0; f < levels.size(); ++f) {
      if (std::abs(levels[f] - before[f]) < kUnchangedLevel) continue;
      const Prediction light = estimator.lux_per_level_at_meter(m, f);
      const double wrong_by = (*fixtures_)[f].known_to ? kCalibratedStep : kStatedStep;
      variance += std::pow(wrong_by * light.lux * (levels[f] - before[f]), 2);
    }
    if (variance > 0) usual_[m].doubt(std::sqrt(variance) / stated_lx);
  }
}

void FaultWatch::begin_change(Time now) {
  changed_ = true;
  search_.reset();
  changed_since_ = now;
  quiet_ = same_ = 0;
  since_.assign(since_.size(), {});
  likely_.clear();
  candidate_.clear();
  dips_.clear();
  barred_.reset();
}

void FaultWatch::end_change() {
  changed_ = false;
  search_.reset();
  passed_by_ = std::min(passed_by_ + 1, kMostPassedBy);
  dips_.clear();
  found_.reset();
  for (UsualReading& usual : usual_) usual.forget_recent();
}

std::vector<std::optional<MeanReading>> FaultWatch::changed_meters() const {
  std::vector<std::optional<MeanReading>> changed(usual_.size());
  for (std::size_t m = 0; m < usual_.size(); ++m) {
    const auto row = static_cast<Index>(m);
    const double off_lx = std::abs(change_.now_lx[row] - change_.before_lx[row]);
    if (off_lx > kChanged * change_.error_lx[row]) changed[m] = since_[m];
  }
  return changed;
}

bool FaultWatch::all_are_back(const GainEstimator& estimator, const std::vector<double>& levels) const {
  bool any = false;
  for (std::size_t m = 0; m < usual_.size(); ++m) {
    const auto& changed = found_->changed[m];
    if (!changed) continue;
    const double stated_lx = estimator.stated_lux(m, levels);
    if (heard_[m].count == 0 || !(stated_lx > kDark_lx) ||
        !usual_[m].is_back_from(*changed, heard_[m].last_lx / stated_lx))
      return false;
    any = true;
  }
  return any;
}

/// Until the slowest meter shows the change, the mean would be of two lights.
void FaultWatch::listen(Time now, const std::vector<std::optional<double>>& ratio) {
  if (now - changed_since_ < kSlowestMeter) return;
  for (std::size_t m = 0; m < ratio.size(); ++m)
    if (ratio[m] && usual_[m].differs_from(since_[m])) return begin_change(now);
  for (std::size_t m = 0; m < ratio.size(); ++m)
    if (ratio[m] && usual_[m].known()) since_[m].add(*ratio[m] / usual_[m].ratio());
}

void FaultWatch::look(Time now, const GainEstimator& estimator, const std::vector<double>& levels) {
  if (now < steady_from_) return;
  take_causes(now);
  if (found_ && !dip_ && all_are_back(estimator, levels)) end_change();
  if (now - looked_at_ < kLookEvery) return;
  const double passed_s = to_seconds(now - std::exchange(looked_at_, now));
  for (UsualReading& usual : usual_) usual.pass(passed_s);
  follow_levels(estimator, levels);
  const std::vector<std::optional<double>> ratio = take_heard(estimator, levels);
  if (dip_) {
    for (std::size_t m = 0; m < ratio.size(); ++m)
      if (ratio[m] && usual_[m].known()) dip_share_[m].add(*ratio[m] / usual_[m].ratio());
    ++dip_looks_;
    return;
  }
  bool differs = false;
  for (std::size_t m = 0; m < ratio.size(); ++m) {
    if (!ratio[m]) continue;
    usual_[m].hear(*ratio[m]);
    differs = differs || usual_[m].differs();
  }
  if (!differs && !changed_) {
    for (std::size_t m = 0; m < ratio.size(); ++m)
      if (ratio[m]) usual_[m].learn();
    return;
  }
  if (!changed_) return begin_change(now);
  quiet_ = differs ? 0 : quiet_ + 1;
  if (quiet_ >= kOver) return end_change();
  listen(now, ratio);
  if (search_) return;  // what was read meanwhile counts for the next
  change_ = change(estimator, levels);
  ask_for_causes();
  take_causes(now);
}

void FaultWatch::ask_for_causes() {
  search_ = std::make_shared<Search>();
  if (!runner_) {
    search_->likely = likely_causes(change_);
    search_->done = true;
    return;
  }
  // The task owns everything it uses.
  runner_([to = search_, change = change_] {
    to->likely = likely_causes(change);
    to->done = true;
  });
}

void FaultWatch::take_causes(Time now) {
  if (!search_ || !search_->done) return;
  judge(now, std::move(std::exchange(search_, nullptr)->likely));
}

double FaultWatch::noise_lx(std::size_t m, int samples) const {
  const double now_lx = change_.now_lx[static_cast<Index>(m)];
  if (!std::isfinite(now_lx)) return kDark_lx;
  const double share = usual_[m].noise_share() * std::sqrt(1.0 / since_[m].samples + 1.0 / samples);
  return std::max(1e-3, std::hypot(share, kUnquietInDip) * now_lx);
}

/// The light of each lamp in what the meter reads, and how well that is known. All of them together are known best.
void FaultWatch::share_out(const GainEstimator& estimator, std::size_t m, LightChange& change) const {
  const auto row = static_cast<Index>(m);
  double left_lx = change.before_lx[row] - (change.daylight.size() > 0 ? change.daylight[row] : 0), variance = 0;
  for (Index f = 0; f < change.level.size(); ++f) {
    const Prediction light = estimator.lux_per_level_at_meter(m, static_cast<std::size_t>(f));
    const bool calibrated = (*fixtures_)[static_cast<std::size_t>(f)].known_to.has_value();
    const double lux = light.lux * change.level[f];
    change.of_fixture(row, f) = lux;
    change.fixture_error(row, f) =
        std::hypot(light.standard_error_lx * change.level[f], (calibrated ? kCalibratedShare : kStatedShare) * lux);
    left_lx -= lux;
    variance += std::pow(change.fixture_error(row, f), 2);
  }
  if (!(variance > 0)) return;
  // Where they do not add up to the reading, each is known less well.
  const double doubt = std::max(1.0, left_lx * left_lx / variance);
  for (Index f = 0; f < change.level.size(); ++f) {
    const double own = std::pow(change.fixture_error(row, f), 2);
    change.of_fixture(row, f) =
        std::max(0.1 * change.of_fixture(row, f), change.of_fixture(row, f) + left_lx * own / variance);
    change.fixture_error(row, f) = std::min(kLeastKnown * change.of_fixture(row, f),
                                            std::sqrt(std::max(0.01 * own, doubt * (own - own * own / variance))));
  }
}

LightChange FaultWatch::change(const GainEstimator& estimator, const std::vector<double>& levels) const {
  const auto meters = static_cast<Index>(usual_.size()), fixtures = static_cast<Index>(levels.size());
  LightChange change;
  change.before_lx.setZero(meters);
  change.now_lx.setConstant(meters, std::numeric_limits<double>::quiet_NaN());
  change.error_lx.setConstant(meters, kDark_lx);
  change.of_fixture.setZero(meters, fixtures);
  change.fixture_error.setZero(meters, fixtures);
  change.daylight.setZero(meters);
  change.level = Eigen::Map<const Eigen::VectorXd>(levels.data(), fixtures);
  change.curve_error.resize(fixtures);
  for (Index f = 0; f < fixtures; ++f)
    change.curve_error[f] = curve_error_of((*fixtures_)[static_cast<std::size_t>(f)]);
  change.level_with_drive_of = [fixtures = fixtures_, levels](std::size_t f, std::size_t g) {
    return level_at((*fixtures)[f], drive_for((*fixtures)[g], levels[g]));
  };
  const std::vector<double> dark(levels.size(), 0.0);
  for (std::size_t m = 0; m < usual_.size(); ++m) {
    const UsualReading& usual = usual_[m];
    const auto row = static_cast<Index>(m);
    const double stated_lx = estimator.stated_lux(m, levels);
    if (!usual.known() || since_[m].samples == 0 || !(stated_lx > kDark_lx)) continue;
    change.before_lx[row] = usual.ratio() * stated_lx;
    change.now_lx[row] = since_[m].mean() * change.before_lx[row];
    const double error = std::sqrt(usual.variance() / std::pow(usual.ratio(), 2) +
                                   std::pow(usual.noise_share(), 2) / since_[m].samples + std::pow(kUnquiet, 2));
    change.error_lx[row] = std::max(1e-3, error * change.before_lx[row]);
    change.daylight[row] = usual.ratio() * estimator.stated_lux(m, dark);
    share_out(estimator, m, change);
  }
  if (change.daylight.isZero()) change.daylight.resize(0);
  change.dips = dips_;
  return change;
}

void FaultWatch::judge(Time now, std::vector<ChangeCause> likely) {
  judged_at_ = now;
  likely_ = std::move(likely);
  std::vector<ChangeCause> causes = causes_to_tell(likely_);
  const bool unclear = causes.size() == 1 && causes.front().kind == Kind::unclear;
  same_ = same(causes, candidate_) ? same_ + 1 : 1;
  candidate_ = causes;
  const bool clear = causes.size() == 1 && !unclear;
  add_doubt_of_lamps();
  const bool long_enough = to_seconds(now - changed_since_) > kTellSeveral_s;
  const bool settled = clear && (likely_.size() == 1 || to_seconds(now - changed_since_) > kConfirmed_s);
  if (same_ < (dips_.empty() ? kSame : kSameAfterDip) || causes.empty() || (!settled && !long_enough)) return;
  if (std::any_of(causes.begin(), causes.end(), is_benign)) return found_.reset();
  std::string text;
  for (const ChangeCause& cause : causes) text += (text.empty() ? "" : ", or ") + words(cause);
  if (causes.size() > 1) text = "either " + text;
  text += "; " + evidence() + of_barred_dip(causes);
  found_ = Finding{std::move(causes), std::move(text), changed_since_, changed_meters()};
}

/// Dead or dim: a dip of the lamp itself tells, and whether it is this lamp.
void FaultWatch::add_doubt_of_lamps() {
  const std::size_t count = likely_.size();
  for (std::size_t k = 0; k < count; ++k) {
    const ChangeCause lamp = likely_[k];
    if (lamp.kind != Kind::lamp || is_benign(lamp)) continue;
    const bool known =
        std::any_of(dips_.begin(), dips_.end(), [&](const LampDip& dip) { return dip.fixture == lamp.who.front(); });
    if (known) continue;
    likely_.push_back({Kind::lamp, lamp.who, lamp.share > kPerhapsDead ? 0 : kPerhapsDim});
  }
}

bool FaultWatch::examines(Time now) const {
  if (!changed_)
    return std::any_of(usual_.begin(), usual_.end(), [](const UsualReading& usual) { return usual.may_differ(); });
  return !found_ && to_seconds(now - changed_since_) < kExamines_s &&
         (candidate_.empty() || !std::any_of(candidate_.begin(), candidate_.end(), is_benign));
}

std::optional<FaultWatch::Dip> FaultWatch::lamp_to_dip(Time now, std::span<const std::uint8_t> may) const {
  const double since_s = to_seconds(now - changed_since_), from_s = kBeforeDip_s * (1 << passed_by_);
  if (!changed_ || dip_ || dips_.size() >= kMostDips || likely_.size() < 2 || since_s < from_s ||
      since_s > from_s + kForDips_s || judged_at_ != now || is_benign(likely_.front()))
    return std::nullopt;
  Eigen::VectorXd error_lx(change_.before_lx.size());
  for (Index m = 0; m < error_lx.size(); ++m) error_lx[m] = noise_lx(static_cast<std::size_t>(m), kDipSamples);
  const auto lamp = lamp_that_tells(change_, likely_, may, kDippedTo, error_lx);
  if (!lamp) return std::nullopt;
  const bool again = std::any_of(dips_.begin(), dips_.end(), [&](const LampDip& dip) { return dip.fixture == *lamp; });
  return Dip{*lamp, again ? kDippedAgainTo : kDippedTo};
}

void FaultWatch::dip_begins(const Dip& dip) {
  dip_ = dip;
  dip_share_.assign(usual_.size(), {});
  dip_looks_ = 0;
}

bool FaultWatch::dip_is_read() const { return dip_ && dip_looks_ >= kDipSamples; }

void FaultWatch::dip_ends() {
  const std::optional<Dip> dip = std::exchange(dip_, std::nullopt);
  if (!dip || !changed_ || dip_looks_ < kDipSamples) return;
  LampDip done;
  done.fixture = dip->fixture;
  done.level_share = dip->level_share;
  done.change_lx.setConstant(change_.now_lx.size(), std::numeric_limits<double>::quiet_NaN());
  done.error_lx.setConstant(change_.now_lx.size(), kDark_lx);
  for (std::size_t m = 0; m < usual_.size(); ++m) {
    const auto row = static_cast<Index>(m);
    if (dip_share_[m].samples == 0 || !std::isfinite(change_.now_lx[row])) continue;
    done.change_lx[row] = (dip_share_[m].mean() / since_[m].mean() - 1) * change_.now_lx[row];
    done.error_lx[row] = noise_lx(m, dip_share_[m].samples);
  }
  dips_.push_back(std::move(done));
}

std::string FaultWatch::words(const ChangeCause& cause) const {
  const auto lamp = [&](std::size_t k) { return "\"" + (*fixtures_)[cause.who[k]].name + "\""; };
  const auto meter = [&](std::size_t k) { return "\"" + meters_[cause.who[k]] + "\""; };
  const double percent = 100 * std::max(0.0, cause.share);
  switch (cause.kind) {
    case Kind::lamp:
      if (cause.share < kNone)
        return fmt::format("lamp {} gives no light, though its device reports no fault", lamp(0));
      return fmt::format("lamp {} gives {:.0f} % of its light: dirt, a filter, or a failing lamp{}", lamp(0), percent,
                         meters_that_see(cause.who[0]) < 2 ? "; one luxmeter sees it, so it may also be knocked" : "");
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

/// Directly: reflections say little of where it shines.
int FaultWatch::meters_that_see(std::size_t fixture) const {
  int count = 0;
  for (Index m = 0; m < change_.before_lx.size(); ++m)
    count += change_.of_fixture(m, static_cast<Index>(fixture)) > kSeen * change_.before_lx[m];
  return count;
}

std::string FaultWatch::evidence() const {
  std::string list;
  int others = 0;
  for (Index m = 0; m < change_.now_lx.size(); ++m) {
    const double off = change_.now_lx[m] - change_.before_lx[m];
    if (!std::isfinite(off)) continue;
    if (std::abs(off) < 3 * change_.error_lx[m]) {
      ++others;
      continue;
    }
    list += fmt::format("{}\"{}\" {:.4g} lx, before {:.4g}", list.empty() ? "" : ", ",
                        meters_[static_cast<std::size_t>(m)], change_.now_lx[m], change_.before_lx[m]);
  }
  if (others > 0) list += fmt::format("; {} as before", others);
  return "readings: " + list + of_dips();
}

std::string FaultWatch::of_dips() const {
  std::string text;
  for (const LampDip& dip : dips_) {
    std::string followed;
    for (Index m = 0; m < dip.change_lx.size(); ++m)
      if (std::abs(dip.change_lx[m]) > 3 * dip.error_lx[m])
        followed += fmt::format("{}\"{}\" by {:+.3g} lx", followed.empty() ? "" : ", ",
                                meters_[static_cast<std::size_t>(m)], dip.change_lx[m]);
    text +=
        fmt::format("; when lamp \"{}\" was dimmed by {:.0f} %, {}", (*fixtures_)[dip.fixture].name,
                    100 * (1 - dip.level_share), followed.empty() ? "no luxmeter followed" : followed + " followed");
  }
  return text;
}

std::string FaultWatch::of_barred_dip(const std::vector<ChangeCause>& causes) const {
  if (!barred_ || (causes.size() == 1 && causes.front().kind != Kind::unclear)) return "";
  return fmt::format(
      "; dimming lamp \"{}\" for 8 s would tell more: do it by hand, or take fault_dips = false out of [control]",
      (*fixtures_)[*barred_].name);
}

void FaultWatch::tell(ShowStatus& status) const {
  if (found_) status.alarms.push_back({false, "", found_->text, found_->since});
}

}  // namespace luxrig
