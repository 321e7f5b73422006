// 247 Modbus units for a day, in simulated time: the driver's state, the units and memory.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "drivers/modbus/modbus_driver.h"
#include "sim/wire/modbus/rig_units.h"
#include "tools/bench/buses/bus_load.h"
#include "tools/bench/buses/modbus_load.h"
#include "tools/bench/row_progress.h"

namespace luxrig {
namespace {

using std::chrono::milliseconds;

constexpr int kDayUnits = 247;
constexpr Duration kDayPeriod = milliseconds(100), kDayPoll = milliseconds(200);
constexpr double kLevelStep = 0.5 / 1000;  // of a register that counts to 1000

/// Requests go as Modbus TCP frames straight to the simulated units, and answers come back.
class UnitsLink final : public modbus::Link {
 public:
  explicit UnitsLink(sim::ModbusUnits& units) : units_(units) {}
  [[nodiscard]] bool connected() const override { return connected_; }
  Result<void> connect(milliseconds) override {
    connected_ = true;
    return {};
  }
  void close() override { connected_ = false; }
  Result<std::vector<std::uint16_t>> exchange(const modbus::Request& request, milliseconds) override {
    ++exchanges;
    ++transaction_;
    last_exception_ = 0;
    const std::vector<sim::ModbusReply> replies = session_.receive(modbus::encode(request, transaction_), units_);
    if (replies.empty()) return tl::unexpected(Fault{Cause::timeout, {}, "no answer", {}});
    modbus::Answer answer = modbus::decode(request, transaction_, replies.front().bytes);
    if (answer.verdict == modbus::Verdict::good) return std::move(answer.values);
    last_exception_ = answer.exception_code;
    return tl::unexpected(Fault{Cause::refused, {}, std::move(answer.what), {}});
  }
  bool found_closed() override { return false; }
  [[nodiscard]] bool answers_are_numbered() const override { return true; }

  std::uint64_t exchanges = 0;

 private:
  sim::ModbusUnits& units_;
  sim::ModbusSession session_;
  std::uint16_t transaction_ = 0;
  bool connected_ = false;
};

/// All lamps fade up and down, each a little later than the previous one.
double level_of(std::size_t fixture, double at_s) {
  return 0.5 + 0.45 * std::sin(at_s / 7 + 0.1 * static_cast<double>(fixture));
}

}  // namespace

BenchRow measure_modbus_day(double simulated_s) {
  BenchRow row;
  row.case_name = kModbusDay;
  row.method = "modbus_tcp";
  row.error = 1;
  row.target_error = 0;
  BusLoad load;
  add_columns(row, load);
  const Rig rig = unit_rig({"modbus_tcp", kDayUnits, 0});
  auto world = sim::World::make(rig, sim::Deviations::none(), Eigen::MatrixXd::Identity(kDayUnits, kDayUnits));
  if (!world) return row;
  sim::Faults faults;
  sim::RigUnits units({rig, 0, **world, faults});
  auto wire = std::make_unique<UnitsLink>(units);
  UnitsLink* const link = wire.get();
  ModbusTiming timing;
  timing.refresh = milliseconds(400);
  timing.poll = kDayPoll;
  timing.behind_gateway = true;
  ModbusDriver driver(std::move(wire), timing, rig, 0);

  const double begun = process_cpu_s();
  Time at{};
  if (!driver.activate(at)) return row;
  const auto calls = static_cast<std::int64_t>(simulated_s / to_seconds(kDayPeriod)),
             warm = std::min(calls / 10, std::int64_t{6000});
  std::vector<LevelCommand> commands(rig.fixtures.size());
  std::vector<Time> last(rig.luxmeters.size());
  std::int64_t memory_start = 0, most = 0;
  std::uint64_t readings = 0, failed = 0;
  double longest_s = 0, furthest = 0;
  for (std::int64_t call = 0; call < calls; ++call) {
    at += kDayPeriod;
    (*world)->advance(at);
    units.advance(at);
    // The levels written last have taken effect.
    const std::vector<double> drives = (*world)->drives();
    for (std::size_t f = 0; call > 0 && f < drives.size(); ++f)
      furthest = std::max(furthest, std::abs(drives[f] - commands[f].drive));
    for (std::size_t f = 0; f < commands.size(); ++f) commands[f] = {f, level_of(f, to_seconds(at - Time{}))};
    failed += !driver.write(at, commands);
    const auto fresh = driver.read(at);
    failed += !fresh;
    for (std::size_t i = 0; fresh && i < fresh->size(); ++i) {
      Time& seen = last[(*fresh)[i].luxmeter];
      if (seen > Time{}) longest_s = std::max(longest_s, to_seconds(at - seen));
      seen = at;
      ++readings;
    }
    if (call == warm) memory_start = resident_bytes();
    if (call > warm && call % 6000 == 0) {
      most = std::max(most, resident_bytes());
      say_row_made(
          fmt::format("{}, {:.1f} of {:.1f} hours", row.case_name, to_seconds(at - Time{}) / 3600, simulated_s / 3600),
          row.method);
    }
  }
  most = std::max(most, resident_bytes());
  row.seconds = process_cpu_s() - begun;
  std::uint64_t errors = 0;
  for (const Health& health : driver.health(at)) errors += health.errors + (health.life != Life::active);
  load.growth_bytes = std::max<std::int64_t>(0, most - memory_start);
  load.lost = failed + errors;
  load.note =
      fmt::format("{:.2f} hours; {} exchanges; {} readings; a meter every {:.0f} ms at worst; levels within {:.5f}",
                  simulated_s / 3600, link->exchanges, readings, 1e3 * longest_s, furthest);
  const bool late = longest_s > 2 * to_seconds(kDayPoll), astray = furthest > kLevelStep + 1e-9;
  row.error = *load.lost > 0 || late || astray || memory_grows(memory_start, *load.growth_bytes) ? 1 : 0;
  fmt::print(
      "{}: {}; {} errors; {:.0f} s of processor for driver and units, {:.0f} ns an exchange; resident memory {} "
      "KiB at the start, {} at most\n",
      row.case_name, load.note, *load.lost, row.seconds,
      1e9 * row.seconds / static_cast<double>(std::max<std::uint64_t>(1, link->exchanges)), memory_start / 1024,
      most / 1024);
  add_columns(row, load);
  return row;
}

}  // namespace luxrig
