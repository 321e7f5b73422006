#include "tools/scenario/show.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/output/dimming.h"
#include "core/output/output_program.h"
#include "tools/process/files.h"
#include "tools/scenario/judge.h"
#include "tools/scenario/replay.h"
#include "tools/scenario/show_rules.h"

namespace luxrig::scenario {
namespace {

using What = Event::What;

constexpr double kRestart_s = 0.5, kTracePeriod_s = 0.2;

bool ends_the_daemon(What what) { return what == What::stop || what == What::kill || what == What::power_cut; }

/// Exit code of a killed process, as a shell tells it.
constexpr int kKilled = 128 + 9;

/// A fault after which a meter shows something else than its light.
bool makes_a_meter_lie(sim::FaultKind fault) {
  using sim::FaultKind;
  return fault == FaultKind::stuck || fault == FaultKind::lying;
}

/// A fixture on DMX with it does not give what it is sent, and nothing tells: other lamps make up for it, and when it
/// is well again there is more light than was asked for.
bool makes_deaf(sim::FaultKind fault) { return !makes_a_meter_lie(fault); }

class Show {
 public:
  Show(Venue& venue, const PreparedRig& prepared, const Scenario& scenario, std::uint64_t seed,
       const ShowOptions& options)
      : venue_(venue),
        prepared_(prepared),
        scenario_(scenario),
        rig_(prepared.session->rig),
        options_(options),
        judge_(scenario, rig_, venue.slack().window_s),
        rules_(rig_, venue.slack()) {
    outcome_.seed = seed;
    sent_.assign(rig_.buses.size(), false);
    desks_.assign(rig_.fixtures.size(), false);
    instant_.lux_hours.assign(rig_.points.size(), 0.0);
    instant_.level.assign(rig_.fixtures.size(), 0.0);
    instant_.reading_lx.resize(rig_.luxmeters.size());
    happened_s_.resize(scenario.events.size());
    held_s_.resize(scenario.events.size());
  }

  Outcome run() {
    start_daemon(true);
    while (outcome_.error.empty() && seconds() < scenario_.length_s) tick();
    outcome_.expectations = judge_.end(seconds());
    outcome_.rules = rules_.end();
    return std::move(outcome_);
  }

 private:
  [[nodiscard]] double seconds() const { return venue_.seconds(); }
  void log(std::string text) { outcome_.events.push_back({seconds(), std::move(text)}); }
  void fail(std::string why) {
    if (outcome_.error.empty()) outcome_.error = std::move(why);
  }

  // ---- the daemon ----

  void start_daemon(bool first) {
    if (const auto started = venue_.start(first); !started) return fail(started.error().detail);
    starting_ = true;
    if (venue_.runs()) daemon_runs(first);
  }

  void daemon_runs(bool first) {
    starting_ = false;
    running_ = true;
    instant_.status = &venue_.status();
    if (!first) rules_.daemon_back(seconds(), venue_.status());
    rules_.disturbed(seconds());
    rules_.heads_may_turn(seconds());
    if (!first) log("the daemon is back");
  }

  /// stop: fades to the safe look first, and ends when that is reached.
  void end_daemon(std::size_t e) {
    ending_ = e;
    rules_.disturbed(seconds());
    if (scenario_.events[e].what != What::stop) return daemon_ends({kKilled, false});
    venue_.stop();
  }

  void daemon_ends(const Ended& how) {
    const Event& event = scenario_.events[*ending_];
    ending_.reset();
    if (event.what == What::stop && how.in_safe_look) rules_.ended_in_order(seconds(), instant_.level);
    left_ = venue_.status();
    instant_.status = &left_;
    instant_.exit = how.code;
    rules_.daemon_gone(seconds(), left_);
    venue_.kill(event.what == What::power_cut);
    running_ = false;
    back_s_ = seconds() + event.for_s.value_or(kRestart_s);
    if (event.what == What::power_cut) power(false);
  }

