#include "tools/scenario/show_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luxrig::scenario {
namespace {

constexpr double kTick_s = 0.02;
constexpr double kStatusPeriod_s = 0.1;  ///< of a daemon
/// Rounding, and a step of the lamp's output between two ticks of the truth.
constexpr double kLimitSlack = 1e-3;
/// After a command or a restart, light may change at once.
constexpr double kDisturbance_s = 0.6;
/// A real bus is written to every 0.02 s to 0.1 s.
constexpr double kLongestWait_s = 0.25;
/// Light follows an order through a bus and a lamp.
constexpr double kUntilDark_s = 0.1;
/// A verdict lags behind the light by a meter's sample, and a wrong one has to last.
constexpr double kWrongFor_s = 3, kAfterLie_s = 30;
/// A verdict's interval holds for 95 of 100; a truth this many tolerances off is no such chance.
constexpr double kCalledMet = 2;
/// How far the truth may be off the model beyond that.
constexpr double kOffModel = 1.25;
/// A fixture that hears again gets more light than meters asked for; a sample corrects that.
constexpr double kHearsAgain_s = 15;
/// Heads that have not turned for so long have arrived. A slower change is none.
constexpr double kAtRest_s = 1, kStill_rad = 1e-4;
constexpr double kLongestTurn_s = 30, kAfterDesk_s = 20;
constexpr double kHandWithin_s = 15, kLevelStep = 0.002;

constexpr const char* kSentences[] = {
    "no output exceeds a limit",
    "light does not jump unless somebody makes it",
    "the output cycle never waits",
    "what was acknowledged survives a restart",
    "a wrong meter cannot drive the light up",
    "nothing is called met that is not",
    "a blackout is dark and turns no head",
    "what a person holds by hand stays",
    "no lit beam meets a keep-out zone",
    "a daemon that ends in order leaves the safe look",
};

double turned_rad(const Joints& from, const Joints& to) {
  return std::max(std::abs(to.pan_rad - from.pan_rad), std::abs(to.tilt_rad - from.tilt_rad));
}

double most_turned_rad(const std::vector<Joints>& from, const std::vector<Joints>& to) {
  double most = 0;
  for (std::size_t f = 0; f < std::min(from.size(), to.size()); ++f) most = std::max(most, turned_rad(from[f], to[f]));
  return most;
}

double goal_or_limit_lx(const Rig& rig, std::size_t point, const ShowStatus& status) {
  const auto goal = status.points[point].goal_lx;
  return std::max(goal.value_or(0), rig.points[point].max_lx.value_or(0));
}

}  // namespace

ShowRules::ShowRules(const Rig& rig, const Slack& slack) : rig_(rig), slack_(slack), zones_(rig), judged_(rules) {
  static_assert(std::size(kSentences) == rules);
  for (std::size_t r = 0; r < rules; ++r) judged_[r].expected = kSentences[r];
  const double fastest_s =
      std::min({rig.control.fade_s, rig.control.correction_fade_s, rig.safe.fade_s, to_seconds(kExcessFades)});
  // An s-curve is steepest in its middle: 1.5 times its mean. Two fades may follow each other within a tick.
  max_step_ = fastest_s > 0 ? std::min(1.0, 1.5 * kTick_s / fastest_s * 1.25) : 1.0;
  max_rate_per_s_ = max_step_ / kTick_s;
  last_sent_s_.assign(rig.buses.size(), NAN);
}

void ShowRules::broken(Rule rule, double at_s, std::string found) {
  Judged& judged = judged_[rule];
  if (!judged.held) return;  // the first time is told
  judged.held = false;
  judged.at_s = at_s;
  judged.found = std::move(found);
}

void ShowRules::disturbed(double at_s) { disturbed_s_ = at_s; }

void ShowRules::desk(double at_s, bool there) {
  desk_ = there;
  desk_s_ = at_s;
}

bool ShowRules::disturbed_lately(double at_s) const {
  return disturbed_s_ && at_s - *disturbed_s_ <= kDisturbance_s + slack_.time_s;
}

bool ShowRules::deaf_lately(double at_s) const {
  return deaf_ > 0 || (deaf_s_ && (at_s - *deaf_s_ < kHearsAgain_s || meters_pause_.keeps(*deaf_s_) ||
                                   lamps_pause_.keeps(*deaf_s_)));
}

