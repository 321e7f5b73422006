// Lamps on every bus that carries levels: their true light during a fault.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <deque>
#include <mutex>
#include <random>
#include <thread>

#include "tools/bench/buses/far_side.h"
#include "tools/bench/faults/fault_cases.h"
#include "tools/bench/row_progress.h"

namespace luxrig {
namespace {

using sim::FaultKind;
using std::chrono::milliseconds;

constexpr const char* kBusName = "the-bus";
constexpr int kLamps = 3;
constexpr std::size_t kWaitingAtOnce = 6;
constexpr double kRight = 0.002;  // of full level: registers and slots have 10 to 16 bits
constexpr double kOff = 0.01;     // counts as off from here on
constexpr double kRecoverWithin_s = 5, kGiveUp_s = 20;
constexpr Duration kTruthTick = milliseconds(10);
constexpr Duration kWellFor = milliseconds(600);  // longer than any delay

struct LevelBus {
  const char* driver;
  bool waits;  ///< its driver waits for answers in real time
  std::vector<std::pair<const char*, OptionValue>> options;
  std::vector<FaultPlan> plans;
};

/// Possible faults of the network, the line and the cable. Values: shares, milliseconds, exception codes.
std::vector<LevelBus> level_buses() {
  const std::string bus = kBusName;
  const auto plan = [&](FaultKind kind, double least = 1, double most = 1, const char* note = "") {
    FaultPlan made{kind, bus, least, most};
    made.note = note;
    return made;
  };
  const std::vector<FaultPlan> network = {
      plan(FaultKind::lost, 0.1, 0.9),
      plan(FaultKind::slow, 20, 500),
      plan(FaultKind::duplicated, 0.2, 1),
      plan(FaultKind::reordered, 0.2, 1),
      plan(FaultKind::garbled, 1, 1, "headers spoiled: UDP has a checksum of its own"),
      plan(FaultKind::silent, 1, 1, "cable pulled: all is lost"),
      plan(FaultKind::dead, 1, 1, "the receiver's port is closed"),
  };
  const std::vector<FaultPlan> units = {
      plan(FaultKind::lost, 0.1, 0.9),
      plan(FaultKind::slow, 5, 200),
      plan(FaultKind::duplicated, 0.2, 1, "answers come twice"),
      plan(FaultKind::garbled),
      plan(FaultKind::exception, 1, 11),
      plan(FaultKind::silent),
      plan(FaultKind::dead, 1, 1, "unplugged"),
      plan(FaultKind::unpowered, 1, 1, "its own darkness and its value at power-on do not count as unasked"),
  };
  std::vector<FaultPlan> line = units;
  line.insert(line.begin() + 3,
              {plan(FaultKind::checksum), plan(FaultKind::truncated, 1, 4), plan(FaultKind::gap, 10, 600),
               plan(FaultKind::noise, 1, 8), plan(FaultKind::wrong_unit), plan(FaultKind::wrong_function)});
  const std::vector<FaultPlan> cable = {
      plan(FaultKind::dead, 1, 1, "unplugged"),
      plan(FaultKind::silent, 1, 1, "transfers hang"),
      plan(FaultKind::exception, 1, 1, "transfers are stalled"),
      plan(FaultKind::garbled),
  };
  std::vector<FaultPlan> slow_cable = cable;
  slow_cable.push_back(plan(FaultKind::lost, 0.05, 0.5, "some transfers hang"));
  slow_cable.push_back(plan(FaultKind::slow, 50, 400));
  const std::pair<const char*, OptionValue> quick_units{"response_timeout_ms", std::int64_t{20}};
  return {
      {"sacn", false, {{"destination", std::string("127.0.0.1")}}, network},
      {"artnet", false, {{"destination", std::string("127.0.0.1")}}, network},
      {"enttec_pro", true, {}, cable},
      {"open_dmx", true, {}, cable},
      {"udmx", true, {}, slow_cable},
      {"modbus_tcp", true, {{"host", std::string("127.0.0.1")}, quick_units}, units},
      {"modbus_rtu",
       true,
       {{"device", std::string("/dev/luxrig-bench")}, {"baud", std::int64_t{115200}}, quick_units},
       line},
  };
}

Rig lamps_on(const LevelBus& on) {
  Rig rig;
  rig.file = rig.name = "bench";
  Bus bus;
  bus.name = kBusName;
  bus.driver = on.driver;
  for (const auto& [key, value] : on.options) bus.options[key] = {value, {}};
  rig.buses.push_back(bus);
  const bool modbus = bus.driver.starts_with("modbus");
  for (int i = 0; i < kLamps; ++i) {
    Fixture lamp;
    lamp.name = fmt::format("lamp-{}", i + 1);
    if (modbus) {
      lamp.patch = ModbusPatch{10 + i / 2, i % 2, 1000, 0, {}, nullptr};  // two on one unit, one on another
    } else {
      lamp.patch = DmxPatch{1, 1 + 2 * i, {{SlotUse::dimmer, 0}, {SlotUse::dimmer_fine, 0}}};
    }
    rig.fixtures.push_back(lamp);
  }
  for (int unit = 1; modbus && unit <= 2; ++unit) {
    Luxmeter meter;
    meter.name = fmt::format("meter-{}", unit);
    meter.patch.unit = unit;
    meter.patch.first_register = 2;
    meter.range_lx = 100000;
    rig.luxmeters.push_back(meter);
  }
  return rig;
}

/// Endless fades, a different one for each lamp. Call at() with rising times.
class Fades {
 public:
  explicit Fades(std::uint64_t seed) : random_(seed) {}
  double at(std::size_t lamp, Time now) {
    Fade& fade = fades_[lamp];
    while (now >= fade.end) {
      fade.from = fade.to;
      fade.start = fade.end;
      fade.to = std::uniform_real_distribution<double>(0, 1)(random_);
      fade.end = fade.start + from_seconds(std::uniform_real_distribution<double>(0.4, 3)(random_));
    }
    return fade.from + (fade.to - fade.from) * to_seconds(now - fade.start) / to_seconds(fade.end - fade.start);
  }

