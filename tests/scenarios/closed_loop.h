#pragma once
/// The show against the simulated hall under a stepped clock: 10 ms ticks of truth, output and readings at every tick
/// where they are due, the show stepped at 50 Hz. Records everything that must never happen.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <deque>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "core/output/dimming.h"
#include "sim/in_process_rig.h"
#include "tests/scenarios/hall.h"

namespace luxrig::scenarios {

/// Larger than any level change of a fade between two outputs 20 ms apart. The fastest fade, an s-curve over 0.8 s, has
/// a largest step of 1.5 · 0.02 / 0.8.
inline constexpr double kLargestStep = 0.0376;

inline sim::Deviations seeded(std::uint64_t seed) {
  sim::Deviations deviations;
  deviations.seed = seed;
  return deviations;
}

inline double random_share(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

/// Random levels of twelve lamps, all bright or all dim.
inline std::vector<double> random_levels(std::mt19937_64& random) {
  std::vector<double> levels(12);
  const double most = random_share(random);
  for (double& level : levels) level = most * random_share(random);
  return levels;
}

class ClosedLoop {
 public:
  ClosedLoop(const Hall& hall_in, const sim::Deviations& deviations)
      : hall(hall_in),
        devices(hall.rig, std::move(*sim::World::make(hall.rig, deviations, hall.truth))),
        show(hall.rig, hall.model) {}

  Hall hall;
  sim::InProcessRig devices;
  ShowController show;
  Time now{};
  std::function<void(LuxReading&)> corrupt;  ///< a fault on the wire of the readings
  double largest_step = 0;                   ///< largest level change between two outputs, without blackouts
  std::string log;                           ///< all output of the controller, bit for bit, if wanted
  bool keep_log = false;

  [[nodiscard]] double seconds() const { return to_seconds(now - Time{}); }
  [[nodiscard]] ShowStatus status() const { return show.status(now); }
  [[nodiscard]] Phase phase() const { return status().phase; }
  void apply() { show.apply(now, hall.plan); }
  /// Corrections are solved beside the loop, and each takes this long.
  void solve_late(double takes_s) {
    show.solve_beside([this, takes_s](std::function<void()> solve) {
      being_solved_.emplace_back(now + from_seconds(takes_s), std::move(solve));
    });
  }
  void fault(const std::string& device, sim::FaultKind kind, bool on, std::optional<double> value = {}) {
    devices.faults().set(device, kind, on, value);
  }

  void run(double run_s) {
    run_until([] { return false; }, run_s);
  }

  /// Runs until so() is true, at most for this time; returns so().
  bool run_until(const std::function<bool()>& so, double at_most_s) {
    const Time end = now + from_seconds(at_most_s);
    while (now < end) {
      tick();
      if (so()) return true;
    }
    return so();
  }
  bool run_until(Phase phase_wanted, double at_most_s) {
    return run_until([&] { return show.status(now).phase == phase_wanted; }, at_most_s);
  }

  /// Largest true lux over limit at any tick so far; at most 1 if every limit was kept.
  [[nodiscard]] double worst_limit_share() const {
    double worst = 0;
    const std::vector<sim::PointTruth> points = devices_world().points();
    for (std::size_t p = 0; p < points.size(); ++p) {
      if (hall.rig.points[p].max_lx) worst = std::max(worst, points[p].max_lux_seen / *hall.rig.points[p].max_lx);
    }
    return worst;
  }

  /// Largest |shown − goal| / goal over the luxmeters (their mean over the last readings, as the show sees them).
  [[nodiscard]] double worst_measured_error() const {
    double worst = 0;
    const ShowStatus present = status();
    for (std::size_t m = 0; m < hall.rig.luxmeters.size(); ++m) {
      const std::size_t p = *hall.rig.luxmeters[m].point;
      const double measured_lx = present.points[p].measured_lx.value_or(0);
      worst = std::max(worst, std::abs(measured_lx / *hall.rig.points[p].goal_lx - 1));
    }
    return worst;
  }

  /// The same with true lux, at the last tick.
  [[nodiscard]] double worst_true_error() const {
    double worst = 0;
    const std::vector<sim::PointTruth> points = devices_world().points();
    for (const Luxmeter& luxmeter : hall.rig.luxmeters) {
      worst = std::max(worst, std::abs(points[*luxmeter.point].lux / *hall.rig.points[*luxmeter.point].goal_lx - 1));
    }
    return worst;
  }

  /// The present output.
  [[nodiscard]] std::vector<double> levels() const {
    std::vector<double> level(hall.rig.fixtures.size());
    show.program().levels_at(now, level);
    return level;
  }

  [[nodiscard]] std::string describe() const {
    const ShowStatus present = status();
    std::string text = fmt::format("at {:.2f} s: {} ({}), round {}\n", seconds(), name_of(present.phase),
                                   present.detail, present.round);
    for (const Alarm& alarm : present.alarms) text += "  alarm: " + alarm.text + "\n";
    const std::vector<sim::PointTruth> points = devices_world().points();
    for (std::size_t m = 0; m < hall.rig.luxmeters.size(); ++m) {
      const std::size_t p = *hall.rig.luxmeters[m].point;
      text += fmt::format(
          "  {}: goal {:.2f} measured {:.2f} true {:.2f} most {:.2f} predicted {:.2f} ± {:.2f} met {} {}; {}\n",
          hall.rig.points[p].name, *hall.rig.points[p].goal_lx, present.points[p].measured_lx.value_or(-1),
          points[p].lux, points[p].max_lux_seen, present.points[p].predicted_lx, present.points[p].standard_error_lx,
          present.points[p].met(), present.points[p].reason, present.points[p].why);
    }
    return text;
  }

 private:
  std::vector<double> before_;
  std::deque<std::pair<Time, std::function<void()>>> being_solved_;

  [[nodiscard]] sim::World& devices_world() const { return const_cast<sim::InProcessRig&>(devices).world(); }

  void tick() {
    now += sim::kTick;
    while (!being_solved_.empty() && being_solved_.front().first <= now) {
      being_solved_.front().second();
      being_solved_.pop_front();
    }
    const auto tick_number = (now - Time{}) / sim::kTick;
    if (tick_number % 2 != 0) {
      devices.advance(now);
      return;
    }
    if (auto readings = devices.read(now)) {
      for (LuxReading& reading : *readings) {
        if (corrupt) corrupt(reading);
        show.reading(now, reading);
      }
    }
    if (tick_number % 10 == 0) show.health(now, devices.health(now));
    show.step(now);
    output();
  }

  void output() {
    std::vector<double> level(hall.rig.fixtures.size());
    show.program().levels_at(now, level);
    std::vector<LevelCommand> commands;
    for (std::size_t i = 0; i < level.size(); ++i) {
      commands.push_back({i, drive_from_level(hall.rig.fixtures[i].dimmer_curve, level[i])});
      if (!before_.empty() && !show.program().blackout) {
        largest_step = std::max(largest_step, std::abs(level[i] - before_[i]));
      }
      if (keep_log) log += fmt::format("{:a} ", level[i]);
    }
    before_ = level;
    (void)devices.write(now, commands);  // a dead bus shows in health()
  }
};

}  // namespace luxrig::scenarios