  void power(bool on) {
    for (const Fixture& fixture : rig_.fixtures) venue_.faults().set(fixture.name, sim::FaultKind::unpowered, !on);
    for (const Luxmeter& meter : rig_.luxmeters) venue_.faults().set(meter.name, sim::FaultKind::unpowered, !on);
    cut_ = !on;
    if (!on) return;
    // What has no power for another reason stays without.
    for (std::size_t e = 0; e < scenario_.events.size(); ++e) {
      const Event& event = scenario_.events[e];
      if (event.what != What::fault || event.fault != sim::FaultKind::unpowered || !lasts(e)) continue;
      for (const std::string& device : event.on) venue_.faults().set(device, event.fault, true);
    }
  }

  // ---- time ----

  void tick() {
    begin_events();
    end_lasting();
    replay();
    if (const auto went_on = venue_.advance(); !went_on) return fail(went_on.error().detail);
    if (starting_ && venue_.runs()) daemon_runs(false);
    if (!running_ && !starting_ && seconds() >= back_s_ - 1e-9) restart();
    look();
    if (!running_ || !ending_) return;
    if (const auto how = venue_.ended()) daemon_ends(*how);
  }

  void restart() {
    if (cut_) power(true);
    start_daemon(false);
  }

  /// While no daemon runs, its status is as it left it, and lamps do what they do without data.
  void look() {
    if (running_) instant_.status = &venue_.status();
    venue_.see(instant_, sent_);
    if (pending_ > 0) rules_.disturbed(seconds());
    if (running_)
      rules_.look(seconds(), instant_, sent_);
    else
      rules_.look_without_daemon(seconds(), instant_, venue_.guarded());
    std::fill(sent_.begin(), sent_.end(), false);
    if (const Phase phase = instant_.status->phase; phase != phase_) {
      phase_ = phase;
      log(fmt::format("phase {}", luxrig::name_of(phase)));
    }
    judge_.look(seconds(), instant_);
    remember_conditions();
    if (options_.trace && seconds() >= next_trace_s_ - 1e-9) trace();
  }

  void trace() {
    next_trace_s_ += kTracePeriod_s;
    Trace& trace = outcome_.trace;
    if (trace.columns.empty()) {
      for (const Point& point : rig_.points) trace.columns.push_back("lux " + point.name);
      for (const Luxmeter& meter : rig_.luxmeters) trace.columns.push_back("reading " + meter.name);
      for (const Fixture& fixture : rig_.fixtures) trace.columns.push_back("level " + fixture.name);
      trace.columns.emplace_back("phase");
    }
    trace.at_s.push_back(seconds());
    std::vector<double> row = instant_.lux;
    for (const auto& reading : instant_.reading_lx) row.push_back(reading.value_or(NAN));
    row.insert(row.end(), instant_.level.begin(), instant_.level.end());
    row.push_back(static_cast<double>(phase_));
    trace.rows.push_back(std::move(row));
  }

  // ---- events ----

  /// Instants at which conditions of events first hold.
  void remember_conditions() {
    for (std::size_t e = 0; e < scenario_.events.size(); ++e)
      if (const auto& when = scenario_.events[e].when; when && !held_s_[e] && holds_for_all(*when, instant_))
        held_s_[e] = seconds();
  }

  [[nodiscard]] std::optional<double> due_s(std::size_t e) const {
    const Event& event = scenario_.events[e];
    if (!event.after && !event.when) return event.at_s;
    const auto& base_s = event.after ? happened_s_[*event.after] : held_s_[e];
    return base_s ? std::optional(*base_s + event.at_s) : std::nullopt;
  }

  void begin_events() {
    for (std::size_t e = 0; e < scenario_.events.size(); ++e) {
      if (happened_s_[e]) continue;
      const auto due = due_s(e);
      if (!due || seconds() < *due - 1e-9) continue;
      if (ends_the_daemon(scenario_.events[e].what) && pending_ > 0) continue;  // it answers first
      happened_s_[e] = seconds();
      if (!is_command(scenario_.events[e].what)) judge_.happened(e, seconds());
      begin(e);
    }
  }

  void end_lasting() {
    for (std::size_t e = 0; e < scenario_.events.size(); ++e) {
      const Event& event = scenario_.events[e];
      if (!event.for_s || !lasts(e) || ends_the_daemon(event.what)) continue;
      if (seconds() < *happened_s_[e] + *event.for_s - 1e-9) continue;
      const bool by_command = event.what == What::blackout || event.what == What::bypass;
      if (by_command && !running_) continue;  // as soon as it is back
      ended_.insert(e);
      end(event);
    }
  }

