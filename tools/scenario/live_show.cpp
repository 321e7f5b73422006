#include "tools/scenario/live_show.h"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/output/dimming.h"
#include "core/output/output_program.h"
#include "tools/luxrigd/state/journal.h"
#include "tools/luxrigd/state/light_store.h"
#include "tools/process/clock.h"
#include "tools/process/temporary_folder.h"
#include "tools/scenario/daemon_process.h"
#include "tools/scenario/desk_sender.h"
#include "tools/scenario/served_rig.h"
#include "tools/scenario/stepped_bus.h"

namespace luxrig::scenario {
namespace {

using What = Event::What;
using nlohmann::json;

/// The status is 0.1 s old when it is asked for, and a busy computer takes a moment more. Frames go 44 times a second,
/// and a thread that is held up sends late. A bus that is silent for 2 s is lost by any receiver's measure. Levels on
/// DMX go in steps of 1/255 of the drive, which a dimmer's curve may double.
constexpr Slack kLiveSlack = {.time_s = 1, .frames_s = 0.25, .silence_s = 1.75, .window_s = 0.25, .level = 1.0 / 255};
/// Longer than this, and the show is not what a rig in real time would have seen.
constexpr Duration kStandsStill = std::chrono::seconds(1);
/// The daemon's first start, with everything worked out; and the longest without any status later.
constexpr double kStarts_s = 120, kNoStatus_s = 10;
/// Beyond its fade: parking, and goodbyes.
constexpr double kEnds_s = 90;
constexpr auto kGuardianEnds = std::chrono::seconds(2);
constexpr auto kGuardianLook = std::chrono::milliseconds(10);
/// Without a newer status, nothing is known of what a bus sends.
constexpr Duration kOldStatus = std::chrono::milliseconds(300);

class LiveVenue final : public Venue {
 public:
  LiveVenue(const PreparedRig& prepared, std::uint64_t seed, std::stop_token stop)
      : prepared_(prepared), rig_(prepared.session->rig), seed_(seed), stop_(std::move(stop)) {}
  LiveVenue(const LiveVenue&) = delete;
  LiveVenue& operator=(const LiveVenue&) = delete;
  ~LiveVenue() override {
    daemon_.reset();
    end_guardian();
  }

  /// Call it first.
  Result<void> open(std::unique_ptr<sim::World> world) {
    if (folder_.path().empty()) return refusal("no folder for the daemon's state");
    auto served = ServedRig::open(rig_, std::move(world), seed_);
    if (!served) return tl::unexpected(served.error());
    served_ = std::move(*served);
    auto desk = DeskSender::open(rig_, served_->ports());
    if (!desk) return tl::unexpected(desk.error());
    desk_.emplace(std::move(*desk));
    if (auto written = served_->write_ports(ports_file(), desk_->daemon_ports()); !written) return written;
    std::error_code error;
    std::filesystem::create_directories(state(), error);
    const auto daemon = std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / "luxrigd";
    keep_light(state(), prepared_.light, light_key(rig_, prepared_.session->scene, prepared_.compute, daemon));
    return Journal(state()).save_first([this](JournalState& left) {
      left.plan_json = to_json(prepared_.plan);
      left.plan_of_rig = true;
    });
  }

  [[nodiscard]] Slack slack() const override { return kLiveSlack; }
  [[nodiscard]] double seconds() const override { return begun_ ? to_seconds(at_ - *begun_) : 0; }

  Result<void> start(bool first) override {
    seen_.reset();
    stopping_ = false;
    auto daemon = DaemonProcess::start(rig_, ports_file(), {state(), folder_.path() / "run", folder_.path() / "log"});
    if (!daemon) return tl::unexpected(daemon.error());
    daemon_ = std::move(*daemon);
    started_ = at_ = now();
    if (!first) return {};
    while (!has_plan()) {
      if (auto goes = step(); !goes) return goes;
    }
    begun_ = next_ = at_;
    (void)served_->longest_gap();
    return {};
  }
  [[nodiscard]] bool runs() const override { return daemon_ && seen_; }
  [[nodiscard]] const ShowStatus& status() const override { return status_; }
  [[nodiscard]] bool guarded() const override { return guarded_; }

