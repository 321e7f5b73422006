#include "tools/scenario/stepped_show.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "tools/luxrigd/daemon.h"
#include "tools/process/clock.h"
#include "tools/process/files.h"
#include "tools/scenario/judge.h"
#include "tools/scenario/replay.h"
#include "tools/scenario/show_rules.h"
#include "tools/scenario/stepped_bus.h"

namespace luxrig::scenario {
namespace {

using What = Event::What;

constexpr Time kBegin = Time{} + std::chrono::hours(1);  // a clock at 0 would look like "never"
constexpr double kRestart_s = 0.5, kTracePeriod_s = 0.2;

/// A folder in memory for the daemon's state, as long as this lives.
class StateFolder {
 public:
  StateFolder() {
    std::error_code error;
    std::string name =
        (std::filesystem::exists("/dev/shm", error) ? "/dev/shm" : "/tmp") + std::string("/luxrig-test-XXXXXX");
    if (::mkdtemp(name.data()) != nullptr) path_ = name;
  }
  StateFolder(const StateFolder&) = delete;
  StateFolder& operator=(const StateFolder&) = delete;
  ~StateFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

bool ends_the_daemon(What what) { return what == What::stop || what == What::kill || what == What::power_cut; }

/// A fault after which a meter shows something else than its light.
bool makes_a_meter_lie(sim::FaultKind fault) {
  using sim::FaultKind;
  return fault == FaultKind::stuck || fault == FaultKind::lying;
}

/// A fixture on DMX with it does not give what it is sent, and nothing tells: other lamps make up for it, and when it
/// is well again there is more light than was asked for.
bool makes_deaf(sim::FaultKind fault) { return !makes_a_meter_lie(fault); }

class SteppedShow {
 public:
  SteppedShow(const PreparedRig& prepared, const Scenario& scenario, std::unique_ptr<sim::World> world,
              std::uint64_t seed, const ShowOptions& options)
      : prepared_(prepared),
        scenario_(scenario),
        rig_(prepared.session->rig),
        options_(options),
        devices_(rig_, std::move(world), {.start = kBegin, .fault_seed = seed}),
        judge_(scenario, rig_),
        rules_(rig_) {
    outcome_.seed = seed;
    wires_ = {std::vector<double>(rig_.fixtures.size(), 0.0), std::vector<std::optional<double>>(rig_.luxmeters.size()),
              std::vector<bool>(rig_.buses.size(), false),
              std::vector<std::optional<DeskCommand>>(rig_.fixtures.size())};
    instant_.lux_hours.assign(rig_.points.size(), 0.0);
    instant_.level.assign(rig_.fixtures.size(), 0.0);
    happened_s_.resize(scenario.events.size());
    held_s_.resize(scenario.events.size());
    if (std::any_of(scenario.events.begin(), scenario.events.end(),
                    [](const Event& event) { return ends_the_daemon(event.what); }))
      state_.emplace();
    time_ = kBegin;
    stepped_time = &time_;
  }
  SteppedShow(const SteppedShow&) = delete;
  SteppedShow& operator=(const SteppedShow&) = delete;
  ~SteppedShow() {
    daemon_.reset();
    stepped_time = nullptr;
  }

  Outcome run() {
    start_daemon(true);
    while (outcome_.error.empty() && seconds() < scenario_.length_s) tick();
    outcome_.expectations = judge_.end(seconds());
    outcome_.rules = rules_.end();
    return std::move(outcome_);
  }

 private:
  [[nodiscard]] double seconds() const { return to_seconds(time_.load() - kBegin); }
  void log(std::string text) { outcome_.events.push_back({seconds(), std::move(text)}); }
  void fail(std::string why) {
    if (outcome_.error.empty()) outcome_.error = std::move(why);
  }

  // ---- the daemon ----