  /// It has begun and not ended.
  [[nodiscard]] bool lasts(std::size_t e) const { return happened_s_[e] && !ended_.contains(e); }

  /// Outcome of a command. With it the time of what is expected after the command begins.
  void answered(std::size_t e, const Result<void>& answer) {
    const Event& event = scenario_.events[e];
    judge_.happened(e, seconds());
    if (!answer) outcome_.refused.push_back(e);
    if (options_.answers_expected && answer.has_value() == event.refused)
      fail(event.refused
               ? fmt::format("line {}: {} was accepted, and had to be refused", event.in_file.line, name_of(event.what))
               : fmt::format("line {}: {} is refused: {}", event.in_file.line, name_of(event.what),
                             answer.error().detail));
    if (!answer && !answer.error().detail.empty()) log(fmt::format("refused: {}", answer.error().detail));
  }

  /// What rules know of a command that the daemon has answered.
  void took_effect(const Event& event, double begun_s, bool taken) {
    rules_.disturbed(seconds());
    if (may_turn_heads(event.what)) rules_.heads_may_turn(seconds());
    if (event.what == What::blackout) rules_.blackout(seconds(), true);
    if (!taken) return;
    if (event.what == What::goal || event.what == What::level || event.what == What::release)
      rules_.by_hand_changed(seconds());
    if (event.what == What::release) rules_.released(event.on);
    if (event.what == What::bypass || event.what == What::end_bypass)
      rules_.bypassed(seconds(), event.on, event.what == What::bypass);
    if (event.what != What::level) return;
    for (std::size_t f = 0; f < rig_.fixtures.size(); ++f)
      if (std::find(event.on.begin(), event.on.end(), rig_.fixtures[f].name) != event.on.end())
        rules_.held_by_hand(begun_s, f, *event.value, event.for_s);
  }

  static bool may_turn_heads(What what) { return what == What::apply || what == What::park || what == What::release; }

  void command(std::size_t e) {
    const Event& event = scenario_.events[e];
    rules_.disturbed(seconds());
    if (may_turn_heads(event.what)) rules_.heads_may_turn(seconds());
    if (event.what == What::lift_blackout) rules_.blackout(seconds(), false);
    std::string plan;
    if (event.what == What::apply) {
      plan = to_json(prepared_.plan);
      if (event.plan) {
        auto text = read_file(*event.plan);
        if (!text) return fail(text.error().front().text());
        plan = std::move(*text);
      }
    }
    ++pending_;
    venue_.command(event, plan, [this, e, begun_s = seconds()](const Result<void>& answer) {
      --pending_;
      took_effect(scenario_.events[e], begun_s, answer.has_value());
      answered(e, answer);
    });
  }

  void begin(std::size_t e) {
    const Event& event = scenario_.events[e];
    log(event.name.empty() ? text_of(event) : fmt::format("{} ({})", event.name, text_of(event)));
    const bool needs_daemon = is_command(event.what) || ends_the_daemon(event.what);
    if (needs_daemon && (!running_ || ending_)) {
      if (is_command(event.what)) answered(e, refusal("no daemon runs"));
      return;  // what has gone cannot end
    }
    if (is_command(event.what)) return command(e);
    switch (event.what) {
      case What::desk:
        return desk_sends(event, true);
      case What::cover:
        for (const std::size_t m : event.which) {
          venue_.in_room([&](sim::World& world) { world.set_cover(m, *event.value); });
          rules_.meter_lies(seconds(), m, true);
        }
        return;
      case What::shade:
        set_shades(event, *event.value);
        return rules_.light_is_unmodelled(seconds(), true);
      case What::daylight:
        venue_.in_room([&](sim::World& world) { world.set_daylight(*event.value); });
        return rules_.light_is_unmodelled(seconds(), true);
      case What::stop:
      case What::kill:
      case What::power_cut:
        return end_daemon(e);
      case What::replay: {
        const Replay& replay = replays_.try_emplace(e, rig_, event.recording, replay_time()).first->second;
        for (const std::size_t m : replay.luxmeters()) rules_.meter_lies(seconds(), m, true);
        return;
      }
      case What::clock_step:
        rules_.clock_stepped();
        if (const auto stepped = venue_.step_wall_clock(*event.value); !stepped)
          fail(fmt::format("line {}: {}", event.in_file.line, stepped.error().detail));
        return;
      case What::kill_guardian:
        if (const auto killed = venue_.kill_guardian(); !killed)
          fail(fmt::format("line {}: {}", event.in_file.line, killed.error().detail));
        return;
      case What::fault:
        return set_faults(event, true);
      default:
        return;  // commands
    }
  }

