// Checks the promises on the daemon itself, under a clock that the test steps, in a simulated hall.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "core/output/dimming.h"
#include "sim/in_process_rig.h"
#include "tests/promises/promises.h"
#include "tests/scenarios/hall.h"
#include "tools/luxrigd/daemon.h"
#include "tools/process/clock.h"

namespace luxrig::promises {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(20);
constexpr std::size_t kPlans = 3;
constexpr std::size_t kOverWorks[] = {0, 3, 5, 10};  ///< lamps whose light decides on the limits
constexpr std::size_t kFrozen = 2;                   ///< index of the fault
constexpr double kLargestStep = 0.0376;  ///< as in tests/scenarios/closed_loop.h

/// One bus of the simulated hall.
class HallBus final : public Driver, public LevelOutput, public LuxReader {
 public:
  HallBus(sim::InProcessRig& devices, std::vector<double>& sent, bool first, bool reads)
      : devices_(devices), sent_(sent), first_(first), reads_(reads) {}
  [[nodiscard]] DriverBounds bounds() const override {
    DriverBounds bounds;
    bounds.write_period = bounds.read_period = kTick;
    return bounds;
  }
  Result<void> activate(Time) override { return {}; }
  void deactivate(Time) override {}
  /// The first bus reports for all buses at once.
  [[nodiscard]] std::vector<Health> health(Time now) const override {
    return first_ ? devices_.health(now) : std::vector<Health>{};
  }
  LevelOutput* level_output() override { return reads_ ? nullptr : this; }
  LuxReader* lux_reader() override { return reads_ ? this : nullptr; }
  Result<void> write(Time now, std::span<const LevelCommand> commands) override {
    for (const LevelCommand& command : commands) sent_[command.fixture] = command.drive;
    return devices_.write(now, commands);
  }
  Result<std::vector<LuxReading>> read(Time now) override { return devices_.read(now); }