bool ShowRules::desk_lately(double at_s) const { return desk_ || (desk_s_ && at_s - *desk_s_ < kAfterDesk_s); }

void ShowRules::heads_may_turn(double at_s) { turning_s_ = at_s; }

void ShowRules::blackout(double at_s, bool on) {
  disturbed(at_s);
  if (on != dark_) pause(lamps_pause_, at_s, on);  // in the dark no meter teaches anything
  if (on && !dark_) dark_since_s_ = at_s;
  blackout_s_ = at_s;
  dark_ = on;
  dark_joints_.clear();
  // Heads that were at rest have no way to finish.
  if (on && (!turned_s_ || at_s - *turned_s_ > kAtRest_s)) dark_joints_ = joints_;
}

void ShowRules::lamps_are_stuck(double at_s, bool stuck) { pause(lamps_pause_, at_s, stuck); }

bool ShowRules::Pause::keeps(double changed_s) const { return reasons > 0 && changed_s > since_s - kHearsAgain_s; }

void ShowRules::pause(Pause& pause, double at_s, bool on) {
  if (on) {
    if (pause.reasons++ == 0) pause.since_s = at_s;
    return;
  }
  if (pause.reasons == 1) {
    const auto again = [&](double& changed_s) {
      if (pause.keeps(changed_s)) changed_s = at_s;
    };
    for (auto& [meter, lie] : lies_) again(lie.changed_s);
    if (unmodelled_s_) again(*unmodelled_s_);
    if (deaf_s_) again(*deaf_s_);
  }
  --pause.reasons;
}

void ShowRules::held_by_hand(double at_s, std::size_t fixture, double level, std::optional<double> for_s) {
  disturbed(at_s);
  hands_[fixture] = {level, at_s, for_s ? std::optional(at_s + *for_s) : std::nullopt, false};
}

void ShowRules::released(const std::vector<std::string>& names) {
  std::erase_if(hands_, [&](const auto& hand) {
    return names.empty() || std::find(names.begin(), names.end(), rig_.fixtures[hand.first].name) != names.end();
  });
}

void ShowRules::clock_stepped() {
  for (auto& [fixture, hand] : hands_) hand.end_unknown = hand.end_unknown || hand.until_s.has_value();
}

void ShowRules::bypassed(double at_s, const std::vector<std::string>& names, bool on) {
  disturbed(at_s);
  for (const std::string& name : names) {
    const bool changed = on ? bypassed_.insert(name).second : bypassed_.erase(name) > 0;
    const bool lamp = std::any_of(rig_.fixtures.begin(), rig_.fixtures.end(),
                                  [&](const Fixture& fixture) { return fixture.name == name; });
    if (changed && lamp) pause(lamps_pause_, at_s, on);
  }
}

void ShowRules::meter_lies(double at_s, std::size_t luxmeter, bool lies) {
  Lie& lie = lies_[luxmeter];
  lie.reasons += lies ? 1 : -1;
  lie.changed_s = at_s;
  if (lie.reasons == 0) lie.honest_lx = NAN, lie.most_lx = 0;
}

double ShowRules::least_gain() const { return rig_.control.gain_min * (1 - rig_.limits.open_loop_margin); }

bool ShowRules::lied_to_lately(std::optional<std::size_t> point, double at_s) const {
  return std::any_of(lies_.begin(), lies_.end(), [&](const auto& of) {
    return (!point || rig_.luxmeters[of.first].point == point) &&
           (of.second.reasons > 0 || at_s - of.second.changed_s < kHearsAgain_s ||
            lamps_pause_.keeps(of.second.changed_s) || meters_pause_.keeps(of.second.changed_s));
  });
}

bool ShowRules::any_lies_lately(double at_s, double for_s) const {
  return std::any_of(lies_.begin(), lies_.end(),
                     [&](const auto& of) { return of.second.reasons > 0 || at_s - of.second.changed_s <= for_s; });
}

void ShowRules::light_is_unmodelled(double at_s, bool unmodelled) {
  unmodelled_ = unmodelled;
  unmodelled_s_ = at_s;
}

void ShowRules::meter_is_mute(double at_s, bool mute) { pause(meters_pause_, at_s, mute); }

bool ShowRules::unmodelled_lately(double at_s, double for_s) const {
  return unmodelled_ || (unmodelled_s_ && (at_s - *unmodelled_s_ < for_s || lamps_pause_.keeps(*unmodelled_s_) ||
                                           meters_pause_.keeps(*unmodelled_s_)));
}