  void set_shades(const Event& event, double share) {
    venue_.in_room([&](sim::World& world) {
      for (const std::size_t p : event.which) world.set_shade(p, share);
    });
  }

  /// Commands the end of what a command began.
  void command_end(const Event& event, What what) {
    log(std::string(name_of(what)));
    Event end = event;
    end.what = what;
    ++pending_;
    venue_.command(end, {}, [this, end](const Result<void>&) {
      --pending_;
      rules_.disturbed(seconds());
      if (end.what == What::end_bypass) rules_.bypassed(seconds(), end.on, false);
    });
  }

  void end(const Event& event) {
    switch (event.what) {
      case What::blackout:
        rules_.blackout(seconds(), false);
        return command_end(event, What::lift_blackout);
      case What::bypass:
        return command_end(event, What::end_bypass);
      case What::desk:
        log("the desk is lost");
        return desk_sends(event, false);
      case What::cover:
        log("the meter is free again");
        for (const std::size_t m : event.which) {
          venue_.in_room([&](sim::World& world) { world.set_cover(m, 1); });
          rules_.meter_lies(seconds(), m, false);
        }
        return;
      case What::shade:
        log("nobody stands in the light");
        set_shades(event, 1);
        return rules_.light_is_unmodelled(seconds(), false);
      case What::daylight:
        log("daylight as before");
        venue_.in_room([](sim::World& world) { world.set_daylight(1); });
        return rules_.light_is_unmodelled(seconds(), false);
      case What::level:  // the daemon releases it
        return rules_.disturbed(seconds());
      case What::replay:
        return end_replay(static_cast<std::size_t>(&event - scenario_.events.data()));
      case What::fault:
        return set_faults(event, false);
      default:  // nothing else lasts, or the daemon ends it by itself
        return;
    }
  }

  void desk_sends(const Event& event, bool on) {
    for (const std::size_t f : event.which) {
      std::optional<DeskCommand> command;
      if (on) command = DeskCommand{f, drive_for(rig_.fixtures[f], *event.value), std::nullopt};
      if (on && rig_.fixtures[f].moves && (event.pan_rad || event.tilt_rad)) {
        Joints joints = rig_.fixtures[f].joints;
        joints.pan_rad = event.pan_rad.value_or(joints.pan_rad);
        joints.tilt_rad = event.tilt_rad.value_or(joints.tilt_rad);
        command->joints = joints;
      }
      set_desk(f, command);
    }
    tell_of_desk();
  }

  void set_desk(std::size_t fixture, const std::optional<DeskCommand>& command) {
    venue_.desk(fixture, command);
    desks_[fixture] = command.has_value();
  }

  void tell_of_desk() {
    const bool any = std::find(desks_.begin(), desks_.end(), true) != desks_.end();
    if (any || desk_there_) rules_.desk(seconds(), any);
    desk_there_ = any;
  }

  /// Of recordings: receivers in it take a clock at 0 for "never".
  [[nodiscard]] Time replay_time() const { return Time{} + std::chrono::hours(1) + from_seconds(seconds()); }

