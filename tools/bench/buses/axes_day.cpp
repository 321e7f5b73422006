// 64 axes for a day, in simulated time: the driver's state, the buses and memory.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "drivers/can/canopen_driver.h"
#include "tools/bench/buses/axes_load.h"
#include "tools/bench/buses/axes_wire.h"
#include "tools/bench/buses/bus_load.h"
#include "tools/bench/row_progress.h"

namespace luxrig {
namespace {

constexpr double kSetUpWithin_s = 30, kGiveUpMove_s = 60;
constexpr double kShortestShow_s = 10, kLongestShow_s = 60;

/// Four buses of drives, and their drivers.
class DayOfHeads {
 public:
  DayOfHeads() : rig_(rig_of_heads()), aim_(rig_.fixtures.size()) {
    auto world = sim::World::make(rig_, sim::Deviations::none(),
                                  Eigen::MatrixXd::Zero(0, static_cast<Eigen::Index>(rig_.fixtures.size())));
    if (!world) return;
    world_ = std::move(*world);
    for (std::size_t b = 0; b < kCanBuses; ++b) {
      Line& line = lines_[b];
      line.axes = std::make_unique<sim::AxisBus>(sim::EndpointParts{rig_, b, *world_, faults_});
      auto wire = std::make_unique<AxesWire>(*line.axes, now_, never_);
      line.wire = wire.get();
      line.driver = make_canopen(rig_, b, std::move(wire));
      for (std::size_t f = 0; f < rig_.fixtures.size(); ++f)
        if (rig_.fixtures[f].axes->bus == b) line.aims.push_back({f, {}});
      if (!line.driver->activate(now_)) return;
    }
    ok_ = true;
  }
  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] Time now() const { return now_; }
  [[nodiscard]] const std::vector<Joints>& aim() const { return aim_; }

  void order(std::vector<Joints> to) {
    aim_ = std::move(to);
    for (Line& line : lines_)
      for (AimCommand& command : line.aims) command.joints = aim_[command.fixture];
  }
  /// One cycle of every driver, and the drives' motion until then.
  void cycle() {
    now_ += lines_[0].driver->bounds().write_period;
    while (world_->now() + sim::kTick <= now_) {
      for (Line& line : lines_) line.axes->advance(world_->now() + sim::kTick);
      world_->advance(world_->now() + sim::kTick);
    }
    for (Line& line : lines_) (void)line.driver->mover()->move(now_, line.aims);
  }
  [[nodiscard]] bool all_active() const {
    for (const Line& line : lines_)
      for (const Health& health : line.driver->health(now_))
        if (health.life != Life::active) return false;
    return true;
  }
  [[nodiscard]] double furthest_deg() const {
    const std::vector<Joints> joints = world_->joints();
    double max_rad = 0;
    for (std::size_t i = 0; i < joints.size(); ++i)
      max_rad = std::max(
          {max_rad, std::abs(joints[i].pan_rad - aim_[i].pan_rad), std::abs(joints[i].tilt_rad - aim_[i].tilt_rad)});
    return deg_from_rad(max_rad);
  }
  [[nodiscard]] std::uint64_t frames() const {
    std::uint64_t all = 0;
    for (const Line& line : lines_) all += line.wire->frames;
    return all;
  }

 private:
  struct Line {
    std::unique_ptr<sim::AxisBus> axes;
    std::unique_ptr<Driver> driver;
    AxesWire* wire = nullptr;
    std::vector<AimCommand> aims;
  };

  Rig rig_;
  sim::Faults faults_;
  std::unique_ptr<sim::World> world_;
  std::array<Line, kCanBuses> lines_;
  std::vector<Joints> aim_;
  Time now_{};
  bool never_ = false, ok_ = false;
};

/// New aims, and the time of the slowest head by the closed form.
std::pair<std::vector<Joints>, double> other_aims(const std::vector<Joints>& from, std::mt19937& random) {
  std::uniform_real_distribution<double> pan_deg(-160, 160), tilt_deg(-110, 110);
  std::vector<Joints> to = from;
  double needed_s = 0;
  for (std::size_t i = 0; i < to.size(); ++i) {
    to[i].pan_rad = rad_from_deg(pan_deg(random));
    to[i].tilt_rad = rad_from_deg(tilt_deg(random));
    const HeadMove move = head_move(deg_from_rad(to[i].pan_rad - from[i].pan_rad),
                                    deg_from_rad(to[i].tilt_rad - from[i].tilt_rad), kPanLimits, kTiltLimits);
    needed_s = std::max(needed_s, move.seconds);
  }
  return {std::move(to), needed_s};
}

}  // namespace

BenchRow measure_axes_day(double simulated_s) {
  BenchRow row;
  row.case_name = kAxesDay;
  row.method = "canopen";
  row.error = 100;
  row.target_error = 1;
  DayOfHeads day;
  BusLoad load;
  add_columns(row, load);
  if (!day.ok()) return row;
  const double begun = process_cpu_s();
  const Time ready_until = day.now() + from_seconds(kSetUpWithin_s);
  do day.cycle();
  while (!day.all_active() && day.now() < ready_until);

  std::mt19937 random{11};
  std::uniform_real_distribution<double> show_s(kShortestShow_s, kLongestShow_s);
  std::int64_t memory_start = 0, most = 0, cycles = 0;
  int moves = 0, never = 0, faulted = 0;
  double latest_s = 0;
  const Time start = day.now(), end = start + from_seconds(simulated_s);
  while (day.now() < end) {
    auto [to, needed_s] = other_aims(day.aim(), random);
    const Time asked = day.now(), next = asked + from_seconds(std::max(show_s(random), needed_s + 1));
    day.order(std::move(to));
    std::optional<Time> there;
    while (day.now() < next || (!there && day.now() < asked + from_seconds(kGiveUpMove_s))) {
      day.cycle();
      ++cycles;
      if (!there && day.furthest_deg() < kThere_deg) there = day.now();
    }
    ++moves;
    never += !there;
    faulted += !day.all_active();
    if (there) latest_s = std::max(latest_s, to_seconds(*there - asked) - needed_s);
    if (moves <= 10) memory_start = most = resident_bytes();
    if (moves > 10) most = std::max(most, resident_bytes());
    say_row_made(fmt::format("{}, {:.1f} of {:.1f} hours", row.case_name, to_seconds(day.now() - start) / 3600,
                             simulated_s / 3600),
                 row.method);
  }
  row.seconds = process_cpu_s() - begun;
  load.growth_bytes = std::max<std::int64_t>(0, most - memory_start);
  load.note = fmt::format("{:.2f} hours; {} frames; {} moves of 32 heads; slowest {:.0f} ms late; {} never; {} faulted",
                          to_seconds(day.now() - start) / 3600, day.frames(), moves, 1e3 * latest_s, never, faulted);
  row.error = latest_s / kLatestArrival_s;
  if (never > 0 || faulted > 0 || memory_grows(memory_start, *load.growth_bytes)) row.error = 100;
  fmt::print(
      "{}: {}; {:.0f} s of processor for drivers and drives, {:.1f} us a cycle; resident memory {} KiB at the "
      "start, {} at most\n",
      row.case_name, load.note, row.seconds, 1e6 * row.seconds / static_cast<double>(std::max<std::int64_t>(1, cycles)),
      memory_start / 1024, most / 1024);
  add_columns(row, load);
  return row;
}

}  // namespace luxrig