void ShowRules::fixture_is_deaf(double at_s, bool deaf) {
  deaf_ += deaf ? 1 : -1;
  deaf_s_ = at_s;
}

void ShowRules::daemon_gone(double at_s, const ShowStatus& last) {
  disturbed(at_s);
  gone_with_ = last;
  // Its last status may not know its last commands: what was acknowledged counts.
  const double unknown_s = kStatusPeriod_s + slack_.time_s;
  if (blackout_s_ && at_s - *blackout_s_ < unknown_s) gone_with_->blackout = dark_;
  if (by_hand_s_ && at_s - *by_hand_s_ < unknown_s)
    std::erase_if(gone_with_->by_hand, [&](const ByHand& held) {
      const auto hand = hands_.find(held.index);
      return held.what == ByHand::What::goal || hand == hands_.end() || hand->second.end_unknown ||
             hand->second.level != held.value;
    });
  for (double& sent_s : last_sent_s_) sent_s = NAN;
}

void ShowRules::daemon_back(double at_s, const ShowStatus& first) {
  disturbed(at_s);
  if (!gone_with_) return;
  if (gone_with_->blackout != first.blackout)
    broken(survives, at_s, first.blackout ? "a blackout that nobody ordered" : "the blackout is gone after a restart");
  for (const ByHand& held : gone_with_->by_hand) {
    if (held.of_plan || held.until) continue;
    const bool there = std::any_of(first.by_hand.begin(), first.by_hand.end(), [&](const ByHand& one) {
      return one.what == held.what && one.index == held.index && one.value == held.value;
    });
    const bool level = held.what == ByHand::What::level;
    if (!there)
      broken(survives, at_s,
             fmt::format("{} {} is no longer held by hand after a restart",
                         level ? rig_.fixtures[held.index].name : rig_.points[held.index].name,
                         level ? fmt::format("at level {:.3g}", held.value) : fmt::format("at {:.4g} lx", held.value)));
  }
  gone_with_.reset();
}

void ShowRules::ended_in_order(double at_s, const std::vector<double>& level) {
  if (desk_lately(at_s)) return;  // its light is what goes out
  for (std::size_t f = 0; f < level.size(); ++f) {
    const Fixture& fixture = rig_.fixtures[f];
    const double safe =
        std::min({fixture.safe_level.value_or(rig_.buses[fixture.bus].safe_level.value_or(rig_.safe.level)),
                  fixture.max_level, rig_.limits.max_level});
    // Limits may hold a lamp below its safe level.
    if (level[f] > safe + kLevelStep + slack_.level)
      broken(safe_at_end, at_s,
             fmt::format("{} is left at level {:.3f}, its safe level is {:.3f}", fixture.name, level[f], safe));
  }
}

void ShowRules::look(double at_s, const Instant& instant, const std::vector<bool>& sent) {
  for (std::size_t b = 0; b < sent.size(); ++b) {
    if (!sent[b]) continue;
    if (const double gap_s = at_s - last_sent_s_[b]; gap_s > kLongestWait_s + slack_.silence_s)
      broken(waits, at_s, fmt::format("nothing was sent on bus \"{}\" for {:.2f} s", rig_.buses[b].name, gap_s));
    last_sent_s_[b] = at_s;
  }
  look_at_limits(at_s, instant);
  look_at_jumps(at_s, instant);
  look_at_meters(at_s, instant);
  look_at_verdicts(at_s, instant);
  look_at_blackout(at_s, instant);
  look_at_hands(at_s, instant);
  look_at_zones(at_s, instant);
  before_ = instant.level;
  before_s_ = at_s;
  if (!dark_) lit_lux_ = instant.lux;
  if (joints_.empty() || most_turned_rad(joints_, instant.joints) > kStill_rad) turned_s_ = at_s;
  joints_ = instant.joints;
}

void ShowRules::look_without_daemon(double at_s, const Instant& instant, bool guarded) {
  if (guarded) {
    look_at_jumps(at_s, instant);
    look_at_blackout(at_s, instant);
    before_ = instant.level;
    before_s_ = at_s;
  }
  look_at_limits(at_s, instant);
  look_at_zones(at_s, instant);
}

