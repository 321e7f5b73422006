// 64 axes on four CAN buses of eight heads each, from the daemon's bus threads through datagrams to simulated drives
// that measure their own timing. One bus of 1 Mbit/s has no room for 32 heads in a cycle of 20 ms.
#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <mutex>
#include <random>
#include <thread>

#include "drivers/registry.h"
#include "sim/wire/bus_endpoint.h"
#include "tools/bench/buses/axes_load.h"
#include "tools/bench/buses/bus_load.h"
#include "tools/bench/suites.h"
#include "tools/luxrigd/bus_thread.h"
#include "tools/luxrigd/scheduling.h"
#include "tools/process/clock.h"

namespace luxrig {
namespace {

constexpr double kCycleJitter_s = 0.002;
constexpr double kFrame_s = 135e-6;  // eight bytes with stuffing, at 1 Mbit/s
constexpr const char* kAxesCase = "axes-64";

/// The far ends of all buses, in a thread of their own.
class Heads {
 public:
  explicit Heads(const Rig& rig) : start_(now()) {
    auto world = sim::World::make(rig, sim::Deviations::none(),
                                  Eigen::MatrixXd::Zero(0, static_cast<Eigen::Index>(rig.fixtures.size())));
    if (!world) return;
    world_ = std::move(*world);
    for (std::size_t b = 0; b < kCanBuses; ++b) {
      auto endpoint = sim::open_endpoint({rig, b, *world_, faults_}, 0);
      if (!endpoint) return;
      endpoints_.push_back(std::move(*endpoint));
    }
    thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
  }
  [[nodiscard]] bool ok() const { return endpoints_.size() == kCanBuses; }
  [[nodiscard]] int port(std::size_t bus) const { return endpoints_[bus]->port(); }
  [[nodiscard]] double cpu_s() const { return cpu_s_; }
  [[nodiscard]] double furthest_deg(const std::vector<Joints>& from) const {
    const std::lock_guard lock(mutex_);
    const std::vector<Joints> joints = world_->joints();
    double most = 0;
    for (std::size_t i = 0; i < joints.size(); ++i) {
      most = std::max(
          {most, std::abs(joints[i].pan_rad - from[i].pan_rad), std::abs(joints[i].tilt_rad - from[i].tilt_rad)});
    }
    return deg_from_rad(most);
  }

 private:
  void serve(const std::stop_token& stop) {
    std::vector<int> descriptors;
    while (!stop.stop_requested()) {
      std::vector<pollfd> waits;
      {
        const std::lock_guard lock(mutex_);
        const Time at = Time{} + (now() - start_);  // the world starts at Time{}
        descriptors.clear();
        for (const auto& endpoint : endpoints_) {
          endpoint->serve(at);
          endpoint->descriptors(descriptors);
        }
        world_->advance(at);
      }
      for (const int fd : descriptors) waits.push_back({fd, POLLIN, 0});
      ::poll(waits.data(), waits.size(), 1);
      cpu_s_ = thread_cpu_s();
    }
  }

  Time start_;
  sim::Faults faults_;
  std::unique_ptr<sim::World> world_;
  std::vector<std::unique_ptr<sim::BusEndpoint>> endpoints_;
  mutable std::mutex mutex_;
  std::atomic<double> cpu_s_{0};
  std::jthread thread_;
};

struct HeadBuses {
  explicit HeadBuses(const Rig& rig, const Heads& heads) {
    for (std::size_t b = 0; b < kCanBuses; ++b) {
      threads.push_back(std::make_unique<BusThread>(
          rig, b, find_driver("canopen")->make(rig, b, Redirect{"127.0.0.1", heads.port(b)}), programs[b]));
      threads.back()->start();
    }
  }
  void aim(const Rig& rig, const std::vector<Joints>& joints) {
    OutputProgram program;
    program.revision = ++revision;
    program.from_level.assign(rig.fixtures.size(), 0.0);
    program.to_level = program.max_level = program.from_level;
    program.joints = joints;
    program.worst_lux_per_level.resize(0, static_cast<Eigen::Index>(rig.fixtures.size()));
    program.max_lx.resize(0);
    for (ProgramMailbox& mailbox : programs) mailbox.put(program);
  }
  [[nodiscard]] std::uint64_t faulted() const {
    std::uint64_t count = 0;
    for (const auto& thread : threads) {
      for (const Health& health : thread->health()) count += health.life != Life::active;
    }
    return count;
  }
  /// Frames of both directions, and cycles.
  [[nodiscard]] std::pair<std::uint64_t, std::uint64_t> traffic() const {
    std::uint64_t frames = 0, cycles = 0;
    for (const auto& thread : threads) {
      const std::vector<Health> all = thread->health();
      for (std::size_t i = 1; i < all.size(); ++i) frames += all[i].sent + all[i].received;
      cycles += all.empty() ? 0 : all[0].sent;
    }
    return {frames + cycles, cycles};
  }

