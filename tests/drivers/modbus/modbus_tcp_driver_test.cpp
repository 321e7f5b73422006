#include "drivers/modbus/modbus_tcp_driver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <map>
#include <thread>

#include "tests/drivers/hex.h"
#include "tests/drivers/modbus/scripted_peer.h"
#include "tests/drivers/test_rig.h"
#include "tests/sanitized.h"

namespace luxrig {
namespace {

using Bytes = std::vector<std::uint8_t>;
using std::chrono::milliseconds;

/// A faultless server: writes are echoed, every register pair reads 0x0007A120.
Bytes right_answer(const Bytes& request) {
  Bytes answer(request.begin(), request.begin() + 8);
  if (request[7] == 3 || request[7] == 4) {
    const int count = request[11];
    answer.push_back(static_cast<std::uint8_t>(2 * count));
    for (int i = 0; i < count; ++i) {
      for (const std::uint8_t byte : i % 2 == 0 ? from_hex("0007") : from_hex("a120")) answer.push_back(byte);
    }
  } else {
    answer.insert(answer.end(), request.begin() + 8, request.begin() + 12);
  }
  answer[4] = 0;
  answer[5] = static_cast<std::uint8_t>(answer.size() - 6);
  return answer;
}
ScriptedAnswer well(const Bytes& request) { return {right_answer(request)}; }
ScriptedAnswer silent(const Bytes&) { return {}; }
Bytes exception_answer(const Bytes& request, int code) {
  Bytes answer(request.begin(), request.begin() + 9);
  answer[5] = 3;
  answer[7] = static_cast<std::uint8_t>(answer[7] | 0x80);
  answer[8] = static_cast<std::uint8_t>(code);
  return answer;
}

struct ModbusBench {
  explicit ModbusBench(ScriptedPeer::Script script, std::int64_t timeout_ms = 60) : peer(std::move(script)) {
    rig = rig_with(bus_of("modbus_tcp", {{"host", std::string("127.0.0.1")},
                                         {"port", std::int64_t{peer.port()}},
                                         {"response_timeout_ms", timeout_ms}}));
  }
  void start() {
    ASSERT_TRUE(check_modbus_tcp(rig, 0).empty());
    driver = make_modbus_tcp(rig, 0, std::nullopt);
    ASSERT_TRUE(driver->activate(at_ms(0)));
  }
  Result<void> write(double ms, double drive) {
    std::vector<LevelCommand> commands;
    for (std::size_t i = 0; i < rig.fixtures.size(); ++i) commands.push_back({i, drive});
    return driver->level_output()->write(at_ms(ms), commands);
  }
  Result<std::vector<LuxReading>> read(double ms) { return driver->lux_reader()->read(at_ms(ms)); }
  [[nodiscard]] Health health(const std::string& device) const {
    for (const Health& health : driver->health(at_ms(0))) {
      if (health.device == device) return health;
    }
    ADD_FAILURE() << "no device " << device;
    return {};
  }