  /// What the recordings being replayed have by now, to desk and luxmeters.
  void replay() {
    const Time at = replay_time();
    std::vector<std::size_t> over;
    for (auto& entry : replays_) {
      Replay& replay = entry.second;
      if (replay.is_over(at)) {
        over.push_back(entry.first);
        continue;
      }
      venue_.in_room([&](sim::World& world) {
        for (const std::size_t m : replay.luxmeters()) world.set_shown(m, replay.reading_lx(m, at));
      });
      std::map<std::size_t, DeskCommand> sent;
      for (const DeskCommand& command : replay.desk(at)) sent[command.fixture] = command;
      for (const std::size_t f : replay.fixtures()) {
        const auto command = sent.find(f);
        set_desk(f, command != sent.end() ? std::optional(command->second) : std::nullopt);
      }
      tell_of_desk();
    }
    for (const std::size_t e : over) {
      ended_.insert(e);
      end_replay(e);
    }
  }

  void end_replay(std::size_t e) {
    log("the recording is over");
    const Replay& replay = replays_.at(e);
    for (const std::size_t m : replay.luxmeters()) {
      venue_.in_room([&](sim::World& world) { world.set_shown(m, std::nullopt); });
      rules_.meter_lies(seconds(), m, false);
    }
    for (const std::size_t f : replay.fixtures()) set_desk(f, std::nullopt);
    replays_.erase(e);
    tell_of_desk();
  }

  void set_faults(const Event& event, bool on) {
    if (!on) log("well again: " + text_of(event));
    for (const std::string& device : event.on) {
      venue_.faults().set(device, event.fault, on, event.value);
      if (makes_deaf(event.fault))
        for (const Fixture& fixture : rig_.fixtures) {
          const bool dead_bus = event.fault == sim::FaultKind::dead && fixture.name != device;  // which is noticed
          if ((fixture.name == device || rig_.buses[fixture.bus].name == device) && !dead_bus &&
              !std::holds_alternative<ModbusPatch>(fixture.patch))
            rules_.fixture_is_deaf(seconds(), on);
        }
      const bool bus =
          std::any_of(rig_.buses.begin(), rig_.buses.end(), [&](const Bus& b) { return b.name == device; });
      if (bus && event.fault == sim::FaultKind::dead) rules_.lamps_are_stuck(seconds(), on);
      for (std::size_t m = 0; m < rig_.luxmeters.size(); ++m) {
        const bool itself = rig_.luxmeters[m].name == device;
        if (makes_a_meter_lie(event.fault)) {
          if (itself) rules_.meter_lies(seconds(), m, on);
        } else if (itself || rig_.buses[rig_.luxmeters[m].bus].name == device) {
          rules_.meter_is_mute(seconds(), on);
        }
      }
    }
  }

  [[nodiscard]] static std::string text_of(const Event& event) {
    std::string text(event.what == What::fault ? sim::name_of(event.fault) : name_of(event.what));
    for (const std::string& name : event.on) text += " " + name;
    if (event.recording) text += " " + event.recording_file.string();
    if (event.value) text += fmt::format(" {:g}", *event.value);
    if (event.for_s) text += fmt::format(" for {:g} s", *event.for_s);
    return text;
  }

  Venue& venue_;
  const PreparedRig& prepared_;
  const Scenario& scenario_;
  const Rig& rig_;
  ShowOptions options_;
  double back_s_ = 0, next_trace_s_ = 0;
  bool running_ = false, starting_ = false;  ///< the daemon
  bool cut_ = false, desk_there_ = false;
  int pending_ = 0;                    ///< commands without an answer
  std::optional<std::size_t> ending_;  ///< event that ends the daemon, while that takes time
  ShowStatus left_;                    ///< by the daemon that has gone
  Instant instant_;
  std::vector<bool> sent_;   ///< per bus
  std::vector<bool> desks_;  ///< per fixture: a lighting desk sends for it
  Phase phase_ = Phase::idle;
  std::vector<std::optional<double>> happened_s_, held_s_;  ///< per event; held: of its condition
  std::set<std::size_t> ended_;
  std::map<std::size_t, Replay> replays_;  ///< by event, while it lasts
  Judge judge_;
  ShowRules rules_;
  Outcome outcome_;
};

}  // namespace

Outcome run_show(Venue& venue, const PreparedRig& rig, const Scenario& scenario, std::uint64_t seed,
                 const ShowOptions& options) {
  return Show(venue, rig, scenario, seed, options).run();
}

}  // namespace luxrig::scenario
