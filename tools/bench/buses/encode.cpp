// From an output program to the packets of 64 universes, without a network: processor time per frame, and a day of
// frames.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/output/dimming.h"
#include "drivers/dmx/artnet/artnet_driver.h"
#include "drivers/dmx/sacn/sacn_driver.h"
#include "tools/bench/buses/bus_load.h"
#include "tools/bench/buses/dmx_load.h"

namespace luxrig {
namespace {

constexpr double kMaxEncodeShare = 0.1;  // of a core
constexpr const char* kDmxDay = "dmx-day";

/// Accepts every packet.
class NoNetwork final : public DatagramChannel {
 public:
  Result<void> open() override {
    open_ = true;
    return {};
  }
  void close() override { open_ = false; }
  [[nodiscard]] bool is_open() const override { return open_; }
  Result<void> send(const SocketAddress&, std::span<const std::uint8_t> bytes) override {
    packets += bytes.size() > 500;
    return {};
  }
  Result<void> join(std::uint32_t) override { return {}; }
  std::optional<Fault> take_error() override { return std::nullopt; }
  std::optional<Datagram> receive() override { return std::nullopt; }
  std::uint64_t packets = 0;

 private:
  bool open_ = false;
};

/// From an output program to the bytes of a frame, without a network.
struct EncodePath {
  EncodePath(const std::string& driver_name, double seconds) : rig(loaded_rig(driver_name)) {
    if (driver_name == "artnet") rig.buses[0].options["expect_reply"] = {false, {}};
    auto channel = std::make_unique<NoNetwork>();
    network = channel.get();
    if (driver_name == "artnet") {
      driver = make_artnet_over(std::move(channel), rig, 0, std::nullopt);
    } else {
      std::vector<std::unique_ptr<DatagramChannel>> channels;
      channels.push_back(std::move(channel));
      driver = make_sacn_over(std::move(channels), rig, 0, std::nullopt);
    }
    program = long_fade(rig, Time{} + std::chrono::hours(1), seconds);
    at = program.start;
    levels.resize(rig.fixtures.size());
    commands.resize(rig.fixtures.size());
    (void)driver->activate(at);
  }
  void evaluate() {
    program.levels_at(at, levels);
    for (std::size_t f = 0; f < commands.size(); ++f) {
      commands[f] = {f, drive_for(rig.fixtures[f], levels[f])};
    }
  }
  void write() {
    (void)driver->level_output()->write(at, commands);
    at += from_seconds(kLoadPeriod_s);
  }