  void start_daemon(bool first) {
    DaemonOptions options;
    options.simulated = true;
    if (state_) options.state_folder = state_->path();
    options.stepped_driver = [this](const Rig& rig, std::size_t bus) -> std::unique_ptr<Driver> {
      const bool reads = !rig.luxmeters.empty() && bus == rig.luxmeters.front().bus;
      return std::make_unique<SteppedBus>(rig, bus, devices_, wires_, bus == 0, reads);
    };
    options.light_model = [this](const Session& session, const std::vector<Joints>& joints) {
      return prepared_.looks->model(session, joints);
    };
    daemon_ = std::make_unique<Daemon>(prepared_.session, prepared_.light, std::move(options));
    if (const auto started = daemon_->start(); !started)
      return fail("the daemon does not start: " + started.error().detail);
    handlers_ = daemon_->handlers();
    bool resumed = false;
    if (state_ && !first) resumed = daemon_->resume(Journal(state_->path()).load()).plan;
    if (!resumed && !scenario_.starts_dark)
      if (const auto applied = daemon_->apply(prepared_.plan, true); !applied)
        fail("the solved plan is refused: " + applied.error().front().text());
    daemon_->tick();
    instant_.status = &daemon_->status();
    if (!first) rules_.daemon_back(seconds(), daemon_->status());
    rules_.disturbed(seconds());
    rules_.heads_may_turn(seconds());
  }

  /// stop: fades to the safe look first, and ends when that is reached.
  void end_daemon(std::size_t e) {
    ending_ = e;
    rules_.disturbed(seconds());
    if (scenario_.events[e].what != What::stop) return daemon_ends();
    daemon_->go_safe();
    ends_s_ = seconds() + rig_.safe.fade_s + 2;
  }

  void daemon_ends() {
    const Event& event = scenario_.events[*ending_];
    ending_.reset();
    if (event.what == What::stop && daemon_->status().phase == Phase::safe)
      rules_.ended_in_order(seconds(), instant_.level);
    left_ = daemon_->status();
    instant_.status = &left_;
    rules_.daemon_gone(seconds(), left_);
    daemon_.reset();
    handlers_ = {};
    back_s_ = seconds() + event.for_s.value_or(kRestart_s);
    if (event.what == What::power_cut) power(false);
  }

  void power(bool on) {
    for (const Fixture& fixture : rig_.fixtures) devices_.faults().set(fixture.name, sim::FaultKind::unpowered, !on);
    for (const Luxmeter& meter : rig_.luxmeters) devices_.faults().set(meter.name, sim::FaultKind::unpowered, !on);
    cut_ = !on;
    if (!on) return;
    // What has no power for another reason stays without.
    for (std::size_t e = 0; e < scenario_.events.size(); ++e) {
      const Event& event = scenario_.events[e];
      if (event.what != What::fault || event.fault != sim::FaultKind::unpowered || !lasts(e)) continue;
      for (const std::string& device : event.on) devices_.faults().set(device, event.fault, true);
    }
  }

  // ---- time ----

  void tick() {
    begin_events();
    end_lasting();
    time_ = time_.load() + kTick;
    replay();
    if (daemon_)
      daemon_->tick();
    else if (seconds() >= back_s_ - 1e-9)
      restart();
    devices_.advance(time_);
    look();
    if (daemon_ && ending_ && (daemon_->status().phase == Phase::safe || seconds() >= ends_s_)) daemon_ends();
  }

  void restart() {
    if (cut_) power(true);
    start_daemon(false);
    log("the daemon is back");
  }

  /// While no daemon runs, its status is as it left it, and lamps do what they do without data.
  void look() {
    if (daemon_) instant_.status = &daemon_->status();
    const std::vector<sim::PointTruth> points = devices_.world().points();
    instant_.lux.resize(points.size());
    for (std::size_t p = 0; p < points.size(); ++p) {
      instant_.lux[p] = points[p].lux;
      instant_.lux_hours[p] += points[p].lux * to_seconds(kTick) / 3600;
    }
    instant_.reading_lx = wires_.reading_lx;
    for (std::size_t f = 0; f < rig_.fixtures.size(); ++f)
      instant_.level[f] = level_from_drive(rig_.fixtures[f].dimmer_curve, wires_.drive[f]);
    instant_.joints = devices_.world().joints();
    if (daemon_)
      rules_.look(seconds(), instant_, wires_.sent);
    else
      rules_.look_without_daemon(seconds(), instant_);
    std::fill(wires_.sent.begin(), wires_.sent.end(), false);
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
      happened_s_[e] = seconds();
      judge_.happened(e, seconds());
      begin(e);
    }
  }