  void command(const Event& event, const std::string& plan_json,
               std::function<void(const Result<void>&)> answered) override {
    const auto named = [&](const char* key) { return json{{key, event.on}}; };
    const auto post = [&](const char* route, const json& body) {
      daemon_->post(route, body.dump(-1, ' ', false, json::error_handler_t::replace), std::move(answered));
    };
    const auto by_hand = [&](const char* route, const char* names, const char* value) {
      json body = {{names, event.on}, {value, *event.value}};
      if (event.for_s) body["for_s"] = *event.for_s;
      post(route, body);
    };
    switch (event.what) {
      case What::apply:
        return daemon_->post("/api/apply", plan_json, std::move(answered));
      case What::blackout:
      case What::lift_blackout:
        return post("/api/blackout", {{"on", event.what == What::blackout}});
      case What::level:
        return by_hand("/api/level", "fixtures", "level");
      case What::goal:
        return by_hand("/api/goal", "points", "goal_lux");
      case What::release:
        return post("/api/release", event.on.empty() ? json{{"all", true}} : named("names"));
      case What::park:
        return post("/api/park", event.on.empty() ? json::object() : named("fixtures"));
      case What::bypass:
      case What::end_bypass: {
        json body = named("names");
        body["on"] = event.what == What::bypass;
        return post("/api/bypass", body);
      }
      default:
        return answered({});
    }
  }

  void stop() override {
    stopping_ = true;
    ends_by_ = at_ + from_seconds(rig_.safe.fade_s + kEnds_s);
    daemon_->terminate();
  }
  [[nodiscard]] std::optional<Ended> ended() override {
    if (!code_) return std::nullopt;
    const bool safe = daemon_->log_tail().ends_with("ended in the safe look");
    if (safe) status_.phase = Phase::safe;  // the last status is a moment older
    return Ended{*code_, safe};
  }
  void kill(bool with_guardian) override {
    if (with_guardian) end_guardian();
    daemon_->end();
    daemon_.reset();
    if (with_guardian) end_guardian();  // the daemon may just have started another
    code_.reset();
    seen_.reset();
    guarded_ = guardian_of(state()).has_value();
  }
  Result<void> kill_guardian() override {
    if (!guardian_of(state())) return refusal("no guardian runs, so none can be killed");
    end_guardian();
    guarded_ = false;
    return {};
  }

  void desk(std::size_t fixture, const std::optional<DeskCommand>& command) override { desk_->set(fixture, command); }
  [[nodiscard]] sim::Faults& faults() override { return served_->faults(); }
  Result<void> step_wall_clock(double) override {
    return refusal("the wall clock of this computer is not stepped for a show: run it without --real-time");
  }
  void in_room(const std::function<void(sim::World&)>& change) override { served_->with_world(change); }

  Result<void> advance() override {
    const Time due = next_ + kTick;
    sleep_until(due);
    next_ = std::max(due, now() - kTick);
    const Duration gap = std::max(now() - due, served_->longest_gap());
    if (gap > kStandsStill)
      return refusal(fmt::format("this computer stood still for {:.1f} s at {:.1f} s: run it again with less load",
                                 to_seconds(gap), seconds()));
    return step();
  }

  void see(Instant& instant, std::vector<bool>& sent) override {
    std::vector<double> drives;
    std::vector<double> readings(rig_.luxmeters.size());
    const double passed_s = std::max(0.0, to_seconds(at_ - looked_.value_or(at_)));
    looked_ = at_;
    served_->with_world([&](sim::World& world) {
      const std::vector<sim::PointTruth> points = world.points();
      instant.lux.resize(points.size());
      for (std::size_t p = 0; p < points.size(); ++p) {
        instant.lux[p] = points[p].lux;
        instant.lux_hours[p] += points[p].lux * passed_s / 3600;
      }
      drives = world.drives();
      instant.joints = world.joints();
      for (std::size_t m = 0; m < readings.size(); ++m) readings[m] = world.meter_reading_lx(m);
    });
    for (std::size_t m = 0; m < readings.size(); ++m) {
      const Luxmeter& meter = rig_.luxmeters[m];
      if (!mute(meter.name) && !mute(rig_.buses[meter.bus].name))
        instant.reading_lx[m] = faults().shown_lx(meter.name, readings[m]);
    }
    // As it arrives. What a lamp that is out is sent, only the daemon knows.
    for (std::size_t f = 0; f < rig_.fixtures.size(); ++f) {
      const std::string& name = rig_.fixtures[f].name;
      const bool out =
          faults().find(name, sim::FaultKind::lamp_failure) || faults().find(name, sim::FaultKind::unpowered);
      instant.level[f] = out && f < status_.fixtures.size()
                             ? status_.fixtures[f].level
                             : level_at(rig_.fixtures[f], drives[f]);
    }
    for (std::size_t b = 0; b < sent.size(); ++b) sent[b] = sent_now_[b];
    std::fill(sent_now_.begin(), sent_now_.end(), false);
  }

