// 64 universes at 44 Hz by sACN and by Art-Net, from the daemon's bus thread through a socket to simulated receivers.
#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <pthread.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <thread>

#include "drivers/registry.h"
#include "sim/wire/artnet/artnet_node.h"
#include "sim/wire/sacn/sacn_receiver.h"
#include "sim/wire/sockets.h"
#include "tools/bench/buses/bus_load.h"
#include "tools/bench/buses/dmx_load.h"
#include "tools/bench/suites.h"
#include "tools/luxrigd/bus_thread.h"
#include "tools/luxrigd/scheduling.h"
#include "tools/process/clock.h"

namespace luxrig {
namespace {

constexpr double kLoadJitter_s = 0.002;
constexpr double kFullFrame_s = 0.022676;  // E1.11: break 92 us, mark 12 us, 513 slots of 44 us
constexpr double kLongestGap_s = 1;        // E1.11: a receiver then takes the data for lost
constexpr Duration kWarmUp = std::chrono::seconds(2);

/// The receivers of all universes behind one port: times of arrival by the kernel's clock, and missing frames.
class LoadReceivers {
 public:
  explicit LoadReceivers(bool artnet) : artnet_(artnet), node_(universe_numbers()) {
    auto bound = sim::bind_udp(0);
    if (!bound) return;
    socket_ = std::move(*bound);
    const int yes = 1, buffer = 4 << 20;
    ok_ = ::setsockopt(socket(), SOL_SOCKET, SO_TIMESTAMPNS, &yes, sizeof yes) == 0;
    ::setsockopt(socket(), SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
    thread_ = std::jthread([this](const std::stop_token& stop) { receive(stop); });
  }
  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] int port() const { return socket_.port; }
  [[nodiscard]] double cpu_s() {
    clockid_t clock{};
    timespec t{};
    if (::pthread_getcpuclockid(thread_.native_handle(), &clock) != 0) return 0;
    ::clock_gettime(clock, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }
  /// Starts counting.
  void count() { counting_ = true; }
  void stop() {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
  }

  // To be read after stop().
  TimeCounts deviations, intervals;
  std::uint64_t frames = 0, lost = 0, disordered = 0, short_intervals = 0, long_intervals = 0;
  std::uint64_t merged = 0;  ///< never starts on a line of full frames: a newer one came first

 private:
  struct Line {
    double arrived_s = 0, begun_s = 0;
    int sequence = -1;
    bool waits = false;
  };

  [[nodiscard]] int socket() const { return socket_.descriptor.get(); }
  static std::vector<int> universe_numbers() {
    std::vector<int> numbers;
    for (int u = 1; u <= kLoadUniverses; ++u) numbers.push_back(u);
    return numbers;
  }

  void receive(const std::stop_token& stop) {
    const timeval patience{0, 100'000};
    ::setsockopt(socket(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    const int flags = ::fcntl(socket(), F_GETFL);
    ::fcntl(socket(), F_SETFL, flags & ~O_NONBLOCK);
    std::array<std::uint8_t, 2048> packet{};
    alignas(cmsghdr) std::array<char, 256> control{};
    while (ok_ && !stop.stop_requested()) {
      sockaddr_in from{};
      iovec part{packet.data(), packet.size()};
      msghdr message{};
      message.msg_name = &from;
      message.msg_namelen = sizeof from;
      message.msg_iov = &part;
      message.msg_iovlen = 1;
      message.msg_control = control.data();
      message.msg_controllen = control.size();
      const ssize_t size = ::recvmsg(socket(), &message, 0);
      const cmsghdr* stamp = size > 0 ? CMSG_FIRSTHDR(&message) : nullptr;
      if (stamp == nullptr || stamp->cmsg_type != SCM_TIMESTAMPNS) continue;
      timespec at{};
      std::memcpy(&at, CMSG_DATA(stamp), sizeof at);
      const double seconds = static_cast<double>(at.tv_sec % 1'000'000) + 1e-9 * static_cast<double>(at.tv_nsec);
      const std::span<const std::uint8_t> bytes(packet.data(), static_cast<std::size_t>(size));
      if (artnet_) {
        for (const auto& reply : node_.receive(now(), ntohl(from.sin_addr.s_addr), bytes)) {
          ::sendto(socket(), reply.data(), reply.size(), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&from),
                   sizeof from);
        }
        if (const auto dmx = sim::decode_art_dmx(bytes)) take(seconds, dmx->port_address, dmx->sequence, 255);
      } else if (receiver_.receive(now(), bytes) == sim::SacnReceiver::Verdict::accepted) {
        if (const auto data = sim::decode_sacn_data(bytes)) take(seconds, data->universe, data->sequence, 256);
      }
    }
  }

  /// `numbers`: sequence numbers until they repeat; on Art-Net 1 to 255.
  void take(double at_s, int universe, int sequence, int numbers) {
    Line& line = lines_.at(static_cast<std::size_t>(universe));
    if (counting_ && line.sequence >= 0) {
      ++frames;
      const int step = (sequence - line.sequence + numbers) % numbers;
      if (step == 0 || step > numbers / 2)
        ++disordered;
      else
        lost += static_cast<std::uint64_t>(step - 1);
      const double interval_s = at_s - line.arrived_s;
      intervals.add(interval_s);
      deviations.add(std::abs(interval_s - kLoadPeriod_s));
      short_intervals += interval_s < kFullFrame_s;
      long_intervals += interval_s > kLongestGap_s;
    }
    line.arrived_s = at_s;
    line.sequence = sequence;
    // A gateway starts the newest frame as soon as the previous one is out.
    if (line.waits && line.begun_s + kFullFrame_s <= at_s) {
      line.begun_s += kFullFrame_s;
      line.waits = false;
    }
    if (line.begun_s + kFullFrame_s <= at_s) {
      line.begun_s = at_s;
    } else {
      if (line.waits && counting_) ++merged;
      line.waits = true;
    }
  }

  bool artnet_, ok_ = false;
  std::atomic<bool> counting_{false};
  sim::BoundSocket socket_;
  sim::ArtnetNode node_;
  sim::SacnReceiver receiver_;
  std::array<Line, kLoadUniverses + 1> lines_{};
  std::jthread thread_;
};

BenchRow measure_dmx(const std::string& driver, double seconds) {
  BenchRow row;
  row.case_name = fmt::format("dmx-{}-universes", kLoadUniverses);
  row.method = driver;
  row.error = 1;
  row.target_error = kLoadJitter_s / kLoadPeriod_s;
  BusLoad load;
  const Rig rig = loaded_rig(driver);
  const auto receivers = std::make_unique<LoadReceivers>(driver == "artnet");
  if (!receivers->ok()) {
    load.note = "no socket";
    add_columns(row, load);
    return row;
  }
  ProgramMailbox programs;
  programs.put(long_fade(rig, now(), seconds + 10));
  lock_memory();
  BusThread bus(rig, 0, find_driver(driver)->make(rig, 0, Redirect{"127.0.0.1", receivers->port()}), programs);
  bus.start();
  std::this_thread::sleep_for(kWarmUp);
  const std::int64_t memory_start = resident_bytes();
  const double cpu_start = process_cpu_s(), receivers_start = receivers->cpu_s();
  const Time start = now();
  receivers->count();
  sleep_until(start + from_seconds(seconds / 2));
  const std::int64_t memory_middle = resident_bytes();
  sleep_until(start + from_seconds(seconds));
  const double wall = to_seconds(now() - start), received = receivers->cpu_s() - receivers_start;
  const double core = (process_cpu_s() - cpu_start - received) / wall;
  const std::int64_t memory_end = resident_bytes();
  const bool realtime = bus.realtime();
  const std::vector<Health> health = bus.health();
  bus.stop();
  receivers->stop();

  const LoadReceivers& got = *receivers;
  const double wanted = kLoadUniverses * seconds / kLoadPeriod_s;
  fmt::print(
      "{} by {}: {:g} s, {} frames of {:.0f}, {} lost, {} out of order; {:.1f} % of a core ({} scheduling), "
      "receivers {:.1f} %\n",
      row.case_name, driver, seconds, got.frames, wanted, got.lost, got.disordered, 100 * core,
      realtime ? "SCHED_FIFO" : "normal", 100 * received / wall);
  fmt::print("|frame interval - {:.3f} ms| at the receivers, all universes:\n{}", 1e3 * kLoadPeriod_s,
             got.deviations.histogram());
  fmt::print(
      "  p50 {:.0f} us, p99 {:.0f} us, p99.9 {:.0f} us, worst {:.0f} us; {} intervals shorter than a full frame "
      "({:.2f} ms), {} frames overtaken by the next before a line could begin them, {} intervals longer than "
      "1 s\n",
      1e6 * got.deviations.quantile(0.5), 1e6 * got.deviations.quantile(0.99), 1e6 * got.deviations.quantile(0.999),
      1e6 * got.deviations.largest(), got.short_intervals, 1e3 * kFullFrame_s, got.merged, got.long_intervals);
  fmt::print("  resident memory: {} KiB at the start, {} in the middle, {} at the end\n", memory_start / 1024,
             memory_middle / 1024, memory_end / 1024);

  const std::int64_t growth = std::max(memory_middle, memory_end) - memory_start;
  load.core_share = core;
  load.jitter = jitter_of(got.deviations);
  load.lost = got.lost;
  load.growth_bytes = growth;
  row.seconds = seconds;
  row.error = got.deviations.quantile(0.99) / kLoadPeriod_s;
  const auto fails = [&](bool broken, const std::string& why) {
    if (!broken) return;
    load.note += (load.note.empty() ? "" : "; ") + why;
    row.error = std::max(row.error, 1.0);
  };
  fails(static_cast<double>(got.frames) < 0.99 * wanted, "too few frames");
  fails(got.lost + got.disordered > 0, "frames lost or out of order");
  fails(got.long_intervals > 0, "gaps of more than 1 s");
  fails(memory_grows(memory_start, growth), "memory grows");
  fails(health.empty() || health[0].life != Life::active, "the bus is faulted");
  if (load.note.empty()) load.note = realtime ? "SCHED_FIFO" : "normal scheduling";
  add_columns(row, load);
  return row;
}

}  // namespace

std::vector<BenchRow> bench_dmx_load(const BenchOptions& options) {
  std::vector<BenchRow> rows = bench_dmx_encoding(options);
  for (const char* driver : {"sacn", "artnet"}) {
    if (fmt::format("dmx-{}-universes", kLoadUniverses).starts_with(options.only))
      rows.push_back(measure_dmx(driver, options.seconds.value_or(options.quick ? 4 : 8)));
  }
  return rows;
}

}  // namespace luxrig
