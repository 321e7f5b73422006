#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <thread>

#include "core/parallel.h"
#include "core/transport/evaluator.h"
#include "drivers/registry.h"
#include "tools/bench/buses/bus_load.h"
#include "tools/bench/suites.h"
#include "tools/luxrigd/bus_thread.h"
#include "tools/luxrigd/scheduling.h"
#include "tools/process/clock.h"

namespace luxrig {
namespace {

constexpr int kUniverses = 4;
constexpr int kFixturesPerUniverse = 64;
constexpr double kRate_hz = 44;
constexpr double kTarget_s = 0.002;  // p99 deviation from the period

/// Receives all packets, and keeps the kernel's arrival times of universe 1.
class Sink {
 public:
  Sink() {
    socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    const int yes = 1;
    const timeval patience{0, 100'000};
    ok_ = socket_ >= 0 && ::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0 &&
          ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) == 0 &&
          ::setsockopt(socket_, SOL_SOCKET, SO_TIMESTAMPNS, &yes, sizeof yes) == 0 &&
          ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience) == 0;
    port_ = ntohs(address.sin_port);
    thread_ = std::jthread([this](const std::stop_token& stop) { receive(stop); });
  }
  ~Sink() {
    (void)finish();
    ::close(socket_);
  }
  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] int port() const { return port_; }
  /// Intervals [s] between packets of universe 1, and the number of packets of any universe.
  std::pair<std::vector<double>, std::uint64_t> finish() {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
    std::vector<double> intervals;
    for (std::size_t i = 1; i < arrivals_.size(); ++i) intervals.push_back(arrivals_[i] - arrivals_[i - 1]);
    return {intervals, packets_};
  }

 private:
  void receive(const std::stop_token& stop) {
    std::array<std::uint8_t, 2048> packet{};
    alignas(cmsghdr) std::array<char, 256> control{};
    while (ok_ && !stop.stop_requested()) {
      iovec part{packet.data(), packet.size()};
      msghdr message{};
      message.msg_iov = &part;
      message.msg_iovlen = 1;
      message.msg_control = control.data();
      message.msg_controllen = control.size();
      const ssize_t size = ::recvmsg(socket_, &message, 0);
      if (size < 126) continue;
      ++packets_;
      const bool first_universe = packet[113] == 0 && packet[114] == 1;
      const cmsghdr* stamp = CMSG_FIRSTHDR(&message);
      if (!first_universe || stamp == nullptr || stamp->cmsg_type != SCM_TIMESTAMPNS) continue;
      timespec at{};
      std::memcpy(&at, CMSG_DATA(stamp), sizeof at);
      arrivals_.push_back(static_cast<double>(at.tv_sec % 1'000'000) + 1e-9 * static_cast<double>(at.tv_nsec));
    }
  }

  int socket_ = -1;
  int port_ = 0;
  bool ok_ = false;
  std::uint64_t packets_ = 0;
  std::vector<double> arrivals_;
  std::jthread thread_;
};

Rig four_universes() {
  Rig rig;
  rig.file = "bench";
  rig.name = "bench";
  Luminaire bulb;
  bulb.name = "bulb";
  bulb.lumens = 800;
  bulb.intensity = make_isotropic(800);
  rig.luminaires.push_back(bulb);
  Bus bus;
  bus.name = "dmx";
  bus.driver = "sacn";
  bus.options["destination"] = {std::string("127.0.0.1"), {}};
  rig.buses.push_back(bus);
  for (int u = 1; u <= kUniverses; ++u) {
    for (int f = 0; f < kFixturesPerUniverse; ++f) {
      Fixture fixture;
      fixture.name = fmt::format("f{}-{}", u, f);
      DmxPatch patch;
      patch.universe = u;
      patch.address = 1 + 8 * f;
      patch.slots = {{SlotUse::dimmer, 0}, {SlotUse::dimmer_fine, 0}};
      fixture.patch = patch;
      rig.fixtures.push_back(fixture);
    }
  }
  return rig;
}

