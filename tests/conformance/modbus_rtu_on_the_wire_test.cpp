// The Modbus RTU driver against simulated units on a pseudo terminal, in real time: answers damaged by the line, an
// adapter that is pulled out, products with register maps, a dead unit.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <thread>

#include "core/rig/register_map/register_map.h"
#include "core/rig/rig_file.h"
#include "drivers/registry.h"
#include "tests/conformance/far_end.h"
#include "tests/drivers/test_rig.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

using std::chrono::milliseconds;

/// A driver and its far end on the real clock.
struct RealLine {
  explicit RealLine(Rig the_rig) : rig(std::move(the_rig)), far(rig) {
    const DriverEntry* entry = find_driver(rig.buses[0].driver);
    for (const Problem& problem : entry->check(rig, 0)) ADD_FAILURE() << problem.text();
    driver = entry->make(rig, 0, far.redirect());
    far.step_to(now());
    EXPECT_TRUE(driver->activate(now()));
  }
  [[nodiscard]] Time now() const {
    return at_ms(0) + std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now() - start);
  }
  Result<void> write(double drive) {
    std::vector<LevelCommand> commands;
    for (std::size_t i = 0; i < rig.fixtures.size(); ++i) commands.push_back({i, drive});
    return driver->level_output()->write(now(), commands);
  }
  /// One cycle of a bus thread: write, read, and sleep for the rest.
  void cycle(double drive) {
    const Time begun = now();
    if (driver->level_output() != nullptr) (void)write(drive);
    if (driver->lux_reader() != nullptr) {
      if (auto got = driver->lux_reader()->read(now())) {
        for (const LuxReading& reading : *got) readings[reading.luxmeter].push_back({now(), reading.lux});
      }
    }
    longest_cycle = std::max(longest_cycle, now() - begun);
    const Time next = begun + milliseconds(100);
    if (now() < next) std::this_thread::sleep_for(next - now());
  }
  void run(double seconds, double drive) {
    const Time end = now() + from_seconds(seconds);
    while (now() < end) cycle(drive);
  }
  /// Runs until every meter has been read this many times and all levels have arrived, however long a busy machine
  /// takes. The bound of 60 s only ends a test that would hang. Returns true on success.
  [[nodiscard]] bool run_until_read(std::size_t times, double drive) {
    const auto done = [&] {
      for (std::size_t meter = 0; meter < rig.luxmeters.size(); ++meter)
        if (readings[meter].size() < times) return false;
      return all_at(drive);
    };
    for (const Time end = now() + from_seconds(60); now() < end && !done();) cycle(drive);
    return done();
  }
  [[nodiscard]] Health health(const std::string& device) const {
    for (const Health& health : driver->health(now())) {
      if (health.device == device) return health;
    }
    ADD_FAILURE() << device;
    return {};
  }
  bool all_at(double drive) const {
    const std::vector<double> drives = far.drives();
    return std::all_of(drives.begin(), drives.end(), [&](double d) { return std::abs(d - drive) < 0.003; });
  }

  struct Seen {
    Time when;
    double lux;
  };
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  Rig rig;
  FarEnd far;
  std::unique_ptr<Driver> driver;
  std::map<std::size_t, std::vector<Seen>> readings;
  Duration longest_cycle{};
};

Rig line_rig(std::vector<std::pair<std::string, OptionValue>> options = {}) {
  options.emplace_back("device", std::string("/dev/luxrig-no-such-port"));
  return rig_with(bus_of("modbus_rtu", std::move(options)));
}

/// Two meters of one unit, far apart, and one of another unit: three values that must never be confused.
Rig three_meters() {
  Rig rig = line_rig();
  add_modbus(rig, "dimmer", 9, 0);
  add_meter(rig, "a", 1, 2);
  add_meter(rig, "b", 1, 20);
  add_meter(rig, "c", 2, 2);
  return rig;
}

class LineFault : public ::testing::TestWithParam<std::pair<sim::FaultKind, double>> {};