  void end_lasting() {
    for (std::size_t e = 0; e < scenario_.events.size(); ++e) {
      const Event& event = scenario_.events[e];
      if (!event.for_s || !lasts(e) || ends_the_daemon(event.what)) continue;
      if (seconds() < *happened_s_[e] + *event.for_s - 1e-9) continue;
      const bool by_command = event.what == What::blackout || event.what == What::bypass;
      if (by_command && !daemon_) continue;  // as soon as it is back
      ended_.insert(e);
      end(event);
    }
  }

  /// It has begun and not ended.
  [[nodiscard]] bool lasts(std::size_t e) const { return happened_s_[e] && !ended_.contains(e); }

  /// Outcome of a command.
  template <class Answer>
  void answered(const Event& event, const Answer& answer) {
    std::string said;
    if constexpr (std::is_same_v<typename Answer::error_type, Fault>) {
      if (!answer) said = answer.error().detail;
    } else {
      if (!answer) said = answer.error().front().text();
    }
    if (!answer) outcome_.refused.push_back(static_cast<std::size_t>(&event - scenario_.events.data()));
    if (options_.answers_expected && answer.has_value() == event.refused)
      fail(event.refused
               ? fmt::format("line {}: {} was accepted, and had to be refused", event.in_file.line, name_of(event.what))
               : fmt::format("line {}: {} is refused: {}", event.in_file.line, name_of(event.what), said));
    if (!said.empty()) log(fmt::format("refused: {}", said));
  }

  void begin(std::size_t e) {
    const Event& event = scenario_.events[e];
    log(event.name.empty() ? text_of(event) : fmt::format("{} ({})", event.name, text_of(event)));
    const bool needs_daemon = is_command(event.what) || ends_the_daemon(event.what);
    if (needs_daemon && (!daemon_ || ending_)) {
      if (is_command(event.what)) answered(event, Result<void>(refusal("no daemon runs")));
      return;  // what has gone cannot end
    }
    if (is_command(event.what)) rules_.disturbed(seconds());
    if (event.what == What::apply || event.what == What::park || event.what == What::release)
      rules_.heads_may_turn(seconds());
    switch (event.what) {
      case What::apply: {
        std::string plan = to_json(prepared_.plan);
        if (event.plan) {
          auto text = read_file(*event.plan);
          if (!text) return fail(text.error().front().text());
          plan = std::move(*text);
        }
        return answered(event, handlers_.apply(plan));
      }
      case What::blackout:
        rules_.blackout(seconds(), true);
        return answered(event, handlers_.blackout(true));
      case What::lift_blackout:
        rules_.blackout(seconds(), false);
        return answered(event, handlers_.blackout(false));
      case What::level: {
        const auto done = handlers_.level(event.on, *event.value, event.for_s);
        if (done)
          for (std::size_t f = 0; f < rig_.fixtures.size(); ++f)
            if (std::find(event.on.begin(), event.on.end(), rig_.fixtures[f].name) != event.on.end())
              rules_.held_by_hand(seconds(), f, *event.value, event.for_s);
        return answered(event, done);
      }
      case What::goal:
        return answered(event, handlers_.goal(event.on, *event.value, event.for_s));
      case What::release: {
        const auto done = handlers_.release(event.on);
        if (done) rules_.released(event.on);
        return answered(event, done);
      }
      case What::park:
        return answered(event, handlers_.park(event.on));
      case What::bypass:
      case What::end_bypass:
        return answered(event, handlers_.bypass(event.on, event.what == What::bypass));
      case What::desk:
        return desk_sends(event, true);
      case What::cover:
        for (const std::size_t m : event.which) {
          devices_.world().set_cover(m, *event.value);
          rules_.meter_lies(seconds(), m, true);
        }
        return;
      case What::shade:
        for (const std::size_t p : event.which) devices_.world().set_shade(p, *event.value);
        return rules_.light_is_unmodelled(seconds(), true);
      case What::daylight:
        devices_.world().set_daylight(*event.value);
        return rules_.light_is_unmodelled(seconds(), true);
      case What::replay: {
        const Replay& replay = replays_.try_emplace(e, rig_, event.recording, time_.load()).first->second;
        for (const std::size_t m : replay.luxmeters()) rules_.meter_lies(seconds(), m, true);
        return;
      }
      case What::stop:
      case What::kill:
      case What::power_cut:
        return end_daemon(e);
      case What::fault:
        return set_faults(event, true);
    }
  }