 private:
  struct Fade {
    double from = 0, to = 0;
    Time start{}, end{};
  };
  std::mt19937_64 random_;
  std::array<Fade, kLamps> fades_{};
};

class LevelCases {
 public:
  LevelCases(const LevelBus& on, const FaultPlan& plan, std::uint64_t seed)
      : rig_(lamps_on(on)), plan_(plan), random_(seed), fades_(seed + 1) {
    auto far = FarSide::open(rig_, on.waits, seed + 2);
    if (!far) return;
    far_ = std::move(*far);
    driver_ = find_driver(on.driver)->make(rig_, 0, far_->redirect());
    const DriverBounds bounds = driver_->bounds();
    period_ = bounds.write_period;
    // A level travels for one cycle, and is in force for another until the next is asked.
    usual_lag_ = 2 * period_ + milliseconds(50);
    (void)driver_->activate(now_);
  }
  [[nodiscard]] bool ok() const { return driver_ != nullptr; }

  FaultOutcome run() {
    const auto between = [&](double least, double most) {
      return std::uniform_real_distribution<double>(least, most)(random_);
    };
    outcome_ = {};
    began_.reset();
    wait_until_well(kGiveUp_s);
    for (const Time phase = now_ + from_seconds(between(0, 1)); now_ < phase;) cycle();
    outcome_ = {};
    for (Lamp& lamp : lamps_) lamp.dark_allowed = plan_.kind == FaultKind::unpowered;
    began_ = now_;
    const double value = plan_.kind == FaultKind::exception
                             ? static_cast<double>(std::uniform_int_distribution<int>(
                                   static_cast<int>(plan_.value_least), static_cast<int>(plan_.value_most))(random_))
                             : between(plan_.value_least, plan_.value_most);
    far_->faults().set(plan_.device, plan_.kind, true, value);
    fault_on_ = true;
    for (const Time over = now_ + from_seconds(between(plan_.shortest_s, plan_.longest_s)); now_ < over;) cycle();
    far_->faults().clear();
    fault_on_ = false;
    for (Lamp& lamp : lamps_) lamp.right_since.reset();
    const Time ended = now_;
    cycle();
    if (wait_until_well(kGiveUp_s)) outcome_.recovered_s = std::max(0.0, to_seconds(*well_since_ - ended));
    return outcome_;
  }

 private:
  struct Lamp {
    std::deque<std::pair<Time, double>> asked;  ///< newest last, kept for the usual lag
    double least = 0, most = 0;                 ///< asked since it was last right for a while, or since the fault began
    std::optional<Time> right_since;
    bool dark_allowed = false;
  };

  bool wait_until_well(double max_s) {
    const Time until = now_ + from_seconds(max_s);
    while (now_ < until && !(well_since_ && now_ - *well_since_ >= kWellFor)) cycle();
    return well_since_ && now_ - *well_since_ >= kWellFor;
  }

  void cycle() {
    const Time next = now_ + period_;
    while (tick_ + kTruthTick <= next) {
      tick_ = std::max(tick_ + kTruthTick, far_->step_to(tick_ + kTruthTick));
      look(tick_);
    }
    now_ = std::max(next, far_->step_to(next));
    std::vector<LevelCommand> commands;
    for (std::size_t i = 0; i < kLamps; ++i) commands.push_back({i, ask(i, now_)});
    (void)driver_->level_output()->write(now_, commands);
    if (driver_->lux_reader() != nullptr) (void)driver_->lux_reader()->read(now_);
    now_ = std::max(now_, far_->step_to(now_));
    tick_ = std::max(tick_, now_);
    look(now_);
    const std::vector<Health> all = driver_->health(now_);
    const bool active = std::all_of(all.begin(), all.end(), [](const Health& h) { return h.life == Life::active; });
    if (!active && began_ && !outcome_.reported_s) outcome_.reported_s = to_seconds(now_ - *began_);
    if (!active || !right_) {
      well_since_.reset();
    } else if (!well_since_) {
      well_since_ = now_;
    }
  }

