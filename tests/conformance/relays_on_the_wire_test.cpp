/// Lamps behind relays (coils), and the bits by which a product reports that a lamp has burnt out (discrete inputs):
/// the driver against simulated units, over TCP and on a serial line.

#include <gtest/gtest.h>

#include "core/rig/register_map/register_map_file.h"
#include "drivers/registry.h"
#include "tests/conformance/far_end.h"
#include "tests/drivers/test_rig.h"

namespace luxrig {
namespace {

using std::chrono::milliseconds;

constexpr const char* kRelayMap = R"(
[device]
name = "relays"
source = "made for this test"
answer_ms = 50
LARGEST
[[register]]
name = "relay"
what = "level"
kind = "coil"
address = 16
count = 3
[[register]]
name = "lamp-failure"
what = "failure"
kind = "discrete"
address = 100
count = 3
[[register]]
name = "dimmer"
what = "level"
address = 16
range = [0, 255]
[[register]]
name = "too-hot"
what = "failure"
kind = "coil"
access = "read"
address = 40
)";

/// Three relays and a dimmer of unit 5.
Rig relay_rig(const std::string& driver, const std::string& largest) {
  Rig rig = driver == "modbus_tcp" ? rig_with(bus_of(driver, {{"host", std::string("127.0.0.1")}}))
                                   : rig_with(bus_of(driver, {{"device", std::string("/dev/luxrig-no-such-port")}}));
  std::string text = kRelayMap;
  text.replace(text.find("LARGEST"), 7, largest);
  const auto map = parse_register_map(text, "relays.toml");
  if (!map) throw std::runtime_error(map.error().front().text());
  const auto shared = std::make_shared<const RegisterMap>(*map);
  for (int i = 0; i < 3; ++i) {
    auto& patch = std::get<ModbusPatch>(add_modbus(rig, "lamp-" + std::to_string(i + 1), 5, 16 + i, 1).patch);
    patch.coil = true;
    patch.map = shared;
  }
  std::get<ModbusPatch>(add_modbus(rig, "dimmed", 5, 16, 255).patch).map = shared;
  return rig;
}

struct RelayBench {
  explicit RelayBench(const std::string& driver_name, const std::string& largest = "")
      : rig(relay_rig(driver_name, largest)), far(rig) {
    EXPECT_TRUE(check_buses(rig).empty());
    driver = find_driver(driver_name)->make(rig, 0, far.redirect());
    EXPECT_TRUE(driver->activate(now));
  }
  void cycles(int count, const std::vector<double>& drives) {
    std::vector<LevelCommand> commands;
    for (std::size_t i = 0; i < drives.size(); ++i) commands.push_back({i, drives[i]});
    for (int i = 0; i < count; ++i) {
      far.step_to(now);
      last = driver->level_output()->write(now, commands);
      far.step_to(now);
      now += milliseconds(100);
    }
  }
  [[nodiscard]] std::string detail_of(std::size_t fixture) const {
    for (const Health& health : driver->health(now))
      if (health.device == rig.fixtures[fixture].name) return health.detail;
    return "none";
  }
  Rig rig;
  FarEnd far;
  std::unique_ptr<Driver> driver;
  Time now = Time{} + std::chrono::seconds(1);
  Result<void> last;
};

class RelaysOnTheWire : public ::testing::TestWithParam<const char*> {};

TEST_P(RelaysOnTheWire, SwitchTheirLampsBesideADimmer) {
  RelayBench bench(GetParam());
  bench.cycles(4, {1, 0, 1, 0.5});
  EXPECT_TRUE(bench.last) << bench.last.error().detail;
  std::vector<double> drives = bench.far.drives();
  EXPECT_EQ(drives[0], 1);
  EXPECT_EQ(drives[1], 0);
  EXPECT_EQ(drives[2], 1);
  EXPECT_NEAR(drives[3], 0.5, 0.003);
  bench.cycles(3, {0.45, 0.45, 0.3, 1});
  drives = bench.far.drives();
  EXPECT_EQ(drives[0], 1) << "it was on";
  EXPECT_EQ(drives[1], 0) << "it was off";
  EXPECT_EQ(drives[2], 0);
  EXPECT_EQ(drives[3], 1);
}

TEST_P(RelaysOnTheWire, AreSwitchedOneByOneWhereAProductTakesOneAtATime) {
  RelayBench bench(GetParam(), "largest_write = 1");
  bench.cycles(4, {1, 1, 1, 1});
  EXPECT_TRUE(bench.last) << bench.last.error().detail;
  for (const double drive : bench.far.drives()) EXPECT_EQ(drive, 1);
  EXPECT_EQ(bench.driver->health(bench.now).at(0).errors, 0u);
}

// The simulated unit sets every failure bit of a burnt-out lamp, its own and the common one.
TEST_P(RelaysOnTheWire, ReportABurntOutLampAndItsRecovery) {
  RelayBench bench(GetParam());
  bench.cycles(15, {1, 1, 1, 1});
  for (std::size_t f = 0; f < 4; ++f) EXPECT_EQ(bench.detail_of(f), "");
  bench.far.faults().set("lamp-2", sim::FaultKind::lamp_failure, true);
  bench.cycles(13, {1, 1, 1, 1});
  EXPECT_EQ(bench.far.drives()[1], 0) << "it gives no light";
  EXPECT_EQ(bench.detail_of(1), "reports too-hot, lamp-failure2");
  EXPECT_EQ(bench.detail_of(0), "reports too-hot") << "that is of all";
  EXPECT_EQ(bench.detail_of(3), "reports too-hot");
  bench.far.faults().clear();
  bench.cycles(13, {1, 1, 1, 1});
  for (std::size_t f = 0; f < 4; ++f) EXPECT_EQ(bench.detail_of(f), "");
  EXPECT_EQ(bench.far.drives()[1], 1);
}

TEST_P(RelaysOnTheWire, RecoverFromSilenceWithTheCurrentLevels) {
  RelayBench bench(GetParam());
  bench.cycles(5, {1, 0, 0, 0});
  bench.far.faults().set("lamp-1", sim::FaultKind::unpowered, true);
  bench.cycles(10, {1, 1, 0, 0});
  EXPECT_FALSE(bench.last);
  EXPECT_EQ(bench.far.drives()[0], 0) << "without power it opens";
  bench.far.faults().clear();
  for (int i = 0; i < 100 && bench.far.drives() != std::vector<double>({0, 1, 1, 0}); ++i)
    bench.cycles(1, {0, 1, 1, 0});
  EXPECT_EQ(bench.far.drives(), std::vector<double>({0, 1, 1, 0}));
}

INSTANTIATE_TEST_SUITE_P(Links, RelaysOnTheWire, ::testing::Values("modbus_tcp", "modbus_rtu"),
                         [](const auto& which) { return std::string(which.param); });

}  // namespace
}  // namespace luxrig
