#include "tools/scenario/stepped_show.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/output/dimming.h"
#include "tools/luxrigd/daemon.h"
#include "tools/process/clock.h"
#include "tools/process/temporary_folder.h"
#include "tools/scenario/stepped_bus.h"

namespace luxrig::scenario {
namespace {

using What = Event::What;

constexpr Time kBegin = Time{} + std::chrono::hours(1);  // a clock at 0 would look like "never"

bool ends_a_daemon(const Event& event) {
  return event.what == What::stop || event.what == What::kill || event.what == What::power_cut;
}

template <class Answer>
Result<void> told(const Answer& answer) {
  if (answer) return {};
  if constexpr (std::is_same_v<typename Answer::error_type, Fault>)
    return tl::unexpected(answer.error());
  else
    return refusal(answer.error().front().text());
}

class SteppedVenue final : public Venue {
 public:
  SteppedVenue(const PreparedRig& prepared, const Scenario& scenario, std::unique_ptr<sim::World> world,
               std::uint64_t seed)
      : prepared_(prepared),
        rig_(prepared.session->rig),
        starts_dark_(scenario.starts_dark),
        devices_(rig_, std::move(world), {.start = kBegin, .fault_seed = seed}) {
    wires_ = {std::vector<double>(rig_.fixtures.size(), 0.0), std::vector<std::optional<double>>(rig_.luxmeters.size()),
              std::vector<bool>(rig_.buses.size(), false),
              std::vector<std::optional<DeskCommand>>(rig_.fixtures.size())};
    if (std::any_of(scenario.events.begin(), scenario.events.end(), ends_a_daemon)) state_.emplace();
    time_ = kBegin;
    stepped_wall_ahead_s = 0;
    stepped_time = &time_;
  }
  SteppedVenue(const SteppedVenue&) = delete;
  SteppedVenue& operator=(const SteppedVenue&) = delete;
  ~SteppedVenue() override {
    daemon_.reset();
    stepped_time = nullptr;
  }

  [[nodiscard]] double seconds() const override { return to_seconds(time_.load() - kBegin); }

  Result<void> start(bool first) override {
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
      return refusal("the daemon does not start: " + started.error().detail);
    handlers_ = daemon_->handlers();
    bool resumed = false;
    if (state_ && !first) resumed = daemon_->resume(Journal(state_->path()).load()).plan;
    if (!resumed && !starts_dark_)
      if (const auto applied = daemon_->apply(prepared_.plan, true); !applied)
        return refusal("the solved plan is refused: " + applied.error().front().text());
    daemon_->tick();
    return {};
  }
  [[nodiscard]] bool runs() const override { return daemon_ != nullptr; }
  [[nodiscard]] const ShowStatus& status() const override { return daemon_ ? daemon_->status() : left_; }

  void command(const Event& event, const std::string& plan_json,
               std::function<void(const Result<void>&)> answered) override {
    answered(answer_to(event, plan_json));
  }

  void stop() override {
    daemon_->go_safe();
    ends_s_ = seconds() + rig_.safe.fade_s + 2;
  }
  [[nodiscard]] std::optional<Ended> ended() override {
    const bool safe = daemon_->status().phase == Phase::safe;
    if (safe || seconds() >= ends_s_) return Ended{safe ? 0 : 1, safe};
    return std::nullopt;
  }
  void kill(bool) override {
    left_ = daemon_->status();
    daemon_.reset();
    handlers_ = {};
  }
  Result<void> kill_guardian() override { return refusal("a stepped show has no guardian"); }

  void desk(std::size_t fixture, const std::optional<DeskCommand>& command) override { wires_.desk[fixture] = command; }
  [[nodiscard]] sim::Faults& faults() override { return devices_.faults(); }
  Result<void> step_wall_clock(double by_s) override {
    stepped_wall_ahead_s = stepped_wall_ahead_s + by_s;
    return {};
  }
  void in_room(const std::function<void(sim::World&)>& change) override { change(devices_.world()); }

  Result<void> advance() override {
    time_ = time_.load() + kTick;
    if (daemon_) daemon_->tick();
    return {};
  }

  void see(Instant& instant, std::vector<bool>& sent) override {
    devices_.advance(time_);
    const std::vector<sim::PointTruth> points = devices_.world().points();
    instant.lux.resize(points.size());
    for (std::size_t p = 0; p < points.size(); ++p) {
      instant.lux[p] = points[p].lux;
      instant.lux_hours[p] += points[p].lux * to_seconds(kTick) / 3600;
    }
    instant.reading_lx = wires_.reading_lx;
    for (std::size_t f = 0; f < rig_.fixtures.size(); ++f)
      instant.level[f] = level_at(rig_.fixtures[f], wires_.drive[f]);
    instant.joints = devices_.world().joints();
    sent.swap(wires_.sent);
    std::fill(wires_.sent.begin(), wires_.sent.end(), false);
  }

 private:
  Result<void> answer_to(const Event& event, const std::string& plan_json) {
    switch (event.what) {
      case What::apply:
        return told(handlers_.apply(plan_json, {}));
      case What::blackout:
      case What::lift_blackout:
        return told(handlers_.blackout(event.what == What::blackout));
      case What::level:
        return told(handlers_.level(event.on, *event.value, {event.for_s, {}}));
      case What::goal:
        return told(handlers_.goal(event.on, *event.value, {event.for_s, {}}));
      case What::release:
        return told(handlers_.release(event.on, {}));
      case What::park:
        return told(handlers_.park(event.on));
      case What::bypass:
      case What::end_bypass:
        return told(handlers_.bypass(event.on, event.what == What::bypass));
      default:
        return {};
    }
  }

  const PreparedRig& prepared_;
  const Rig& rig_;
  bool starts_dark_;
  sim::InProcessRig devices_;
  Wires wires_;
  std::optional<TemporaryFolder> state_;  ///< only if the daemon ends: saving takes time
  std::atomic<Time> time_{};
  std::unique_ptr<Daemon> daemon_;  ///< null while it is gone
  HttpHandlers handlers_;
  double ends_s_ = 0;
  ShowStatus left_;  ///< by the daemon that has gone
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
      none.error = fmt::format("line {}: fault {} is of the wire, and a stepped show has none: run it with --real-time",
                               event.in_file.line, sim::name_of(event.fault));
      return none;
    } else if (event.what == Event::What::kill_guardian) {
      none.error =
          fmt::format("line {}: a stepped show has no guardian to kill: run it with --real-time", event.in_file.line);
      return none;
    }
  auto world = rig.world_of(scenario, seed);
  if (!world) {
    none.error = world.error().detail;
    return none;
  }
  SteppedVenue venue(rig, scenario, std::move(*world), seed);
  return run_show(venue, rig, scenario, seed, options);
}

}  // namespace luxrig::scenario