void ShowRules::look_at_limits(double at_s, const Instant& instant) {
  for (std::size_t f = 0; f < instant.level.size(); ++f) {
    const double most = std::min(rig_.fixtures[f].max_level, rig_.limits.max_level);
    if (instant.level[f] > most + kLimitSlack + slack_.level)
      broken(
          limits, at_s,
          fmt::format("{} is sent level {:.3f}, its highest is {:.3f}", rig_.fixtures[f].name, instant.level[f], most));
  }
  // Daylight is nobody's output. Who shades a meter raises its lamps, until a sample after that corrects them.
  if (unmodelled_lately(at_s, kHearsAgain_s) || deaf_lately(at_s)) return;
  for (std::size_t p = 0; p < instant.lux.size(); ++p) {
    if (!rig_.points[p].max_lx || lied_to_lately(p, at_s)) continue;  // its own rule, look_at_meters
    double tolerance = kLimitSlack;
    bool measured = false;
    for (std::size_t m = 0; m < rig_.luxmeters.size(); ++m) {
      if (rig_.luxmeters[m].point != p) continue;
      measured = true;
      tolerance = std::max(tolerance, rig_.luxmeters[m].tolerance);
    }
    // Where nobody measures, the limit is the model's, with what meters elsewhere teach of the lamps.
    const double most = !measured && lied_to_lately(std::nullopt, at_s) ? kOffModel / least_gain() : 1 + tolerance;
    if (instant.lux[p] > *rig_.points[p].max_lx * most)
      broken(limits, at_s,
             fmt::format("{} gets {:.1f} lx, its limit is {:g} lx", rig_.points[p].name, instant.lux[p],
                         *rig_.points[p].max_lx));
  }
}

void ShowRules::look_at_jumps(double at_s, const Instant& instant) {
  if (before_.empty() || desk_lately(at_s) || disturbed_lately(at_s)) return;
  double max_step = max_step_;
  if (slack_.frames_s > 0)
    max_step += max_rate_per_s_ * (slack_.frames_s + std::max(0.0, at_s - before_s_ - kTick_s)) + slack_.level;
  for (std::size_t f = 0; f < instant.level.size(); ++f) {
    if (rig_.fixtures[f].switched) continue;
    const double step = std::abs(instant.level[f] - before_[f]);
    if (step > max_step + kLimitSlack)
      broken(jumps, at_s,
             fmt::format("{} jumps from level {:.3f} to {:.3f}", rig_.fixtures[f].name, before_[f], instant.level[f]));
  }
}

void ShowRules::look_at_meters(double at_s, const Instant& instant) {
  const Phase phase = instant.status->phase;
  if (phase == Phase::frozen || phase == Phase::safe_fading || phase == Phase::safe) safe_look_s_ = at_s;
  if (safe_look_s_ && at_s - *safe_look_s_ < kHearsAgain_s) return;  // no meter's doing
  for (auto& [m, lie] : lies_) {
    const auto point = rig_.luxmeters[m].point;
    if (!point || lie.reasons == 0) continue;
    const double lux = instant.lux[*point];
    if (std::isnan(lie.honest_lx)) lie.honest_lx = dark_ && !lit_lux_.empty() ? lit_lux_[*point] : lux;
    // A goal that is lowered lets light of others stay, which have goals of their own.
    lie.most_lx = std::max({lie.most_lx, lie.honest_lx, goal_or_limit_lx(rig_, *point, *instant.status)});
    // Lamps that give the least that readings can make it believe need most.
    const double allowed = lie.most_lx / least_gain() * kOffModel + 1;
    const bool by_hand_lately = !hands_.empty() || !bypassed_.empty() || desk_lately(at_s) ||
                                (disturbed_s_ && at_s - *disturbed_s_ < kHandWithin_s) ||
                                (hand_over_s_ && at_s - *hand_over_s_ < kHandWithin_s);
    if (!unmodelled_ && lux > allowed && !by_hand_lately && !deaf_lately(at_s))  // a deaf lamp stays where it was
      broken(wrong_meter, at_s,
             fmt::format("{} gets {:.1f} lx while its luxmeter \"{}\" is wrong; the model allows {:.1f}",
                         rig_.points[*point].name, lux, rig_.luxmeters[m].name, allowed));
  }
}