  std::array<ProgramMailbox, kCanBuses> programs;
  std::vector<std::unique_ptr<BusThread>> threads;
  std::uint64_t revision = 0;
};

struct Arrivals {
  int moves = 0, never = 0;
  TimeCounts late;         ///< delay of the slowest head after its closed form
  std::vector<Joints> at;  ///< last aims, where all have come to rest
  std::mt19937 random{7};
};

/// Gives every head a new aim, again and again. Each round lasts until all have come to rest.
void turn_heads(const Rig& rig, const Heads& heads, HeadBuses& buses, double seconds, Arrivals& arrivals) {
  std::uniform_real_distribution<double> pan_deg(-60, 60), tilt_deg(-40, 40);
  std::vector<Joints>& at = arrivals.at;
  for (const Time end = now() + from_seconds(seconds); now() < end;) {
    std::vector<Joints> to = at;
    double needed_s = 0;
    for (std::size_t i = 0; i < to.size(); ++i) {
      to[i] = {rad_from_deg(pan_deg(arrivals.random)), rad_from_deg(tilt_deg(arrivals.random))};
      const HeadMove move = head_move(deg_from_rad(to[i].pan_rad - at[i].pan_rad),
                                      deg_from_rad(to[i].tilt_rad - at[i].tilt_rad), kPanLimits, kTiltLimits);
      needed_s = std::max(needed_s, move.seconds);
    }
    const Time asked = now();
    buses.aim(rig, to);
    const Time latest = asked + from_seconds(needed_s + 5);
    while (heads.furthest_deg(to) > kThere_deg && now() < latest) sleep_until(now() + std::chrono::milliseconds(2));
    ++arrivals.moves;
    if (heads.furthest_deg(to) > kThere_deg) ++arrivals.never;
    arrivals.late.add(std::max(0.0, to_seconds(now() - asked) - needed_s));
    at = to;
    sleep_until(now() + std::chrono::milliseconds(200));
  }
}

}  // namespace

Rig rig_of_heads() {
  Rig rig;
  rig.file = rig.name = "bench";
  for (int b = 0; b < kCanBuses; ++b) {
    Bus bus;
    bus.name = fmt::format("axes-{}", b + 1);
    bus.driver = "canopen";
    bus.options["interface"] = {fmt::format("can{}", b), {}};
    bus.options["homing_method"] = {std::int64_t{35}, {}};
    rig.buses.push_back(bus);
  }
  Bus lamps;
  lamps.name = "lamps";
  lamps.driver = "sacn";
  rig.buses.push_back(lamps);
  for (int i = 0; i < kCanBuses * kHeadsOfBus; ++i) {
    Fixture head;
    head.name = fmt::format("head-{}", i + 1);
    head.bus = kCanBuses;
    head.patch = DmxPatch{1, 1 + i, {DmxSlot{}}};
    head.moves = true;
    head.range = {rad_from_deg(-170), rad_from_deg(170), rad_from_deg(-120), rad_from_deg(120)};
    head.pan_speed_rad_s = rad_from_deg(kPanLimits.speed);
    head.tilt_speed_rad_s = rad_from_deg(kTiltLimits.speed);
    const int node = 1 + 2 * (i % kHeadsOfBus);
    head.axes = AxesPatch{static_cast<std::size_t>(i / kHeadsOfBus),
                          {node, 500, 0, rad_from_deg(kPanLimits.acceleration)},
                          {node + 1, -400, 0, rad_from_deg(kTiltLimits.acceleration)}};
    rig.fixtures.push_back(head);
  }
  return rig;
}

std::vector<BenchRow> bench_axes_load(const BenchOptions& options) {
  // Only by its full name: takes many minutes.
  if (options.only == kAxesDay) return {measure_axes_day(options.seconds.value_or(options.quick ? 600 : 86400))};
  if (!std::string_view(kAxesCase).starts_with(options.only)) return {};
  const double seconds = options.seconds.value_or(options.quick ? 6 : 10);
  BenchRow cycle, arrival;
  cycle.case_name = fmt::format("{}-cycle", kAxesCase);
  arrival.case_name = fmt::format("{}-arrival", kAxesCase);
  cycle.method = arrival.method = "canopen";
  cycle.error = arrival.error = 1;
  const Rig rig = rig_of_heads();
  const Heads heads(rig);
  BusLoad load;
  if (!heads.ok()) {
    add_columns(cycle, {});
    return {cycle};
  }
  lock_memory();
  HeadBuses buses(rig, heads);
  // Wait until all are found, set up and homed where they stand.
  buses.aim(rig, std::vector<Joints>(rig.fixtures.size()));
  const Time patience = now() + std::chrono::seconds(30);
  sleep_until(now() + std::chrono::seconds(1));
  while (buses.faulted() > 0 && now() < patience) sleep_until(now() + std::chrono::milliseconds(50));
  const auto arrivals = std::make_unique<Arrivals>();
  arrivals->at.resize(rig.fixtures.size());

  const std::int64_t memory_start = resident_bytes();
  const double cpu_start = process_cpu_s() - thread_cpu_s(), heads_start = heads.cpu_s();
  const auto traffic_start = buses.traffic();
  const Time start = now();
  turn_heads(rig, heads, buses, seconds / 2, *arrivals);
  const std::int64_t memory_middle = resident_bytes();
  turn_heads(rig, heads, buses, seconds / 2, *arrivals);
  const double wall = to_seconds(now() - start), simulated = heads.cpu_s() - heads_start;
  const double core = (process_cpu_s() - thread_cpu_s() - cpu_start - simulated) / wall;
  const std::int64_t memory_end = resident_bytes();
  const auto traffic = buses.traffic();
  const double bus_share = static_cast<double>(traffic.first - traffic_start.first) * kFrame_s / (wall * kCanBuses);

  IntervalJitter jitter;
  for (const auto& thread : buses.threads) {
    const CycleStatistics& seen = thread->statistics();
    const auto worse = [](double& mine, std::int64_t theirs_us) {
      mine = std::max(mine, 1e-6 * static_cast<double>(theirs_us));
    };
    worse(jitter.p50_s, seen.quantile_us(0.5));
    worse(jitter.p99_s, seen.quantile_us(0.99));
    worse(jitter.p999_s, seen.quantile_us(0.999));
    worse(jitter.worst_s, seen.max_us());
  }
  const std::uint64_t faulted = buses.faulted();
  const double period_s = to_seconds(buses.threads[0]->statistics().period());
  fmt::print(
      "{} axes on {} buses, cycle {:.0f} ms, {:.1f} s: {:.1f} % of a core (drives {:.1f} %), {:.0f} % of each "
      "bus at 1 Mbit/s; |cycle - period| of the worst bus: p50 {:.0f} us, p99 {:.0f} us, p99.9 {:.0f} us, worst "
      "{:.0f} us\n",
      2 * rig.fixtures.size(), kCanBuses, 1e3 * period_s, wall, 100 * core, 100 * simulated / wall, 100 * bus_share,
      1e6 * jitter.p50_s, 1e6 * jitter.p99_s, 1e6 * jitter.p999_s, 1e6 * jitter.worst_s);
  fmt::print(
      "  {} moves of {} heads: the slowest is there {:.0f} ms after the closed form (median), {:.0f} ms at worst; "
      "{} not within 5 s; {} faulted at the end\n",
      arrivals->moves, rig.fixtures.size(), 1e3 * arrivals->late.quantile(0.5), 1e3 * arrivals->late.largest(),
      arrivals->never, faulted);
  fmt::print("  resident memory: {} KiB at the start, {} in the middle, {} at the end\n", memory_start / 1024,
             memory_middle / 1024, memory_end / 1024);

  const std::int64_t growth = std::max(memory_middle, memory_end) - memory_start;
  load.core_share = core;
  load.jitter = jitter;
  load.growth_bytes = growth;
  load.note = fmt::format("{:.0f} % of each bus", 100 * bus_share);
  cycle.seconds = arrival.seconds = wall;
  cycle.target_error = kCycleJitter_s / period_s;
  cycle.error = jitter.p99_s / period_s;
  if (memory_grows(memory_start, growth)) {
    cycle.error = std::max(cycle.error, 1.0);
    load.note += "; memory grows";
  }
  add_columns(cycle, load);
  // Delay after the closed form, as a share of the delay allowed for the handshake.
  arrival.target_error = 1;
  arrival.error = arrivals->late.largest() / kLatestArrival_s;
  if (arrivals->never > 0 || faulted > 0) arrival.error = std::max(arrival.error, 100.0);
  BusLoad late;
  late.note = fmt::format("{} moves; slowest head {:.0f} ms late", arrivals->moves, 1e3 * arrivals->late.largest());
  add_columns(arrival, late);
  return {cycle, arrival};
}

}  // namespace luxrig