 private:
  sim::InProcessRig& devices_;
  std::vector<double>& sent_;
  bool first_, reads_;
};

class SteppedSubject final : public Subject {
 public:
  explicit SteppedSubject(std::uint64_t seed)
      : hall_(hall_of(seed)),
        devices_(hall_.rig, std::move(*sim::World::make(hall_.rig, deviations(seed), hall_.truth)), {Time{} + kBegin}),
        sent_(hall_.rig.fixtures.size(), 0.0),
        before_(sent_) {
    std::string name = (std::filesystem::exists("/dev/shm") ? "/dev/shm" : "/tmp") + std::string("/luxrig-promises-XXXXXX");
    folder_ = ::mkdtemp(name.data());
    time_ = Time{} + kBegin;
    stepped_time = &time_;
    for (std::size_t k = 0; k < kPlans; ++k) plans_.push_back(to_json(plan_of(k)));
    start();
  }
  ~SteppedSubject() override {
    daemon_.reset();
    stepped_time = nullptr;
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  bool blackout(bool on) override {
    jumps_ = true;
    return handlers_.blackout(on).has_value();
  }
  bool apply(std::size_t plan) override { return handlers_.apply(plans_[plan], {}).has_value(); }
  bool hold(std::size_t lamp, double level) override {
    return handlers_.level({lamp_name(kOverWorks[lamp])}, level, {}).has_value();
  }
  bool release() override { return handlers_.release({}, {}).has_value(); }
  bool nonsense(std::size_t kind) override {
    switch (kind) {
      case 0:
        return handlers_.apply("{\"tasks\": [[[", {}).has_value();
      case 1:
        return handlers_.apply(plans_[0].substr(0, plans_[0].size() / 2), {}).has_value();
      case 2:
        return handlers_.level({"nobody"}, 0.5, {}).has_value();
      default:
        return handlers_.level({lamp_name(0)}, 1.5, {}).has_value();
    }
  }
  void fault(std::size_t which, bool on) override {
    using sim::FaultKind;
    struct One {
      const char* device;
      FaultKind kind;
      std::optional<double> value;
    };
    const One faults[] = {{"meter-1", FaultKind::silent, {}},
                          {"meter-2", FaultKind::lost, 0.5},
                          // A lower value than a weak lamp could explain: a plausible one would look like a weak lamp.
                          {"meter-3", FaultKind::stuck, {}},
                          {"meter-4", FaultKind::lying, 0.3},
                          {"spot-9", FaultKind::silent, {}},
                          {"meters", FaultKind::dead, {}}};
    devices_.faults().set(faults[which].device, faults[which].kind, on, faults[which].value);
  }
  void disk(bool fails) override {
    std::error_code ignored;
    const auto in_the_way = folder_ / "state.json.new";
    if (fails) {
      std::filesystem::create_directory(in_the_way, ignored);
    } else {
      std::filesystem::remove(in_the_way, ignored);
    }
  }
  void restart(bool in_order) override {
    jumps_ = true;
    if (in_order) {
      daemon_->go_safe();
      step(0.5);
    }
    daemon_.reset();
    move_time(0.3);
    start();
  }
  void stall(double seconds) override { move_time(seconds); }
  void wait(double seconds) override { step(seconds); }

  Seen seen() override {
    const ShowStatus& status = daemon_->status();
    Seen seen;
    seen.blackout = status.blackout;
    seen.plan_waits = status.plan_waits;
    for (std::size_t k = 0; k < kPlans; ++k) {
      const auto goal = status.points[kTellingPoint].goal_lx;
      if (goal && std::abs(*goal - goal_of(k)) < 1e-6) seen.plan = k;
    }
    for (const ByHand& held : status.by_hand)
      if (!held.of_plan)
        seen.by_hand[std::find(std::begin(kOverWorks), std::end(kOverWorks), held.index) - std::begin(kOverWorks)] =
            held.value;
    return seen;
  }
  std::string broken() override { return std::exchange(broken_, {}); }
  void expect_dark(bool dark) override {
    if (dark != dark_) jumps_ = true;
    dark_ = dark;
  }

 private:
  static constexpr Duration kBegin = std::chrono::hours(1);
  static constexpr std::size_t kTellingPoint = 20;  ///< unmeasured, and without a limit

  static scenarios::Hall hall_of(std::uint64_t seed) {
    scenarios::Hall hall = scenarios::make_hall(seed % 5);
    hall.rig.luminaires.resize(1);  // the status names the luminaire of each fixture
    return hall;
  }
  static sim::Deviations deviations(std::uint64_t seed) {
    sim::Deviations deviations;
    deviations.seed = seed;
    return deviations;
  }
  [[nodiscard]] double goal_of(std::size_t plan) const { return 100 + 10 * static_cast<double>(plan); }
  [[nodiscard]] const std::string& lamp_name(std::size_t lamp) const { return hall_.rig.fixtures[lamp].name; }

  [[nodiscard]] Plan plan_of(std::size_t k) const {
    Plan plan;
    plan.rig = hall_.rig.name;
    PlannedTask task;
    task.name = "levels";
    task.kind = "emittance";
    for (std::size_t f = 0; f < hall_.rig.fixtures.size(); ++f) {
      PlannedLight light;
      light.name = hall_.rig.fixtures[f].name;
      light.level = hall_.plan[f] * (1 - 0.1 * static_cast<double>(k));
      task.lights.push_back(light);
    }
    plan.tasks.push_back(task);
    PlannedPoint point;
    point.name = hall_.rig.points[kTellingPoint].name;
    point.goal_lux = goal_of(k);
    plan.points.push_back(point);
    // More than the works' limits allow: the limits always decide.
    for (std::size_t p = 0; p < scenarios::kWorks; ++p) {
      PlannedPoint work;
      work.name = hall_.rig.points[p].name;
      work.goal_lux = 1.2 * *hall_.rig.points[p].max_lx;
      plan.points.push_back(work);
    }
    return plan;
  }

  void start() {
    DaemonOptions options;
    options.state_folder = folder_;
    options.stepped_driver = [this](const Rig&, std::size_t bus) -> std::unique_ptr<Driver> {
      return std::make_unique<HallBus>(devices_, sent_, bus == 0, bus == 2);
    };
    options.light_model = [this](const Session&, const std::vector<Joints>&) { return hall_.model; };
    daemon_ = std::make_unique<Daemon>(std::make_shared<Session>(Session{hall_.rig, Scene{}, nullptr}),
                                       KeptLight{{}, hall_.model}, std::move(options));
    const auto started = daemon_->start();
    if (!started) broken_ = "does not start: " + started.error().detail;
    handlers_ = daemon_->handlers();
    (void)daemon_->resume(Journal(folder_).load());
    step(0.2);
  }
  void move_time(double seconds) {
    time_ = time_.load() + from_seconds(seconds);
    devices_.advance(time_);
    jumped_ = true;
  }
  void step(double seconds) {
    const Time end = time_.load() + from_seconds(seconds);
    while (time_.load() < end) {
      time_ = time_.load() + kTick;
      daemon_->tick();
      look();
    }
  }
  /// Checks the frame that has just gone out.
  void look() {
    const auto say = [&](std::string what) {
      if (broken_.empty()) broken_ = std::move(what);
    };
    for (std::size_t f = 0; f < sent_.size(); ++f) {
      if (!(sent_[f] >= 0 && sent_[f] <= 1)) say(fmt::format("{} was sent {}", lamp_name(f), sent_[f]));
      if (dark_ && sent_[f] > 0 && dark_for_ > 0) say(fmt::format("{} is lit in a blackout", lamp_name(f)));
      const double level = level_of(f, sent_[f]), was = level_of(f, before_[f]);
      if (!jumps_ && level > was + 2 * kLargestStep)
        say(fmt::format("{} jumped from {:.3f} to {:.3f}", lamp_name(f), was, level));
    }
    dark_for_ = dark_ ? dark_for_ + 1 : 0;
    jumps_ = jumped_ = false;
    before_ = sent_;
    const std::vector<sim::PointTruth> points = devices_.world().points();
    for (std::size_t p = 0; p < points.size(); ++p)
      if (hall_.rig.points[p].max_lx && points[p].max_lux_seen > *hall_.rig.points[p].max_lx * 1.001)
        say(fmt::format("{} had {:.2f} lx of {:g}", hall_.rig.points[p].name, points[p].max_lux_seen,
                        *hall_.rig.points[p].max_lx));
  }
  [[nodiscard]] double level_of(std::size_t f, double drive) const {
    return level_from_drive(hall_.rig.fixtures[f].dimmer_curve, drive);
  }

  scenarios::Hall hall_;
  sim::InProcessRig devices_;
  std::vector<double> sent_, before_;  ///< drives
  std::filesystem::path folder_;
  std::atomic<Time> time_{};
  std::vector<std::string> plans_;
  std::unique_ptr<Daemon> daemon_;
  HttpHandlers handlers_;
  std::string broken_;
  bool dark_ = false, jumps_ = false, jumped_ = false;
  int dark_for_ = 0;
};

std::string outcome(std::uint64_t seed, const std::vector<Step>& steps) {
  SteppedSubject subject(seed);
  return Model().run(subject, steps);
}

// LUXRIG_PROMISES: number of sequences; tools/nightly runs 10,000.
TEST(Promises, HoldThroughRandomCommandsFaultsKillsAndDiskErrors) {
  const char* wanted = std::getenv("LUXRIG_PROMISES");
  const std::uint64_t sequences = wanted != nullptr ? std::strtoull(wanted, nullptr, 10) : 300;
  for (std::uint64_t seed = 1; seed <= sequences; ++seed) {
    const std::vector<Step> steps = random_steps(seed, {kPlans, 4, 6, 4, 4});
    if (outcome(seed, steps).empty()) continue;
    const auto shortest = shrunk(steps, [&](const auto& tried) { return !outcome(seed, tried).empty(); });
    ADD_FAILURE() << "sequence " << seed << ": " << outcome(seed, shortest) << "\n" << in_words(shortest);
    break;
  }
}

// A value frozen in mid-fade is too low, yet plausible enough to be believed.
TEST(Promises, HoldWhenAMeterFreezesDuringAFade) {
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    const double after_s = 0.1 * static_cast<double>(seed % 60);
    const std::vector<Step> steps = {{Act::apply, 0, 0},
                                     {Act::hold, 2, 0.75},
                                     {Act::wait, 0, after_s},
                                     {Act::fault, kFrozen, 0},
                                     {Act::wait, 0, 12}};
    EXPECT_EQ(outcome(seed, steps), "") << "seed " << seed << ", " << after_s << " s after the beginning";
  }
}

}  // namespace
}  // namespace luxrig::promises