TEST_P(LineFault, GivesNoWrongReadingAndClearsAsSoonAsItEnds) {
  RealLine line(three_meters());
  line.far.faults().set("b", sim::FaultKind::lying, true, 0.5);
  line.far.faults().set("c", sim::FaultKind::lying, true, 3.0);
  line.run(0.6, 1.0);
  // Answers have no number: one that the machine holds up beyond the timeout, and that has another unit's number, is
  // that unit's as far as a driver can tell. The far end counts what was held up; nothing else excuses a wrong reading.
  const auto no_wrong_reading = [&]() -> ::testing::AssertionResult {
    std::uint64_t wrong = 0;
    std::string first;
    for (const auto& [meter, seen] : line.readings) {
      const double wanted_lx = meter == 0 ? 100 : meter == 1 ? 50 : 300;
      for (const RealLine::Seen& each : seen) {
        if (std::abs(each.lux - wanted_lx) <= 0.5) continue;
        if (wrong++ == 0)
          first = fmt::format("meter {} read {:g} lx for {:g} lx at {:.3f} s", meter, each.lux, wanted_lx,
                              to_seconds(each.when - at_ms(0)));
      }
    }
    const std::uint64_t held_up = line.far.answers_held_up();
    if (wrong <= held_up) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << wrong << " wrong readings, " << held_up << " answers held up; " << first;
  };
  ASSERT_TRUE(line.all_at(1.0)) << line.health("the-bus").detail;
  line.readings.clear();
  const auto [fault, value] = GetParam();
  line.far.faults().set("the-bus", fault, true, value);
  line.run(1.5, 1.0);
  EXPECT_TRUE(no_wrong_reading()) << "while it lasted";
  EXPECT_LT(line.longest_cycle, 2 * line.driver->bounds().write + milliseconds(250));
  line.far.faults().set("the-bus", fault, false);
  const auto well = [&] {
    const std::vector<Health> all = line.driver->health(line.now());
    return std::all_of(all.begin(), all.end(), [](const Health& device) { return device.life == Life::active; });
  };
  const auto until_well = [&] {
    for (const Time end = line.now() + from_seconds(4.5); line.now() < end && !well();) line.cycle(1.0);
  };
  until_well();
  const std::uint64_t held_up = line.far.answers_held_up();
  line.run(0.4, 1.0);
  // An answer that the machine holds up beyond the timeout is one more fault, which must clear as well.
  if (line.far.answers_held_up() > held_up) until_well();
  EXPECT_TRUE(no_wrong_reading()) << "afterwards";
  for (const char* device : {"the-bus", "dimmer", "a", "b", "c"}) {
    EXPECT_EQ(line.health(device).life, Life::active) << device << ": " << line.health(device).detail;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Each, LineFault,
    ::testing::Values(std::pair{sim::FaultKind::silent, 1.0}, std::pair{sim::FaultKind::slow, 100.0},
                      std::pair{sim::FaultKind::slow, 300.0}, std::pair{sim::FaultKind::checksum, 1.0},
                      std::pair{sim::FaultKind::truncated, 2.0}, std::pair{sim::FaultKind::gap, 100.0},
                      std::pair{sim::FaultKind::gap, 350.0}, std::pair{sim::FaultKind::noise, 2.0},
                      std::pair{sim::FaultKind::wrong_unit, 1.0}, std::pair{sim::FaultKind::wrong_function, 1.0},
                      std::pair{sim::FaultKind::exception, 1.0}, std::pair{sim::FaultKind::exception, 2.0},
                      std::pair{sim::FaultKind::exception, 3.0}, std::pair{sim::FaultKind::exception, 4.0},
                      std::pair{sim::FaultKind::exception, 5.0}, std::pair{sim::FaultKind::exception, 6.0},
                      std::pair{sim::FaultKind::lost, 0.3}),
    [](const auto& which) {
      return std::string(sim::name_of(which.param.first)) + "_" +
             std::to_string(static_cast<int>(which.param.second * 10));
    });

TEST(ModbusRtuLine, ReadsThroughNoiseAndPausesWithoutAFault) {
  for (const auto& [fault, value] : {std::pair{sim::FaultKind::noise, 5.0}, std::pair{sim::FaultKind::gap, 60.0}}) {
    // A driver that takes such a pause for a fault does so in every attempt. A machine that held up the driver, but not
    // its far end, does not.
    std::uint64_t fewest_errors = 1;
    std::string detail;
    for (int attempt = 0; attempt < 4 && fewest_errors > 0; ++attempt) {
      RealLine line(three_meters());
      line.far.faults().set("the-bus", fault, true, value);
      ASSERT_TRUE(line.run_until_read(6, 0.5)) << name_of(fault) << ": " << line.health("the-bus").detail;
      const std::uint64_t errors = line.health("the-bus").errors;
      fewest_errors = errors - std::min<std::uint64_t>(errors, line.far.answers_held_up());
      detail = line.health("the-bus").detail;
    }
    EXPECT_EQ(fewest_errors, 0u) << name_of(fault) << ": " << detail;
  }
}

TEST(ModbusRtuLine, RepeatsASpoiledRequestAtOnce) {
  Rig rig = line_rig();
  add_meter(rig, "a", 1, 2);
  // A driver that repeats nothing tells of the first spoiled answer in every attempt. One that the machine held up beyond
  // the time for a repetition does not.
  std::uint64_t most_sent = 0;
  for (int attempt = 0; attempt < 4 && most_sent < 2; ++attempt) {
    RealLine line(rig);
    line.cycle(0);
    line.far.faults().set("the-bus", sim::FaultKind::checksum, true);
    const std::uint64_t before = line.health("the-bus").sent;
    // The bound only ends a test that would hang.
    for (const Time end = line.now() + from_seconds(60); line.now() < end && line.health("a").detail.empty();)
      line.cycle(0);
    most_sent = std::max(most_sent, line.health("the-bus").sent - before);
    EXPECT_EQ(line.health("a").detail, "protocol: unit 1: garbled answer: an answer with a wrong checksum");
  }
  EXPECT_EQ(most_sent, 2u) << "the request and one repetition, by the time that a person is told";
}

TEST(ModbusRtuLine, ReportsTheRemedyForAMissingAdapter) {
  Rig rig = line_rig();
  add_modbus(rig, "dimmer", 1, 0);
  const auto driver = find_driver("modbus_rtu")->make(rig, 0, std::nullopt);
  ASSERT_TRUE(driver->activate(at_ms(0)));
  const Health bus = driver->health(at_ms(0)).at(0);
  EXPECT_EQ(bus.life, Life::faulted);
  EXPECT_EQ(bus.detail,
            "network: opening /dev/luxrig-no-such-port: No such file or directory: plug the adapter in, or correct "
            "device (names in /dev/serial/by-id stay)");
}

TEST(ModbusRtuLine, ReportsAPortThatRejectsItsSettings) {
  Rig rig = line_rig();
  add_modbus(rig, "dimmer", 1, 0);
  const FarEnd far(rig);
  rig.buses[0].options["device"] = {far.redirect().path, {}};
  const auto driver = find_driver("modbus_rtu")->make(rig, 0, std::nullopt);  // 8E1, which no pseudo terminal has
  ASSERT_TRUE(driver->activate(at_ms(0)));
  const Health bus = driver->health(at_ms(0)).at(0);
  EXPECT_EQ(bus.life, Life::faulted);
  EXPECT_NE(bus.detail.find("it does not take 19200 baud, parity even, 1 stop bit(s): choose others"),
            std::string::npos)
      << bus.detail;
  rig.buses[0].options["parity"] = {std::string("none"), {}};
  rig.buses[0].options["rs485"] = {true, {}};  // a pseudo terminal cannot do this: no fault
  const auto plain = find_driver("modbus_rtu")->make(rig, 0, std::nullopt);
  ASSERT_TRUE(plain->activate(at_ms(0)));
  EXPECT_EQ(plain->health(at_ms(0)).at(0).life, Life::active) << plain->health(at_ms(0)).at(0).detail;
}

TEST(ModbusRtuLine, ResumesWhenTheAdapterIsPluggedBackIn) {
  RealLine line(three_meters());
  ASSERT_TRUE(line.run_until_read(0, 0.25)) << line.health("the-bus").detail;
  line.far.faults().set("the-bus", sim::FaultKind::dead, true);
  line.run(1.0, 0.5);
  EXPECT_EQ(line.health("the-bus").life, Life::faulted);
  EXPECT_NE(line.health("the-bus").detail.find("plug the adapter in"), std::string::npos);
  line.far.faults().clear();
  // At any of these times: a busy machine may hold up the very last answer.
  bool is_back = false, is_lit = false;
  for (const Time end = line.now() + from_seconds(2.0); line.now() < end;) {
    line.cycle(0.75);
    is_back |= line.health("the-bus").life == Life::active;
    is_lit |= line.all_at(0.75);
  }
  EXPECT_TRUE(is_back) << line.health("the-bus").detail;
  EXPECT_TRUE(is_lit);
}

/// A rig file with products from rigs/register-maps.
Rig product_rig(const std::string& driver, const std::string& products) {
  const std::string text = R"(
[rig]
name = "products"
[[luminaire]]
name = "bulb"
model = "isotropic"
lumens = 1000
[[bus]]
name = "the-bus"
driver = ")" + driver + "\"\n" +
                           (driver == "modbus_rtu" ? "device = \"/dev/luxrig-no-such-port\"\nbaud = 9600\n"
                                                   : "host = \"127.0.0.1\"\n") +
                           products;
  auto rig = parse_rig(text, "products.toml", test::source_folder() / "rigs/gallery");
  if (!rig) {
    for (const Problem& problem : rig.error()) ADD_FAILURE() << problem.text();
    return {};
  }
  return *rig;
}

std::string fixtures(const std::string& map, int unit, int count) {
  std::string text;
  for (int i = 1; i <= count; ++i) {
    text += "[[fixture]]\nname = \"" + map.substr(0, 4) + "-" + std::to_string(unit) + "-" + std::to_string(i) +
            "\"\nluminaire = \"bulb\"\nposition_m = [0, 0, 3]\nbus = \"the-bus\"\nunit = " + std::to_string(unit) +
            "\nregister_map = \"../register-maps/" + map + ".toml\"\nchannel = " + std::to_string(i) + "\n";
  }
  return text;
}

std::string luxmeter(int unit) {
  return "[[luxmeter]]\nname = \"meter-" + std::to_string(unit) +
         "\"\nposition_m = [0, 0, 1]\nbus = \"the-bus\"\nunit = " + std::to_string(unit) +
         "\nregister_map = \"../register-maps/dfrobot-sen0644.toml\"\n";
}

TEST(ModbusProducts, EightOutputsTakeOneRequestAndTheMeterReadsThem) {
  RealLine line(product_rig("modbus_rtu", fixtures("waveshare-analog-output-8ch-b", 1, 8) + luxmeter(2)));
  ASSERT_EQ(line.rig.fixtures.size(), 8u);
  EXPECT_EQ(line.rig.luxmeters[0].range_lx, 200000);
  ASSERT_TRUE(line.write(0.25)) << line.health("the-bus").detail;
  EXPECT_EQ(line.health("the-bus").sent, 1u);
  line.run(1.0, 0.25);
  EXPECT_TRUE(line.all_at(0.25));
  ASSERT_FALSE(line.readings[0].empty());
  EXPECT_NEAR(line.readings[0].back().lux, 200, 0.01);  // eight times a quarter of 100 lx
  EXPECT_LE(line.health("the-bus").errors, line.far.answers_held_up()) << line.health("the-bus").detail;
}

TEST(ModbusProducts, TheDimmersFadeTimeIsSetUpBeforeItsFirstLevel) {
  RealLine line(product_rig("modbus_rtu", fixtures("wirenboard-mrgbw-d", 1, 4)));
  ASSERT_TRUE(line.write(0.5)) << line.health("the-bus").detail;
  EXPECT_EQ(line.health("the-bus").sent, 2u) << "the fade time, and the four levels at once";
  EXPECT_TRUE(line.all_at(128.0 / 255));
}

class Watchdog : public ::testing::TestWithParam<const char*> {};

TEST_P(Watchdog, IsArmedAndPutsTheLightOutWhenWritesStop) {
  RealLine line(product_rig(GetParam(), fixtures("wago-750-559", 1, 4)));
  line.run(2.5, 0.5);
  EXPECT_TRUE(line.all_at(0.5)) << "refreshing keeps it alight: " << line.health("the-bus").detail;
  std::this_thread::sleep_for(milliseconds(1500));
  EXPECT_TRUE(line.all_at(0.5));
  std::this_thread::sleep_for(milliseconds(1000));
  EXPECT_TRUE(line.all_at(0)) << "2 s after the last write";
  EXPECT_TRUE(line.run_until_read(0, 0.75)) << line.health("the-bus").detail;
}

TEST_P(Watchdog, IsArmedAgainAfterAPowerLoss) {
  RealLine line(product_rig(GetParam(), fixtures("wago-750-559", 1, 2)));
  ASSERT_TRUE(line.run_until_read(0, 0.5)) << line.health("the-bus").detail;
  EXPECT_LE(line.health("the-bus").errors, line.far.answers_held_up()) << line.health("the-bus").detail;
  line.far.faults().set(line.rig.fixtures[0].name, sim::FaultKind::unpowered, true);
  line.run(1.5, 0.5);
  EXPECT_TRUE(line.all_at(0));
  EXPECT_EQ(line.health(line.rig.fixtures[0].name).life, Life::faulted);
  line.far.faults().clear();
  EXPECT_TRUE(line.run_until_read(0, 0.5)) << line.health("the-bus").detail;
  std::this_thread::sleep_for(milliseconds(2500));
  EXPECT_TRUE(line.all_at(0)) << "its watchdog was armed anew";
}

INSTANTIATE_TEST_SUITE_P(Over, Watchdog, ::testing::Values("modbus_rtu", "modbus_tcp"),
                         [](const auto& which) { return std::string(which.param); });

TEST(ModbusProducts, KeepTheGapThatADeviceNeeds) {
  Rig rig = product_rig("modbus_rtu", luxmeter(1) + fixtures("waveshare-analog-output-8ch-b", 2, 1));
  auto slow = std::make_shared<RegisterMap>(*rig.luxmeters[0].patch.map);
  slow->shortest_gap = milliseconds(60);
  rig.luxmeters[0].patch.map = slow;
  rig.luxmeters.push_back(rig.luxmeters[0]);
  rig.luxmeters[1].name = "other register";
  rig.luxmeters[1].patch.first_register = 0x46;  // of the same unit: two requests in a row
  rig.luxmeters[1].patch.registers = 1;
  RealLine line(rig);
  ASSERT_TRUE(line.run_until_read(10, 0.5)) << line.health("the-bus").detail;
  EXPECT_LE(line.health("the-bus").errors, line.far.answers_held_up()) << line.health("the-bus").detail;
}

TEST(ModbusRtuLine, ADeadUnitOfEightDelaysTheOthersByOneTimeoutAtMost) {
  constexpr Duration kLatest = milliseconds(200 + 200 + 150);
  constexpr double kMinRounds = 25;  // of 30
  Rig rig = line_rig();
  for (int unit = 1; unit <= 8; ++unit) add_meter(rig, "meter-" + std::to_string(unit), unit, 2);
  RealLine line(rig);
  line.run(1.0, 0);
  line.far.faults().set("meter-4", sim::FaultKind::silent, true);
  line.run(1.0, 0);  // found out
  // The dead unit is asked every 6 s, so a driver that waits twice for it is late in each of these periods. A machine
  // that is held up for some tenths of a second now and then is not.
  Duration longest = Duration::max();
  double max_rounds = 0;
  for (int attempt = 0; attempt < 8 && (longest >= kLatest || max_rounds < kMinRounds); ++attempt) {
    line.readings.clear();
    line.run(6.0, 0);
    Duration longest_here{};
    double fewest_rounds = 1e9;
    for (std::size_t meter = 0; meter < 8; ++meter) {
      if (meter == 3) continue;
      const auto& seen = line.readings[meter];
      fewest_rounds = std::min(fewest_rounds, static_cast<double>(seen.size()));
      for (std::size_t i = 1; i < seen.size(); ++i) {
        longest_here = std::max(longest_here, seen[i].when - seen[i - 1].when);
      }
    }
    EXPECT_TRUE(line.readings[3].empty());
    longest = std::min(longest, longest_here);
    max_rounds = std::max(max_rounds, fewest_rounds);
  }
  EXPECT_GE(max_rounds, kMinRounds) << "of 30";
  EXPECT_LT(longest, kLatest) << "a round, a timeout, and the machine";
  RecordProperty("longest_ms", static_cast<int>(to_seconds(longest) * 1000));
  RecordProperty("rounds", static_cast<int>(max_rounds));
  line.far.faults().clear();
  line.run(3.0, 0);
  EXPECT_FALSE(line.readings[3].empty());
}

}  // namespace
}  // namespace luxrig