  Rig rig;
  NoNetwork* network = nullptr;
  std::unique_ptr<Driver> driver;
  OutputProgram program;
  std::vector<double> levels;
  std::vector<LevelCommand> commands;
  Time at{};
};

BenchRow measure_encoding(const std::string& driver_name, int frames) {
  BenchRow row;
  row.case_name = fmt::format("dmx-encode-{}-universes", kLoadUniverses);
  row.method = driver_name;
  row.error = std::nan("");
  row.target_seconds = kMaxEncodeShare * kLoadPeriod_s;
  BusLoad load;
  EncodePath path(driver_name, frames * kLoadPeriod_s);
  std::vector<double> evaluating, encoding;
  for (int frame = 0; frame < frames; ++frame) {
    const double begun = thread_cpu_s();
    path.evaluate();
    const double evaluated = thread_cpu_s();
    path.write();
    evaluating.push_back(evaluated - begun);
    encoding.push_back(thread_cpu_s() - evaluated);
  }
  const auto median = [](std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  const double evaluate_s = median(evaluating), encode_s = median(encoding);
  const auto sent = static_cast<double>(path.network->packets);
  row.seconds = evaluate_s + encode_s;
  load.core_share = row.seconds / kLoadPeriod_s;
  load.note = fmt::format("{:.0f} ns a universe: levels {:.0f} and packet {:.0f}", 1e9 * row.seconds / kLoadUniverses,
                          1e9 * evaluate_s / kLoadUniverses, 1e9 * encode_s / kLoadUniverses);
  if (sent < 0.99 * frames * kLoadUniverses) {
    row.error = 1;
    row.target_error = 0;
    load.note = fmt::format("{:.0f} packets only", sent);
  }
  fmt::print("{} by {}: {:.1f} us a frame of {} fixtures; {}\n", row.case_name, driver_name, 1e6 * row.seconds,
             path.rig.fixtures.size(), load.note);
  add_columns(row, load);
  return row;
}

/// A day's frames one after another, under a stepped clock, for the growth of memory.
BenchRow measure_day(const std::string& driver_name, double simulated_s) {
  BenchRow row;
  row.case_name = kDmxDay;
  row.method = driver_name;
  row.target_error = 0;
  EncodePath path(driver_name, simulated_s);
  const auto frames = static_cast<std::int64_t>(simulated_s / kLoadPeriod_s),
             warm = std::min(frames / 10, std::int64_t{4400});
  const double begun = process_cpu_s();
  std::int64_t memory_start = 0, most = 0;
  for (std::int64_t frame = 0; frame < frames; ++frame) {
    path.evaluate();
    path.write();
    if (frame == warm) memory_start = resident_bytes();
    if (frame > warm && frame % 4400 == 0) most = std::max(most, resident_bytes());
  }
  most = std::max(most, resident_bytes());
  row.seconds = process_cpu_s() - begun;
  BusLoad load;
  load.growth_bytes = most - memory_start;
  load.lost = static_cast<std::uint64_t>(frames * kLoadUniverses) - path.network->packets;
  load.note = fmt::format("{:.2f} hours; {} packets", simulated_s / 3600, path.network->packets);
  row.error = *load.lost > 0 || memory_grows(memory_start, *load.growth_bytes) ? 1 : 0;
  fmt::print("{} by {}: {} in {:.0f} s; resident memory {} KiB at the start, {} at most\n", row.case_name, driver_name,
             load.note, row.seconds, memory_start / 1024, most / 1024);
  add_columns(row, load);
  return row;
}

}  // namespace

Rig loaded_rig(const std::string& driver) {
  Rig rig;
  rig.file = rig.name = "bench";
  Bus bus;
  bus.name = "dmx";
  bus.driver = driver;
  bus.options["destination"] = {std::string("127.0.0.1"), {}};
  bus.options["continuous"] = {true, {}};
  rig.buses.push_back(bus);
  for (int u = 1; u <= kLoadUniverses; ++u) {
    for (int f = 0; f < kLoadFixtures; ++f) {
      Fixture fixture;
      fixture.name = fmt::format("f{}-{}", u, f);
      fixture.patch = DmxPatch{u, 1 + 8 * f, {{SlotUse::dimmer, 0}, {SlotUse::dimmer_fine, 0}}};
      rig.fixtures.push_back(fixture);
    }
  }
  return rig;
}

OutputProgram long_fade(const Rig& rig, Time start, double seconds) {
  OutputProgram program;
  program.revision = 1;
  program.from_level.assign(rig.fixtures.size(), 0.0);
  program.to_level.assign(rig.fixtures.size(), 1.0);
  program.max_level.assign(rig.fixtures.size(), 1.0);
  program.joints.resize(rig.fixtures.size());
  program.start = start;
  program.duration = from_seconds(seconds);
  program.worst_lux_per_level.resize(0, static_cast<Eigen::Index>(rig.fixtures.size()));
  program.max_lx.resize(0);
  return program;
}

std::vector<BenchRow> bench_dmx_encoding(const BenchOptions& options) {
  std::vector<BenchRow> rows;
  for (const char* driver : {"sacn", "artnet"}) {
    if (fmt::format("dmx-encode-{}-universes", kLoadUniverses).starts_with(options.only))
      rows.push_back(measure_encoding(driver, options.quick ? 500 : 5000));
  }
  // Only by its full name: takes many minutes.
  if (options.only == kDmxDay) {
    rows.push_back(measure_day("sacn", options.seconds.value_or(options.quick ? 600 : 86400)));
  }
  return rows;
}

}  // namespace luxrig