  void end(const Event& event) {
    switch (event.what) {
      case What::blackout:
        log("lift_blackout");
        rules_.blackout(seconds(), false);
        (void)handlers_.blackout(false);
        return;
      case What::bypass:
        log("end_bypass");
        (void)handlers_.bypass(event.on, false);
        return rules_.disturbed(seconds());
      case What::desk:
        log("the desk is lost");
        return desk_sends(event, false);
      case What::cover:
        log("the meter is free again");
        for (const std::size_t m : event.which) {
          devices_.world().set_cover(m, 1);
          rules_.meter_lies(seconds(), m, false);
        }
        return;
      case What::shade:
        log("nobody stands in the light");
        for (const std::size_t p : event.which) devices_.world().set_shade(p, 1);
        return rules_.light_is_unmodelled(seconds(), false);
      case What::daylight:
        log("daylight as before");
        devices_.world().set_daylight(1);
        return rules_.light_is_unmodelled(seconds(), false);
      case What::replay:
        return end_replay(static_cast<std::size_t>(&event - scenario_.events.data()));
      case What::level:  // the daemon releases it
        return rules_.disturbed(seconds());
      case What::fault:
        return set_faults(event, false);
      default:  // nothing else lasts, or the daemon ends it by itself
        return;
    }
  }

  void desk_sends(const Event& event, bool on) {
    for (const std::size_t f : event.which) {
      std::optional<DeskCommand>& command = wires_.desk[f];
      command.reset();
      if (!on) continue;
      command = DeskCommand{f, drive_from_level(rig_.fixtures[f].dimmer_curve, *event.value), std::nullopt};
      if (!rig_.fixtures[f].moves || (!event.pan_rad && !event.tilt_rad)) continue;
      Joints joints = rig_.fixtures[f].joints;
      joints.pan_rad = event.pan_rad.value_or(joints.pan_rad);
      joints.tilt_rad = event.tilt_rad.value_or(joints.tilt_rad);
      command->joints = joints;
    }
    tell_of_desk();
  }

  void tell_of_desk() {
    const bool any =
        std::any_of(wires_.desk.begin(), wires_.desk.end(), [](const auto& one) { return one.has_value(); });
    if (any || desk_there_) rules_.desk(seconds(), any);
    desk_there_ = any;
  }

  /// What the recordings being replayed have by now, to desk and luxmeters.
  void replay() {
    for (std::size_t e = 0; e < scenario_.events.size(); ++e) {
      const auto found = replays_.find(e);
      if (found == replays_.end()) continue;
      Replay& replay = found->second;
      if (replay.is_over(time_)) {
        ended_.insert(e);
        end_replay(e);
        continue;
      }
      for (const std::size_t m : replay.luxmeters()) devices_.world().set_shown(m, replay.reading_lx(m, time_));
      for (const std::size_t f : replay.fixtures()) wires_.desk[f].reset();
      for (const DeskCommand& command : replay.desk(time_)) wires_.desk[command.fixture] = command;
      tell_of_desk();
    }
  }