  ScriptedPeer peer;
  Rig rig;
  std::unique_ptr<Driver> driver;
};

TEST(ModbusTcpDriver, WritesNeighboursTogetherAndLoneRegistersAlone) {
  ModbusBench bench(well);
  add_modbus(bench.rig, "b", 10, 1);
  add_modbus(bench.rig, "a", 10, 0);
  add_modbus(bench.rig, "c", 10, 5, 255);
  add_modbus(bench.rig, "d", 11, 2);
  bench.start();
  const LevelCommand commands[] = {{0, 0.2}, {1, 0.1}, {2, 1.0}, {3, 0.5}};
  ASSERT_TRUE(bench.driver->level_output()->write(at_ms(0), commands));
  const auto requests = bench.peer.requests();
  ASSERT_EQ(requests.size(), 3u);
  EXPECT_EQ(requests[0], from_hex("0001 0000 000b 0a 10 0000 0002 04 0064 00c8"));
  EXPECT_EQ(requests[1], from_hex("0002 0000 0006 0a 06 0005 00ff"));
  EXPECT_EQ(requests[2], from_hex("0003 0000 0006 0b 06 0002 01f4"));
}

TEST(ModbusTcpDriver, RewritesOnlyChangedOrExpiringRegisters) {
  ModbusBench bench(well);
  add_modbus(bench.rig, "a", 1, 0);
  bench.start();
  ASSERT_TRUE(bench.write(0, 0.5));
  ASSERT_TRUE(bench.write(100, 0.5));
  EXPECT_EQ(bench.peer.requests().size(), 1u);
  ASSERT_TRUE(bench.write(200, 0.6));
  EXPECT_EQ(bench.peer.requests().size(), 2u);
  ASSERT_TRUE(bench.write(590, 0.6));
  EXPECT_EQ(bench.peer.requests().size(), 2u);
  ASSERT_TRUE(bench.write(600, 0.6));  // 400 ms after the last write
  EXPECT_EQ(bench.peer.requests().size(), 3u);
}

TEST(ModbusTcpDriver, WritesARegisterAtMostTwentyTimesASecond) {
  ModbusBench bench(well);
  add_modbus(bench.rig, "a", 1, 0);
  bench.start();
  for (int ms = 0; ms < 1000; ms += 5) ASSERT_TRUE(bench.write(ms, ms / 1000.0));
  EXPECT_EQ(bench.peer.requests().size(), 20u);
}

TEST(ModbusTcpDriver, ReadsMetersOfBothKindsAndWordOrders) {
  ModbusBench bench([](const Bytes& request) {
    ScriptedAnswer answer{right_answer(request)};
    if (request[6] == 2)
      std::swap_ranges(answer.bytes.begin() + 9, answer.bytes.begin() + 11, answer.bytes.begin() + 11);
    return answer;
  });
  add_meter(bench.rig, "plain", 1, 2);
  Luxmeter& swapped = add_meter(bench.rig, "swapped", 2, 7);
  swapped.patch.low_word_first = true;
  swapped.patch.input_registers = true;
  bench.start();
  const auto readings = bench.read(0);
  ASSERT_TRUE(readings);
  ASSERT_EQ(readings->size(), 2u);
  EXPECT_DOUBLE_EQ(readings->at(0).lux, 500.0);
  EXPECT_DOUBLE_EQ(readings->at(1).lux, 500.0);
  EXPECT_EQ(readings->at(1).luxmeter, 1u);
  EXPECT_EQ(readings->at(1).taken, at_ms(0));
  const auto requests = bench.peer.requests();
  EXPECT_EQ(requests.at(0), from_hex("0001 0000 0006 01 03 0002 0002"));
  EXPECT_EQ(requests.at(1), from_hex("0002 0000 0006 02 04 0007 0002"));
  EXPECT_TRUE(bench.read(100)->empty());  // polled every 200 ms
  EXPECT_EQ(bench.read(200)->size(), 2u);
}

TEST(ModbusTcpDriver, ReturnsWithinItsBoundFromEveryKindOfBadPeer) {
  const std::map<std::string, ScriptedPeer::Script> peers = {
      {"silent", silent},
      {"trickling",
       [](const Bytes& request) {
         return ScriptedAnswer{right_answer(request), milliseconds(0), milliseconds(25)};
       }},
      {"closing half-way",
       [](const Bytes& request) {
         Bytes half = right_answer(request);
         half.resize(half.size() / 2);
         return ScriptedAnswer{half, milliseconds(0), milliseconds(0), true};
       }},
      {"stopping half-way",
       [](const Bytes& request) {
         Bytes half = right_answer(request);
         half.pop_back();
         return ScriptedAnswer{half};
       }},
      {"closing",
       [](const Bytes&) {
         return ScriptedAnswer{{}, milliseconds(0), milliseconds(0), true};
       }},
  };
  for (const auto& [name, script] : peers) {
    // A driver that waits too long does so every time; a machine is busy only for a moment.
    Duration bound{}, least = Duration::max();
    for (int attempt = 0; attempt < 3 && least >= bound; ++attempt) {
      ModbusBench bench(script);
      for (int unit = 1; unit <= 4; ++unit) add_modbus(bench.rig, "dimmer-" + std::to_string(unit), unit, 0);
      for (int unit = 5; unit <= 8; ++unit) add_meter(bench.rig, "meter-" + std::to_string(unit), unit, 2);
      bench.start();
      bound = bench.driver->bounds().write + milliseconds(250);  // a busy test machine
      Duration slowest{};
      const auto since = [](auto start) {
        return std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now() - start);
      };
      for (int cycle = 0; cycle < 4; ++cycle) {
        auto start = std::chrono::steady_clock::now();
        EXPECT_FALSE(bench.write(cycle * 300, 0.5)) << name;
        slowest = std::max(slowest, since(start));
        start = std::chrono::steady_clock::now();
        const auto readings = bench.read(cycle * 300);
        slowest = std::max(slowest, since(start));
        EXPECT_TRUE(!readings || readings->empty()) << name;
      }
      EXPECT_EQ(bench.health("the-bus").life, Life::faulted) << name;
      EXPECT_NE(bench.health("the-bus").detail, "") << name;
      least = std::min(least, slowest);
    }
    EXPECT_LT(least, bound) << name;
  }
}

TEST(ModbusTcpDriver, TreatsEveryGarbledAnswerAsAProtocolFaultAndResumes) {
  const std::map<std::string, std::function<void(Bytes&)>> spoil = {
      {"wrong transaction", [](Bytes& b) { b[1] = static_cast<std::uint8_t>(b[1] + 1); }},
      {"wrong protocol", [](Bytes& b) { b[3] = 1; }},
      {"length too small", [](Bytes& b) { b[5] = static_cast<std::uint8_t>(b[5] - 1); }},
      {"length too large", [](Bytes& b) { b[5] = static_cast<std::uint8_t>(b[5] + 1); }},
      {"wrong unit", [](Bytes& b) { b[6] = 99; }},
      {"wrong function", [](Bytes& b) { b[7] = 4; }},
      {"unknown function", [](Bytes& b) { b[7] = 0x2B; }},
      {"wrong byte count", [](Bytes& b) { b[8] = 2; }},
      {"extra bytes", [](Bytes& b) { b.push_back(0); }},
      {"too many registers",
       [](Bytes& b) {
         b[8] = 6;
         b[5] = 9;
         b.insert(b.end(), {0, 0});
       }},
  };
  for (const auto& [name, change] : spoil) {
    ModbusBench bench([change = change](const Bytes& request) {
      ScriptedAnswer answer{right_answer(request)};
      change(answer.bytes);
      return answer;
    });
    add_meter(bench.rig, "meter", 1, 2);
    bench.start();
    const auto readings = bench.read(0);
    ASSERT_FALSE(readings) << name;
    EXPECT_EQ(readings.error().cause, Cause::protocol) << name << ": " << readings.error().detail;
    EXPECT_EQ(bench.health("meter").life, Life::faulted) << name;
    bench.peer.set_script(well);
    const auto again = bench.read(500);
    ASSERT_TRUE(again) << name << ": " << again.error().detail;
    EXPECT_EQ(again->size(), 1u) << name;
    EXPECT_EQ(bench.health("the-bus").life, Life::active) << name;
    EXPECT_EQ(bench.health("meter").life, Life::active) << name;
    EXPECT_EQ(bench.peer.connections(), 2) << name;
  }
}

TEST(ModbusTcpDriver, SkipsASilentUnitForASecondSoThatOthersKeepTheirPace) {
  ModbusBench bench([](const Bytes& request) { return request[6] == 2 ? ScriptedAnswer{} : well(request); });
  for (int unit = 1; unit <= 3; ++unit) add_meter(bench.rig, "meter-" + std::to_string(unit), unit, 2);
  bench.start();
  std::map<std::size_t, int> readings;
  for (int ms = 0; ms < 4000; ms += 200) {
    const auto got = bench.read(ms);
    ASSERT_TRUE(got);
    for (const LuxReading& reading : *got) ++readings[reading.luxmeter];
  }
  EXPECT_GE(readings[0], 19);
  EXPECT_GE(readings[2], 19);
  EXPECT_EQ(readings[1], 0);
  int asked = 0;
  for (const Bytes& request : bench.peer.requests()) asked += request[6] == 2 ? 1 : 0;
  EXPECT_LE(asked, 5);
  EXPECT_EQ(bench.health("the-bus").life, Life::active);
  EXPECT_EQ(bench.health("meter-2").life, Life::faulted);
  EXPECT_EQ(bench.health("meter-2").detail, "timeout: unit 2: no answer within 60 ms");
  EXPECT_EQ(bench.health("meter-1").life, Life::active);

  bench.peer.set_script(well);
  EXPECT_EQ(bench.read(5400)->size(), 3u);
  EXPECT_EQ(bench.health("meter-2").life, Life::active);
  EXPECT_EQ(bench.peer.connections(), 1);
}

TEST(ModbusTcpDriver, SkipsALateAnswerToAnEarlierRequest) {
  // Unit 2 answers after its timeout, with a value that must not be taken for unit 1's.
  if (test::kThreadSanitized) GTEST_SKIP() << "counts answers within some ms, which ThreadSanitizer makes longer";
  ModbusBench bench([](const Bytes& request) {
    ScriptedAnswer answer{right_answer(request)};
    if (request[6] == 2) {
      answer.bytes[9] = 0x00;
      answer.bytes[10] = 0x01;
      answer.before = milliseconds(90);
    }
    return answer;
  });
  add_meter(bench.rig, "slow", 2, 2);
  add_meter(bench.rig, "quick", 1, 2);
  bench.start();
  (void)bench.read(0);
  int wrong = 0, right = 0;
  for (int ms = 200; ms < 1000; ms += 200) {
    const auto got = bench.read(ms);
    if (!got) continue;
    for (const LuxReading& reading : *got) {
      if (reading.luxmeter == 1) (reading.lux == 500.0 ? right : wrong) += 1;
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(right, 3);
  EXPECT_EQ(bench.peer.connections(), 1);
}

TEST(ModbusTcpDriver, NamesAnExceptionAndContinuesWithTheOthers) {
  ModbusBench bench([](const Bytes& request) {
    return request[6] == 1 ? ScriptedAnswer{exception_answer(request, 4)} : well(request);
  });
  add_modbus(bench.rig, "broken", 1, 0);
  add_modbus(bench.rig, "good", 2, 0);
  bench.start();
  auto result = bench.write(0, 0.5);
  // On a busy machine a call's time may run out before it sends its request.
  for (int at_ms = 100; result && at_ms <= 1000; at_ms += 100) result = bench.write(at_ms, 0.5);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().cause, Cause::refused);
  EXPECT_EQ(result.error().device, "broken");
  EXPECT_EQ(bench.health("broken").detail, "refused: unit 1 register 0: device failure (4)");
  EXPECT_EQ(bench.health("good").life, Life::active);
  EXPECT_EQ(bench.health("the-bus").life, Life::active);
  EXPECT_EQ(bench.peer.connections(), 1);
}

TEST(ModbusTcpDriver, WritesSinglyToADeviceWithoutFunction16) {
  ModbusBench bench([](const Bytes& request) {
    return request[7] == 16 ? ScriptedAnswer{exception_answer(request, 1)} : well(request);
  });
  add_modbus(bench.rig, "a", 1, 0);
  add_modbus(bench.rig, "b", 1, 1);
  bench.start();
  EXPECT_TRUE(bench.write(0, 0.5));
  EXPECT_EQ(bench.peer.requests().size(), 3u);  // 16, then 6 and 6
  EXPECT_TRUE(bench.write(100, 0.6));
  EXPECT_EQ(bench.peer.requests().size(), 5u);
  EXPECT_EQ(bench.health("a").life, Life::active);
}

TEST(ModbusTcpDriver, ReconnectsAtOnceAfterThePeerClosedAnIdleConnection) {
  bool close = true;
  ModbusBench bench([&close](const Bytes& request) {
    return ScriptedAnswer{right_answer(request), milliseconds(0), milliseconds(0), close};
  });
  add_meter(bench.rig, "meter", 1, 2);
  bench.start();
  EXPECT_EQ(bench.read(0)->size(), 1u);
  while (bench.peer.closed() == 0) std::this_thread::yield();
  const auto again = bench.read(200);
  ASSERT_TRUE(again) << again.error().detail;
  EXPECT_EQ(again->size(), 1u);
  EXPECT_EQ(bench.health("meter").errors, 0u);
}

TEST(ModbusTcpDriver, StartsFaultedWithoutAPeerAndConnectsByItselfWhenOneAppears) {
  int port = 0;
  {
    const ScriptedPeer gone(well);
    port = gone.port();
  }
  Rig rig = rig_with(bus_of("modbus_tcp", {{"host", std::string("127.0.0.1")}, {"port", std::int64_t{port}}}));
  add_modbus(rig, "dimmer", 1, 0);
  const auto driver = make_modbus_tcp(rig, 0, std::nullopt);
  ASSERT_TRUE(driver->activate(at_ms(0)));
  EXPECT_EQ(driver->health(at_ms(0)).at(0).life, Life::faulted);
  EXPECT_NE(driver->health(at_ms(0)).at(0).detail.find("Connection refused"), std::string::npos);
  const LevelCommand dim{0, 0.25};
  EXPECT_FALSE(driver->level_output()->write(at_ms(100), {&dim, 1}));
  const ScriptedPeer peer(well, port);
  const LevelCommand bright{0, 0.75};
  Time now = at_ms(200);
  while (!driver->level_output()->write(now, {&bright, 1}) && now < at_ms(2000)) now += milliseconds(100);
  EXPECT_LE(now, at_ms(1200));
  ASSERT_GE(peer.requests().size(), 1u);
  EXPECT_EQ(peer.requests()[0], from_hex("0001 0000 0006 01 06 0000 02ee"));  // 750: the current value goes first
  EXPECT_EQ(driver->health(now).at(0).life, Life::active);
}

TEST(ModbusTcpDriver, RejectsReadingsFarBeyondTheMetersRange) {
  ModbusBench bench([](const Bytes& request) {
    ScriptedAnswer answer{right_answer(request)};
    std::fill(answer.bytes.begin() + 9, answer.bytes.end(), std::uint8_t{0xFF});
    return answer;
  });
  add_meter(bench.rig, "meter", 1, 2);
  bench.start();
  const auto readings = bench.read(0);
  ASSERT_TRUE(readings);
  EXPECT_TRUE(readings->empty());
  EXPECT_EQ(bench.health("meter").detail, "protocol: reads 4294967.295 lx, but its range ends at 100000 lx");
  EXPECT_EQ(bench.health("the-bus").life, Life::active);
}

TEST(ModbusTcpDriver, SendsNothingForAnInvalidSetpoint) {
  ModbusBench bench(well);
  add_modbus(bench.rig, "a", 1, 0);
  bench.start();
  EXPECT_EQ(bench.write(0, std::numeric_limits<double>::quiet_NaN()).error().cause, Cause::invalid);
  EXPECT_EQ(bench.write(0, -0.1).error().cause, Cause::invalid);
  const LevelCommand other{7, 0.5};
  EXPECT_EQ(bench.driver->level_output()->write(at_ms(0), {&other, 1}).error().cause, Cause::invalid);
  EXPECT_TRUE(bench.peer.requests().empty());
}

TEST(ModbusTcpDriver, ReportsWhatAModbusBusCannotCarry) {
  Rig rig = rig_with(bus_of("modbus_tcp", {{"hots", std::string("10.0.0.1")}}));
  add_dmx(rig, "spot", 1, 1);
  add_modbus(rig, "dimmer", 256, 0);
  const auto problems = check_modbus_tcp(rig, 0);
  ASSERT_EQ(problems.size(), 4u);
  EXPECT_EQ(problems[0].mend, "did you mean \"host\"?");
  EXPECT_EQ(problems[1].text(),
            "a/rig.toml:7:1: bus \"the-bus\" lacks the option \"host\": write host = …, the Modbus TCP server: a "
            "device or a gateway");
  EXPECT_EQ(problems[2].line, 20);
  EXPECT_EQ(problems[3].mend, "choose a unit in 0…255");
  Rig named = rig_with(bus_of("modbus_tcp", {{"host", std::string("dimmer.local")}}));
  EXPECT_EQ(check_modbus_tcp(named, 0).size(), 1u);
}

}  // namespace
}  // namespace luxrig