 private:
  [[nodiscard]] std::filesystem::path state() const { return folder_.path() / "state"; }
  [[nodiscard]] std::filesystem::path ports_file() const { return folder_.path() / "ports.json"; }
  [[nodiscard]] bool mute(const std::string& device) {
    using sim::FaultKind;
    for (const FaultKind kind : {FaultKind::silent, FaultKind::dead, FaultKind::unpowered})
      if (faults().find(device, kind)) return true;
    return false;
  }
  /// The plan that it found is in force, or waits for a desk.
  [[nodiscard]] bool has_plan() const { return seen_ && (status_.phase != Phase::idle || status_.plan_waits); }

  /// Takes what has come since the last tick. Before the show begins it also waits a little.
  Result<void> step() {
    if (stop_.stop_requested()) return refusal("stopped");
    if (!begun_) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    at_ = now();
    desk_->send(at_);
    if (!daemon_) return {};
    daemon_->take_answers();
    take_status();
    if (!code_) code_ = daemon_->ended();
    if (code_ && !stopping_)
      return refusal(fmt::format("the daemon ended by itself, with exit code {}, at {:.1f} s: {}", *code_, seconds(),
                                 daemon_->log_tail()));
    if (code_) return {};
    if (stopping_ && at_ > ends_by_)
      return refusal(fmt::format("the daemon was asked to end, and has not by {:.1f} s", seconds()));
    const double silent_s = to_seconds(at_ - (seen_ ? seen_->at : started_));
    if (silent_s > (seen_ && begun_ ? kNoStatus_s : kStarts_s))
      return refusal(fmt::format("the daemon has given no status for {:.0f} s, at {:.1f} s: {}", silent_s, seconds(),
                                 daemon_->complaint().empty() ? daemon_->log_tail() : daemon_->complaint()));
    return {};
  }

  void take_status() {
    auto seen = daemon_->seen();
    if (!seen || seen == seen_) {
      if (seen_ && at_ - seen_->at > kOldStatus) std::fill(sent_now_.begin(), sent_now_.end(), true);
      return;
    }
    for (std::size_t b = 0; b < sent_now_.size(); ++b)
      if (!seen_ || seen->status.sent[b] != seen_->status.sent[b] || !seen->status.sends[b]) sent_now_[b] = true;
    seen_ = std::move(seen);
    status_ = seen_->status.show;
  }

  /// Ends it, if there is one, and waits until it is gone.
  void end_guardian() {
    const auto by = std::chrono::steady_clock::now() + kGuardianEnds;
    for (auto guardian = guardian_of(state()); guardian && std::chrono::steady_clock::now() < by;
         guardian = guardian_of(state())) {
      ::kill(*guardian, SIGKILL);
      std::this_thread::sleep_for(kGuardianLook);
    }
  }

  const PreparedRig& prepared_;
  const Rig& rig_;
  std::uint64_t seed_;
  std::stop_token stop_;
  TemporaryFolder folder_;
  std::unique_ptr<ServedRig> served_;
  std::optional<DeskSender> desk_;
  std::unique_ptr<DaemonProcess> daemon_;  ///< null while it is gone
  std::shared_ptr<const DaemonProcess::Seen> seen_;
  ShowStatus status_;
  std::vector<bool> sent_now_ = std::vector<bool>(rig_.buses.size(), false);
  std::optional<int> code_;  ///< it has ended
  bool stopping_ = false, guarded_ = false;
  std::optional<Time> begun_, looked_;
  Time at_{}, next_{}, started_{}, ends_by_{};
};

}  // namespace

Outcome run_live(const PreparedRig& rig, const Scenario& scenario, std::uint64_t seed, const ShowOptions& options,
                 const std::stop_token& stop) {
  Outcome none;
  none.seed = seed;
  if (scenario.starts_dark) {
    none.error =
        "start = \"dark\": a daemon always starts with a plan: leave out --real-time, or begin with a blackout";
    return none;
  }
  auto world = rig.world_of(scenario, seed);
  if (!world) {
    none.error = world.error().detail;
    return none;
  }
  LiveVenue venue(rig, seed, stop);
  if (const auto opened = venue.open(std::move(*world)); !opened) {
    none.error = opened.error().detail;
    return none;
  }
  return run_show(venue, rig, scenario, seed, options);
}

}  // namespace luxrig::scenario