/// A solver that never ends: paths in a closed room from many points, on every core, at low priority.
class SolverLoad {
 public:
  SolverLoad() {
    thread_ = std::jthread([](const std::stop_token& stop) {
      make_background();
      Scene scene;
      const float s = 3;
      for (int i = 0; i < 8; ++i) scene.vertices_m.emplace_back(i & 1 ? s : -s, i & 2 ? s : -s, i & 4 ? s : -s);
      const std::uint32_t quads[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
      for (const auto& q : quads) {
        scene.triangles.push_back({q[0], q[1], q[2]});
        scene.triangles.push_back({q[0], q[2], q[3]});
      }
      scene.materials.push_back({"wall", Vec3::Constant(0.7)});
      scene.object_names = {"room"};
      scene.material_of_triangle.assign(scene.triangles.size(), 0);
      scene.object_of_triangle.assign(scene.triangles.size(), 0);
      const RayScene rays(scene);
      const auto evaluator = make_path_evaluator(rays);
      std::vector<Receiver> receivers;
      for (int i = 0; i < 64; ++i) receivers.push_back({Vec3(-2.8 + 0.08 * i, 1, -3), Vec3::UnitZ()});
      const std::vector<Emitter> emitters(8, Emitter{make_isotropic(1000), {Mat3::Identity(), Vec3(0, 0, 2)}});
      EvaluateOptions options;
      options.wanted_relative_error = 1e-6;
      options.watch.stop = stop;
      while (!stop.stop_requested()) (void)evaluator->evaluate(receivers, emitters, options);
    });
  }

 private:
  std::jthread thread_;
};

constexpr const char* kOutputCycle = "4-universes-44hz-under-solve";

BenchRow bench_output_cycle(const BenchOptions& options) {
  const double seconds = options.seconds.value_or(options.quick ? 6 : 40);
  BenchRow row;
  row.case_name = kOutputCycle;
  add_columns(row, {});
  const Rig rig = four_universes();
  Sink sink;
  if (!sink.ok()) return row;
  ProgramMailbox programs;
  OutputProgram program;
  program.revision = 1;
  program.from_level.assign(rig.fixtures.size(), 0.0);
  program.to_level.assign(rig.fixtures.size(), 1.0);
  program.max_level.assign(rig.fixtures.size(), 1.0);
  program.joints.resize(rig.fixtures.size());
  program.start = now();
  program.duration = from_seconds(seconds + 5);  // every frame differs from the last
  program.worst_lux_per_level.resize(0, static_cast<Eigen::Index>(rig.fixtures.size()));
  program.max_lx.resize(0);
  programs.put(program);
  lock_memory();
  bool realtime = false;
  CycleStatistics::Copy sent;
  {
    BusThread bus(rig, 0, find_driver("sacn")->make(rig, 0, Redirect{"127.0.0.1", sink.port()}), programs);
    const SolverLoad load;
    std::this_thread::sleep_for(std::chrono::milliseconds(500));  // until the load is at full strength
    bus.start();
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    realtime = bus.realtime();
    sent = bus.statistics().copy();
    bus.stop();
  }
  auto [intervals, packets] = sink.finish();
  TimeCounts deviations;
  for (const double interval : intervals) deviations.add(std::abs(interval - 1.0 / kRate_hz));
  fmt::print("output cycle: {} universes at {:g} Hz for {:g} s, path tracing on {} cores, {} scheduling\n", kUniverses,
             kRate_hz, seconds, thread_count(0), realtime ? "SCHED_FIFO" : "normal (SCHED_FIFO was refused)");
  fmt::print("|arrival interval - {:.3f} ms| at the receiver (kernel time stamps), universe 1, {} packets in all:\n{}",
             1000 / kRate_hz, packets, deviations.histogram());
  const double p50 = deviations.quantile(0.5), p99 = deviations.quantile(0.99);
  const double worst = deviations.largest();
  fmt::print("  p50 {:.0f} us, p99 {:.0f} us, max {:.0f} us; at the sender: p50 {} us, p99 {} us, max {} us\n",
             1e6 * p50, 1e6 * p99, 1e6 * worst, sent.p50_us, sent.p99_us, sent.max_us);
  row.method = realtime ? "sacn-fifo" : "sacn-normal";
  row.error = deviations.count() == 0 ? 1 : p99 * kRate_hz;
  row.seconds = seconds;
  row.target_error = kTarget_s * kRate_hz;
  BusLoad load;
  load.jitter = jitter_of(deviations);
  load.note = "path tracing meanwhile";
  add_columns(row, load);
  return row;
}

}  // namespace

std::vector<BenchRow> bench_buses(const BenchOptions& options) {
  std::vector<BenchRow> rows;
  if (std::string_view(kOutputCycle).starts_with(options.only)) rows.push_back(bench_output_cycle(options));
  for (const auto load : {bench_modbus_load, bench_dmx_load, bench_axes_load}) {
    for (BenchRow& each : load(options)) rows.push_back(std::move(each));
  }
  return rows;
}

}  // namespace luxrig
