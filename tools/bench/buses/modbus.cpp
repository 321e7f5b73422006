// 247 Modbus units behind one server, each a dimmer and a luxmeter: how often each is reached, and at what cost.
#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "drivers/registry.h"
#include "sim/wire/bus_endpoint.h"
#include "tools/bench/buses/bus_load.h"
#include "tools/bench/buses/modbus_load.h"
#include "tools/bench/suites.h"

namespace luxrig {
namespace {

using std::chrono::milliseconds;
using BenchClock = std::chrono::steady_clock;

constexpr double kWantedRound_s = 0.2;  // wanted period of a luxmeter's readings

Time bench_now() { return Time{} + std::chrono::duration_cast<Duration>(BenchClock::now().time_since_epoch()); }

std::string name_of_load(const ModbusLoad& load) {
  return fmt::format("modbus-{}-units{}", load.units, load.dead ? fmt::format("-{}-dead", load.dead) : "");
}

BenchRow measure(const ModbusLoad& load, double seconds) {
  BenchRow row;
  row.case_name = name_of_load(load);
  row.method = load.driver;
  row.error = 1;
  row.target_error = 0.5;
  BusLoad figures;
  add_columns(row, figures);
  const Rig rig = unit_rig(load);
  const auto rows = static_cast<Eigen::Index>(rig.luxmeters.size());
  auto world = sim::World::make(rig, sim::Deviations::none(), Eigen::MatrixXd::Ones(rows, rows));
  sim::Faults faults;
  if (!world) return row;
  auto endpoint = sim::open_endpoint({rig, 0, **world, faults}, sim::EndpointPlace{});
  if (!endpoint) return row;
  for (int unit = 1; unit <= load.dead; ++unit) faults.set(fmt::format("meter-{}", unit), sim::FaultKind::silent, true);
  const Redirect redirect{"127.0.0.1", (*endpoint)->port(), (*endpoint)->path()};
  std::jthread far([&](const std::stop_token& stop) {
    std::vector<int> descriptors;
    while (!stop.stop_requested()) {
      (*endpoint)->serve(bench_now());
      descriptors.clear();
      (*endpoint)->descriptors(descriptors);
      std::vector<pollfd> waits;
      for (const int fd : descriptors) waits.push_back({fd, POLLIN, 0});
      ::poll(waits.data(), waits.size(), 1);
    }
  });

  auto driver = find_driver(load.driver)->make(rig, 0, redirect);
  if (!driver->activate(bench_now())) return row;
  std::vector<LevelCommand> commands(rig.fixtures.size());
  std::vector<Time> last(rig.luxmeters.size());
  std::vector<double> rounds;
  double worst_round = 0, worst_call = 0, busy = 0;
  const Time start = bench_now(), counted = start + std::chrono::seconds(2);
  Time wake = start;
  while (bench_now() < counted + from_seconds(seconds)) {
    const double before = thread_cpu_s();
    const Time begun = bench_now();
    const double level = 0.5 + 0.4 * std::sin(to_seconds(begun - start));  // every level changes all the time
    for (std::size_t f = 0; f < commands.size(); ++f) commands[f] = {f, level};
    (void)driver->level_output()->write(bench_now(), commands);
    const auto readings = driver->lux_reader()->read(bench_now());
    const Time done = bench_now();
    if (begun >= counted) {
      busy += thread_cpu_s() - before;
      worst_call = std::max(worst_call, to_seconds(done - begun));
    }
    for (std::size_t i = 0; readings && i < readings->size(); ++i) {
      Time& seen = last[(*readings)[i].luxmeter];
      if (seen >= counted) {
        rounds.push_back(to_seconds(done - seen));
        worst_round = std::max(worst_round, rounds.back());
      }
      seen = done;
    }
    wake = std::max(wake + milliseconds(100), bench_now());
    std::this_thread::sleep_for(wake - bench_now());
  }
  const Health bus = driver->health(bench_now()).at(0);
  if (rounds.empty()) {
    figures.note = "no unit read twice";
    add_columns(row, figures);
    return row;
  }
  const auto middle = rounds.begin() + static_cast<std::ptrdiff_t>(rounds.size() / 2);
  std::nth_element(rounds.begin(), middle, rounds.end());
  const int living = load.units - load.dead;
  fmt::print(
      "{} over {}: each of {} units read every {:.0f} ms (median), {:.0f} ms at worst; {:.2f} ms an exchange and unit; "
      "write and read together {:.0f} ms at worst; {:.1f} % of a core; {} requests, {} errors\n",
      row.case_name, load.driver, living, 1e3 * *middle, 1e3 * worst_round, 1e3 * worst_call / (2.0 * living),
      1e3 * worst_call, 100 * busy / seconds, bus.sent, bus.errors);
  row.error = std::max(0.0, *middle / kWantedRound_s - 1);  // delay beyond the wanted period, as a share of it
  row.seconds = seconds;
  figures.core_share = busy / seconds;
  figures.note = fmt::format("each unit every {:.0f} ms; {:.0f} at worst; {} errors", 1e3 * *middle, 1e3 * worst_round,
                             bus.errors);
  add_columns(row, figures);
  return row;
}

}  // namespace

Rig unit_rig(const ModbusLoad& load) {
  Rig rig;
  rig.file = "bench";
  rig.name = "bench";
  Bus bus;
  bus.name = "field";
  bus.driver = load.driver;
  bus.options[bus.driver == "modbus_rtu" ? "device" : "host"] = {
      std::string(bus.driver == "modbus_rtu" ? "/dev/luxrig-bench" : "127.0.0.1"), {}};
  rig.buses.push_back(bus);
  for (int unit = 1; unit <= load.units; ++unit) {
    Fixture fixture;
    fixture.name = fmt::format("dimmer-{}", unit);
    fixture.patch = ModbusPatch{unit, 0, 1000, 0, {}, nullptr};
    rig.fixtures.push_back(fixture);
    Luxmeter meter;
    meter.name = fmt::format("meter-{}", unit);
    meter.patch.unit = unit;
    meter.patch.first_register = 2;
    rig.luxmeters.push_back(meter);
  }
  return rig;
}

std::vector<BenchRow> bench_modbus_load(const BenchOptions& options) {
  // Only by its full name: takes many minutes.
  if (options.only == kModbusDay) return {measure_modbus_day(options.seconds.value_or(options.quick ? 600 : 86400))};
  std::vector<BenchRow> rows;
  for (const ModbusLoad& load :
       {ModbusLoad{"modbus_tcp", 247, 0}, ModbusLoad{"modbus_tcp", 247, 10}, ModbusLoad{"modbus_rtu", 8, 0},
        ModbusLoad{"modbus_rtu", 8, 1}, ModbusLoad{"modbus_rtu", 32, 0}}) {
    if (name_of_load(load).starts_with(options.only))
      rows.push_back(measure(load, options.seconds.value_or(options.quick ? 4 : 6)));
  }
  return rows;
}

}  // namespace luxrig