  double ask(std::size_t i, Time at) {
    const double level = fades_.at(i, at);
    Lamp& lamp = lamps_[i];
    lamp.asked.emplace_back(at, level);
    while (lamp.asked.front().first + usual_lag_ < at) lamp.asked.pop_front();
    lamp.least = std::min(lamp.least, level);
    lamp.most = std::max(lamp.most, level);
    return level;
  }

  /// Compares the truth with the asked levels.
  void look(Time at) {
    const std::vector<double> levels = far_->levels();
    right_ = true;
    bool off = false;
    for (std::size_t i = 0; i < kLamps; ++i) {
      ask(i, at);
      Lamp& lamp = lamps_[i];
      const auto [low, high] = std::minmax_element(lamp.asked.begin(), lamp.asked.end(),
                                                   [](const auto& a, const auto& b) { return a.second < b.second; });
      const double level = levels[i];
      const double departure = std::max({low->second - level, level - high->second, 0.0});
      outcome_.departure = std::max(outcome_.departure, departure);
      outcome_.excess = std::max(outcome_.excess, level - lamp.most);
      off = off || departure > kOff;
      const bool dark_by_itself = lamp.dark_allowed && level <= 0;
      if (began_ && outcome_.astray.empty() && !dark_by_itself &&
          (level > lamp.most + kRight || level < lamp.least - kRight)) {
        outcome_.astray =
            fmt::format("{} at {:.3f}: asked {:.3f} to {:.3f} since it was right; {:.2f} s after the beginning",
                        rig_.fixtures[i].name, level, lamp.least, lamp.most, to_seconds(at - *began_));
      }
      if (departure > kRight) {
        right_ = false;
        lamp.right_since.reset();
        continue;
      }
      // A late level may be right by chance for a moment. So during a fault all levels asked since its beginning count.
      if (!lamp.right_since) lamp.right_since = at;
      if (fault_on_ || at - *lamp.right_since < kWellFor) continue;
      lamp.least = low->second;
      lamp.most = high->second;
    }
    if (off) outcome_.departed_s += to_seconds(at - looked_);
    looked_ = at;
  }

  Rig rig_;
  FaultPlan plan_;
  std::mt19937_64 random_;
  Fades fades_;
  std::unique_ptr<FarSide> far_;
  std::unique_ptr<Driver> driver_;
  Duration period_{}, usual_lag_{};
  Time now_ = Time{} + std::chrono::seconds(1), tick_ = now_, looked_ = now_;
  std::optional<Time> began_, well_since_;
  bool right_ = false, fault_on_ = false;
  std::array<Lamp, kLamps> lamps_{};
  FaultOutcome outcome_;
};

}  // namespace

namespace {

struct LevelJob {
  const LevelBus* bus;
  const FaultPlan* plan;
  std::uint64_t seed;
  BenchRow row;
};

void run_level_cases(const BenchOptions& options, LevelJob& job) {
  LevelCases cases(*job.bus, *job.plan, job.seed);
  std::vector<FaultOutcome> outcomes;
  for (int i = 0; i < fault_count(options) && cases.ok(); ++i) outcomes.push_back(cases.run());
  job.row = row_of_faults(job.bus->driver, *job.plan, "level", outcomes, kRecoverWithin_s);
}

}  // namespace

void add_level_faults(const BenchOptions& options, std::vector<BenchRow>& rows) {
  const std::vector<LevelBus> buses = level_buses();
  std::vector<LevelJob> jobs;
  std::uint64_t seed = 1000;
  for (const LevelBus& bus : buses) {
    for (const FaultPlan& plan : bus.plans) {
      ++seed;
      if (fault_wanted(options, bus.driver, plan)) jobs.push_back({&bus, &plan, seed, {}});
    }
  }
  // Cases that wait for answers in real time use little processor time: run several at once.
  std::atomic<std::size_t> next{0};
  std::mutex saying;
  const auto work = [&](bool waits) {
    for (std::size_t j = 0; (j = next++) < jobs.size();) {
      if (jobs[j].bus->waits != waits) continue;
      run_level_cases(options, jobs[j]);
      const std::lock_guard lock(saying);
      say_row_made(jobs[j].row);
    }
  };
  work(false);
  next = 0;
  {
    std::vector<std::jthread> threads;
    for (std::size_t t = 0; t < std::min(kWaitingAtOnce, jobs.size()); ++t) threads.emplace_back([&] { work(true); });
  }
  for (LevelJob& job : jobs) rows.push_back(std::move(job.row));
}

}  // namespace luxrig