  void end_replay(std::size_t e) {
    log("the recording is over");
    const Replay& replay = replays_.at(e);
    for (const std::size_t m : replay.luxmeters()) {
      devices_.world().set_shown(m, std::nullopt);
      rules_.meter_lies(seconds(), m, false);
    }
    for (const std::size_t f : replay.fixtures()) wires_.desk[f].reset();
    replays_.erase(e);
    tell_of_desk();
  }

  void set_faults(const Event& event, bool on) {
    if (!on) log("well again: " + text_of(event));
    for (const std::string& device : event.on) {
      devices_.faults().set(device, event.fault, on, event.value);
      if (makes_deaf(event.fault))
        for (const Fixture& fixture : rig_.fixtures) {
          const bool dead_bus = event.fault == sim::FaultKind::dead && fixture.name != device;  // which is noticed
          if ((fixture.name == device || rig_.buses[fixture.bus].name == device) && !dead_bus &&
              !std::holds_alternative<ModbusPatch>(fixture.patch))
            rules_.fixture_is_deaf(seconds(), on);
        }
      if (!makes_a_meter_lie(event.fault)) continue;
      for (std::size_t m = 0; m < rig_.luxmeters.size(); ++m)
        if (rig_.luxmeters[m].name == device) rules_.meter_lies(seconds(), m, on);
    }
  }

  [[nodiscard]] static std::string text_of(const Event& event) {
    std::string text(event.what == What::fault ? sim::name_of(event.fault) : name_of(event.what));
    for (const std::string& name : event.on) text += " " + name;
    if (event.value) text += fmt::format(" {:g}", *event.value);
    if (event.recording) text += " " + event.recording_file.string();
    if (event.for_s) text += fmt::format(" for {:g} s", *event.for_s);
    return text;
  }

  const PreparedRig& prepared_;
  const Scenario& scenario_;
  const Rig& rig_;
  ShowOptions options_;
  sim::InProcessRig devices_;
  Wires wires_;
  std::optional<StateFolder> state_;  ///< only if the daemon ends: saving takes time
  std::atomic<Time> time_{};
  std::unique_ptr<Daemon> daemon_;  ///< null while it is gone
  HttpHandlers handlers_;
  double back_s_ = 0, next_trace_s_ = 0;
  bool cut_ = false, desk_there_ = false;
  std::optional<std::size_t> ending_;  ///< event that ends the daemon, while that takes time
  double ends_s_ = 0;
  ShowStatus left_;  ///< by the daemon that has gone
  Instant instant_;
  Phase phase_ = Phase::idle;
  std::vector<std::optional<double>> happened_s_, held_s_;  ///< per event; held: of its condition
  std::set<std::size_t> ended_;
  std::map<std::size_t, Replay> replays_;  ///< by event, while it lasts
  Judge judge_;
  ShowRules rules_;
  Outcome outcome_;
};

}  // namespace

bool acts_without_wires(sim::FaultKind fault) {
  using sim::FaultKind;
  switch (fault) {
    case FaultKind::reset:
    case FaultKind::unmappable:
    case FaultKind::bus_off:
    case FaultKind::pressed:
    case FaultKind::duplicated:
    case FaultKind::reordered:
      return false;
    default:
      return true;
  }
}

Outcome run_stepped(const PreparedRig& rig, const Scenario& scenario, std::uint64_t seed, const ShowOptions& options) {
  Outcome none;
  none.seed = seed;
  for (const Event& event : scenario.events)
    if (event.what == Event::What::fault && !acts_without_wires(event.fault)) {
      none.error = fmt::format("line {}: fault {} is of the wire, and a stepped show has none: leave it out here",
                               event.in_file.line, sim::name_of(event.fault));
      return none;
    }
  sim::Deviations deviations = scenario.deviations;
  deviations.seed = seed;
  auto world = rig.worlds.world(deviations);
  if (!world) {
    none.error = world.error().detail;
    return none;
  }
  return SteppedShow(rig, scenario, std::move(*world), seed, options).run();
}

}  // namespace luxrig::scenario