void ShowRules::look_at_verdicts(double at_s, const Instant& instant) {
  const bool believable =
      !any_lies_lately(at_s, kAfterLie_s) && !desk_lately(at_s) && !unmodelled_lately(at_s, kAfterLie_s);
  if (!believable || instant.status->phase != Phase::holding || instant.status->blackout) {
    wrong_since_s_.clear();
    return;
  }
  for (std::size_t p = 0; p < instant.lux.size(); ++p) {
    const PointStatus& point = instant.status->points[p];
    const bool wrong = point.met() && point.goal_lx && *point.goal_lx > 0 &&
                       std::abs(instant.lux[p] - *point.goal_lx) > kCalledMet * rig_.goal_tolerance(p) * *point.goal_lx;
    if (!wrong) {
      wrong_since_s_.erase(p);
      continue;
    }
    const double since_s = wrong_since_s_.try_emplace(p, at_s).first->second;
    if (at_s - since_s > kWrongFor_s + slack_.time_s)
      broken(met, at_s,
             fmt::format("{} is called met; its goal is {:.4g} lx, and it gets {:.4g} lx", rig_.points[p].name,
                         *point.goal_lx, instant.lux[p]));
  }
}

void ShowRules::look_at_blackout(double at_s, const Instant& instant) {
  if (!dark_) return;
  if (at_s - *dark_since_s_ < kUntilDark_s + slack_.time_s) return;
  for (std::size_t f = 0; f < instant.level.size(); ++f)
    if (instant.level[f] > 0)
      broken(dark, at_s, fmt::format("{} is sent level {:.3f} in a blackout", rig_.fixtures[f].name, instant.level[f]));
  const bool turning = desk_lately(at_s) || deaf_lately(at_s) || (turning_s_ && at_s - *turning_s_ < kLongestTurn_s);
  if (turning || instant.status->phase == Phase::moving || instant.status->plan_waits) {
    dark_joints_.clear();  // a movement goes on
    return;
  }
  if (dark_joints_.empty() && at_s - *dark_since_s_ > 1 + slack_.time_s) dark_joints_ = instant.joints;
  for (std::size_t f = 0; f < dark_joints_.size(); ++f) {
    const double rad = turned_rad(dark_joints_[f], instant.joints[f]);
    if (rad > rad_from_deg(1))
      broken(dark, at_s, fmt::format("{} turns by {:.1f}° in a blackout", rig_.fixtures[f].name, deg_from_rad(rad)));
  }
}

void ShowRules::look_at_hands(double at_s, const Instant& instant) {
  for (auto hand = hands_.begin(); hand != hands_.end();) {
    const auto& [f, held] = *hand;
    const bool listed =
        std::any_of(instant.status->by_hand.begin(), instant.status->by_hand.end(),
                    [f = f](const ByHand& one) { return one.what == ByHand::What::level && one.index == f; });
    if (held.end_unknown ? !listed : held.until_s && at_s >= *held.until_s - kTick_s) {
      hand = hands_.erase(hand);
      hand_over_s_ = at_s;
      continue;
    }
    if (held.end_unknown) {
      ++hand;
      continue;
    }
    const bool seen = at_s - held.since_s > 1 + slack_.time_s && at_s - disturbed_s_.value_or(0) >= slack_.time_s;
    if (seen && !listed)
      broken(
          by_hand, at_s,
          fmt::format("{} was set to level {:.3g} by hand, and is no longer held", rig_.fixtures[f].name, held.level));
    // Limits may hold it lower. Failures and blackouts override it while they last.
    const bool just_now = disturbed_lately(at_s);  // the status is a moment older
    if (!just_now && at_s - held.since_s > kHandWithin_s && instant.status->phase == Phase::holding && !dark_ &&
        !desk_lately(at_s) && instant.level[f] > held.level + kLevelStep + slack_.level)
      broken(by_hand, at_s,
             fmt::format("{} was set to level {:.3g} by hand, and is sent {:.3g}", rig_.fixtures[f].name, held.level,
                         instant.level[f]));
    ++hand;
  }
}

void ShowRules::look_at_zones(double at_s, const Instant& instant) {
  if (deaf_lately(at_s)) return;  // nobody knows where such a head looks
  for (const std::size_t f : zones_.heads()) {
    if (!(instant.level[f] > 0)) continue;
    if (const auto zone = zones_.met(f, instant.joints[f]))
      broken(keep_out, at_s,
             fmt::format("{} is lit at level {:.3f} and looks into \"{}\"", rig_.fixtures[f].name, instant.level[f],
                         zones_.name(*zone)));
  }
}

}  // namespace luxrig::scenario
