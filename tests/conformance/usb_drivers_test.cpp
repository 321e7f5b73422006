/// The USB drivers against the simulated widgets under a stepped clock: tests beyond the suite of every driver.

#include <gtest/gtest.h>

#include "drivers/dmx/enttec_pro/enttec_pro_driver.h"
#include "drivers/dmx/open_dmx/open_dmx_driver.h"
#include "drivers/dmx/udmx/udmx_driver.h"
#include "drivers/registry.h"
#include "sim/devices/usb/dmx_line.h"
#include "sim/devices/usb/enttec_widget.h"
#include "sim/devices/usb/udmx_widget.h"
#include "tests/conformance/model_channel.h"
#include "tests/drivers/test_rig.h"

namespace luxrig {
namespace {

using std::chrono::milliseconds;

/// Eight dimmers of one slot at 1…8, and a head with 16-bit values at 101.
Rig usb_rig(const std::string& driver, std::vector<std::pair<std::string, OptionValue>> options = {}) {
  Rig rig = rig_with(bus_of(driver, std::move(options)));
  for (int i = 1; i <= 8; ++i) add_dmx(rig, "dimmer-" + std::to_string(i), 1, i);
  add_head(rig, "head", 1, 101);
  return rig;
}

/// A driver at its cable. A cycle is 1/44 s plus the driver's waits.
struct Bench {
  using Make = std::unique_ptr<Driver> (*)(std::unique_ptr<UsbChannel>, const Rig&, std::size_t);
  Bench(sim::UsbDevice& device, const Rig& the_rig, Make make) : rig(the_rig), cable(device) {
    driver = make(std::make_unique<ModelChannel>(cable), rig, 0);
  }
  Result<void> cycle(double drive) {
    std::vector<LevelCommand> commands;
    for (std::size_t i = 0; i < rig.fixtures.size(); ++i) commands.push_back({i, drive});
    const Time start = cable.now;
    auto result = driver->level_output()->write(start, commands);
    longest = std::max(longest, cable.now - start);
    cable.now = std::max(cable.now, start + driver->bounds().write_period);
    return result;
  }
  void cycles(int count, double drive) {
    for (int i = 0; i < count; ++i) (void)cycle(drive);
  }
  [[nodiscard]] Health health() const { return driver->health(cable.now).at(0); }
  [[nodiscard]] int slot(int address) {
    const auto look = cable.device.line(cable.now);
    return look ? look->at(static_cast<std::size_t>(address - 1)) : -1;
  }
  /// Time until the bus has that life.
  Duration until(Life life, double drive) {
    const Time start = cable.now;
    while (health().life != life && cable.now < start + std::chrono::seconds(20)) (void)cycle(drive);
    return cable.now - start;
  }

  Rig rig;
  ModelCable cable;
  std::unique_ptr<Driver> driver;
  Duration longest{};
};

struct ProBench {
  explicit ProBench(std::vector<std::pair<std::string, OptionValue>> options = {})
      : bench(chip, usb_rig("enttec_pro", std::move(options)), make_enttec_pro_over) {
    EXPECT_TRUE(bench.driver->activate(bench.cable.now));
  }
  sim::EnttecWidget widget;
  sim::FtdiChip chip{widget, "DMX USB PRO", "EN1", false};
  Bench bench;
};

TEST(EnttecProDriver, SetsTheWidgetUpAndSendsTheLevels) {
  ProBench pro({{"rate_hz", std::int64_t{30}}, {"break_us", std::int64_t{200}}, {"mab_us", std::int64_t{100}}});
  pro.bench.cycles(20, 1.0);
  EXPECT_EQ(pro.bench.slot(1), 255);
  EXPECT_EQ(pro.bench.slot(8), 255);
  EXPECT_EQ(pro.bench.slot(9), 0);
  EXPECT_EQ(pro.widget.rate_hz(), 30);
  EXPECT_EQ(pro.widget.break_units(), 19);
  EXPECT_EQ(pro.widget.mark_units(), 9);
  EXPECT_EQ(pro.bench.health().life, Life::active);
  EXPECT_EQ(pro.bench.health().errors, 0u);
  EXPECT_EQ(pro.widget.dropped(), 0u);
}

TEST(EnttecProDriver, NeverStopsTheOutputOfALiveWidget) {
  ProBench pro;
  for (int i = 0; i < 44 * 20; ++i) (void)pro.bench.cycle((i % 100) / 100.0);
  EXPECT_EQ(pro.widget.stops(), 0u);
  EXPECT_GT(pro.widget.frames(), 20u * 35u);
  EXPECT_LE(pro.widget.frames(), 20u * 40u + 2u);
}

TEST(EnttecProDriver, WorksWithAnOriginalWidgetWithoutNames) {
  ProBench pro;
  pro.widget.set_character({.says_names = false});
  pro.bench.cycles(20, 0.5);
  EXPECT_EQ(pro.bench.slot(1), 128);
}

TEST(EnttecProDriver, FaultsWhileTheWidgetIsSilentOrAnswersGarbage) {
  for (const sim::EnttecWidget::Character& bad :
       {sim::EnttecWidget::Character{.silent = true}, sim::EnttecWidget::Character{.wrong_end = true}}) {
    ProBench pro;
    pro.bench.cycles(20, 0.5);
    ASSERT_EQ(pro.bench.health().life, Life::active);
    pro.widget.set_character(bad);
    EXPECT_LE(pro.bench.until(Life::faulted, 0.5), milliseconds(850));
    EXPECT_NE(pro.bench.health().detail.find("timeout"), std::string::npos) << pro.bench.health().detail;
    EXPECT_EQ(pro.bench.slot(1), 128);  // it still repeats its last packet
    pro.widget.set_character({});
    EXPECT_LE(pro.bench.until(Life::active, 0.25), milliseconds(2000));
    pro.bench.cycles(12, 0.25);
    EXPECT_EQ(pro.bench.slot(1), 64);
  }
}

TEST(EnttecProDriver, ToleratesNoiseInTheStream) {
  ProBench pro;
  pro.widget.set_character({.noise = {0x00, 0x7e, 0x03, 0xff, 0xff, 0xe7}});
  pro.bench.cycles(44 * 5, 0.5);
  EXPECT_EQ(pro.bench.health().life, Life::active) << pro.bench.health().detail;
  EXPECT_EQ(pro.bench.health().errors, 0u);
}

TEST(EnttecProDriver, ReportsThatAPlainCableIsNoWidget) {
  sim::DmxLine line;
  sim::FtdiChip chip(line, "FT232R USB UART", "A1", true);
  Bench bench(chip, usb_rig("enttec_pro"), make_enttec_pro_over);
  EXPECT_TRUE(bench.driver->activate(bench.cable.now));
  EXPECT_LE(bench.until(Life::faulted, 0.5), milliseconds(600));
  EXPECT_NE(bench.health().detail.find("open_dmx"), std::string::npos) << bench.health().detail;
}

TEST(EnttecProDriver, LeavesTheNewestLevelsForTheWidgetToRepeat) {
  ProBench pro;
  pro.bench.cycles(20, 0.5);
  // Two levels within one period of the widget's rate: the second waits and is sent with the goodbye.
  const LevelCommand last{0, 1.0};
  const LevelCommand other{1, 1.0};
  (void)pro.bench.driver->level_output()->write(pro.bench.cable.now, {&other, 1});
  (void)pro.bench.driver->level_output()->write(pro.bench.cable.now, {&last, 1});
  pro.bench.driver->deactivate(pro.bench.cable.now);
  EXPECT_EQ(pro.bench.slot(1), 255);
  EXPECT_EQ(pro.bench.slot(2), 255);
  EXPECT_EQ(pro.bench.cable.opened, pro.bench.cable.closed);
}

struct OpenBench {
  explicit OpenBench(std::vector<std::pair<std::string, OptionValue>> options = {})
      : bench(chip, usb_rig("open_dmx", std::move(options)), make_open_dmx_over) {
    EXPECT_TRUE(bench.driver->activate(bench.cable.now));
  }
  sim::DmxLine line;
  sim::FtdiChip chip{line, "FT232R USB UART", "A1", true};
  Bench bench;
};

TEST(OpenDmxDriver, SendsWholePacketsAfterABreakAndAMark) {
  for (const int rate : {20, 30, 40}) {
    OpenBench open({{"rate_hz", std::int64_t{rate}}});
    for (int i = 0; i < 44 * 10; ++i) (void)open.bench.cycle((i % 256) / 255.0);
    EXPECT_EQ(open.line.spoiled(), 0u) << rate;
    EXPECT_EQ(open.line.short_ones(), 0u) << rate;
    EXPECT_GE(open.line.shortest_break(), std::chrono::microseconds(92));
    EXPECT_GE(open.line.shortest_mark(), std::chrono::microseconds(12));
    EXPECT_LE(open.line.packets(), static_cast<std::uint64_t>(10 * rate + 1));
    EXPECT_GE(open.line.packets(), static_cast<std::uint64_t>(10 * rate * 8 / 10)) << rate;
    EXPECT_LE(open.bench.longest, milliseconds(50));
    EXPECT_EQ(open.bench.health().life, Life::active);
  }
}

TEST(OpenDmxDriver, SetsTheLineUpForDmxAndSendsBreakMarkData) {
  OpenBench open;
  open.bench.cycles(10, 0.5);
  EXPECT_EQ(open.chip.settings().divisor, 12);
  EXPECT_TRUE(open.chip.settings().rts_low);
  ASSERT_GE(open.bench.cable.requests.size(), 10u);
  const std::vector<UsbSetup> breaks(open.bench.cable.requests.end() - 2, open.bench.cable.requests.end());
  EXPECT_EQ(breaks[0], (UsbSetup{0x40, 4, 0x5008, 0}));
  EXPECT_EQ(breaks[1], (UsbSetup{0x40, 4, 0x1008, 0}));
  EXPECT_EQ(open.bench.cable.bulk_out.back(), 513u);
  EXPECT_EQ(open.bench.slot(1), 128);
}

TEST(OpenDmxDriver, FallsSilentAfterDeactivation) {
  OpenBench open;
  open.bench.cycles(10, 0.5);
  EXPECT_EQ(open.bench.slot(1), 128);
  open.bench.driver->deactivate(open.bench.cable.now);
  open.bench.cable.now += milliseconds(1100);
  EXPECT_EQ(open.bench.slot(1), -1);
}

TEST(OpenDmxDriver, LosesAPacketToALateControlRequest) {
  OpenBench open;
  open.bench.cycles(10, 0.5);
  open.bench.cable.hangs = 1;
  open.bench.cycles(5, 0.75);
  EXPECT_EQ(open.bench.slot(1), 191);
  EXPECT_EQ(open.bench.health().life, Life::active);
  EXPECT_EQ(open.bench.health().errors, 0u);
}

TEST(OpenDmxDriver, FaultsWhenTransfersHangAndRecovers) {
  OpenBench open;
  open.bench.cycles(10, 0.5);
  open.bench.cable.hangs = 1000;
  EXPECT_LE(open.bench.until(Life::faulted, 0.5), milliseconds(650));
  open.bench.cable.hangs = 0;
  EXPECT_LE(open.bench.until(Life::active, 0.75), milliseconds(1200));
  open.bench.cycles(5, 0.75);
  EXPECT_EQ(open.bench.slot(1), 191);
}

struct UdmxBench {
  UdmxBench() : bench(widget, usb_rig("udmx"), make_udmx_over) { EXPECT_TRUE(bench.driver->activate(bench.cable.now)); }
  sim::UdmxWidget widget;
  Bench bench;
};

TEST(UdmxDriver, SendsEverySlotOnceAndThenOnlyChanges) {
  UdmxBench u;
  u.bench.cycles(5, 0.5);
  EXPECT_EQ(u.widget.bytes(), 512u);
  EXPECT_EQ(u.widget.slots_put_out(), 512u);
  const LevelCommand one{2, 1.0};
  (void)u.bench.driver->level_output()->write(u.bench.cable.now, {&one, 1});
  u.bench.cable.now += milliseconds(23);
  EXPECT_EQ(u.bench.cable.requests.back(), (UsbSetup{0x40, 2, 1, 2}));
  EXPECT_EQ(u.widget.bytes(), 513u);
  EXPECT_EQ(u.bench.slot(3), 255);
}

TEST(UdmxDriver, NeverSplitsA16BitValue) {
  UdmxBench u;
  u.bench.cycles(5, 0.5);
  // The head's dimmer is at slots 105 and 106: coarse and fine of one value. They stay together whatever else changes.
  for (int i = 0; i < 500; ++i) {
    const double drive = i / 499.0;
    const LevelCommand commands[] = {{8, drive}, {static_cast<std::size_t>(i % 8), drive}};
    (void)u.bench.driver->level_output()->write(u.bench.cable.now, commands);
    u.bench.cable.now += milliseconds(40);
    (void)u.bench.driver->level_output()->write(u.bench.cable.now, {});
    u.bench.cable.now += milliseconds(40);
    const int value = u.bench.slot(105) * 256 + u.bench.slot(106);
    ASSERT_NEAR(value, drive * 65535, 0.51) << i;
  }
}

TEST(UdmxDriver, CountsAStallAndSendsTheLevelsAgain) {
  UdmxBench u;
  u.bench.cycles(5, 0.5);
  u.bench.cable.stalls = 1;
  u.bench.cycles(6, 0.75);
  EXPECT_EQ(u.bench.health().errors, 1u);
  EXPECT_EQ(u.bench.health().life, Life::active);
  EXPECT_EQ(u.bench.slot(1), 191);
  EXPECT_EQ(u.bench.cable.closed, 0);
}

TEST(UdmxDriver, CountsADeviceAsLostAfterThreeOtherErrorsInARow) {
  UdmxBench u;
  u.bench.cycles(5, 0.5);
  u.bench.cable.failures = 2;
  u.bench.cycles(8, 0.6);
  EXPECT_EQ(u.bench.health().life, Life::active);
  u.bench.cable.failures = 3;
  u.bench.cycles(8, 0.7);
  EXPECT_EQ(u.bench.health().life, Life::faulted);
  EXPECT_LE(u.bench.until(Life::active, 0.75), milliseconds(1200));
  u.bench.cycles(4, 0.75);
  EXPECT_EQ(u.bench.slot(1), 191);
}

TEST(UdmxDriver, CancelsAHangingTransfer) {
  UdmxBench u;
  u.bench.cycles(5, 0.5);
  u.bench.cable.hangs = 1;
  u.bench.cycles(40, 0.75);
  EXPECT_EQ(u.bench.health().life, Life::active);
  EXPECT_EQ(u.bench.health().errors, 1u);
  EXPECT_EQ(u.bench.slot(1), 191);
}

TEST(UdmxDriver, ReportsLightDelayedByRefusedTransfersAndRecoversByItself) {
  UdmxBench u;
  u.bench.cycles(5, 0.5);
  u.bench.cable.stalls = 60;  // about 1.4 s, too short for a lost device
  EXPECT_LE(u.bench.until(Life::faulted, 0.75), milliseconds(900));
  EXPECT_NE(u.bench.health().detail.find("light follows late"), std::string::npos) << u.bench.health().detail;
  EXPECT_FALSE(u.bench.cycle(0.75));
  EXPECT_EQ(u.bench.slot(1), 128);
  while (u.bench.cable.stalls > 0) (void)u.bench.cycle(0.75);
  u.bench.cycles(5, 0.75);
  EXPECT_EQ(u.bench.slot(1), 191);
  EXPECT_EQ(u.bench.health().life, Life::faulted) << "one good transfer is not enough";
  EXPECT_LE(u.bench.until(Life::active, 0.75), milliseconds(1200));
  EXPECT_EQ(u.bench.health().detail, "");
  EXPECT_EQ(u.bench.health().errors, 60u) << "each failed transfer, and no more";
  EXPECT_EQ(u.bench.cable.closed, 0);
}

TEST(UdmxDriver, ReportsOccasionalHangingTransfersEvenIfNeverThreeInARow) {
  UdmxBench u;
  u.bench.cycles(5, 0.5);
  bool known = false;
  for (int i = 0; i < 440; ++i) {
    if (i % 60 == 0) u.bench.cable.hangs = 1;
    (void)u.bench.cycle(0.2 + i / 1000.0);
    known = known || u.bench.health().life == Life::faulted;
  }
  EXPECT_TRUE(known);
  EXPECT_LE(u.bench.until(Life::active, 0.75), milliseconds(1200));
  EXPECT_EQ(u.bench.slot(1), 191);
}

TEST(UdmxDriver, CountsHarmlessRefusalsAndStaysActive) {
  UdmxBench u;
  for (int i = 0; i < 44 * 20; ++i) {
    if (i % 3 == 0) u.bench.cable.stalls = 1;
    (void)u.bench.cycle((i % 200) / 199.0);
    ASSERT_EQ(u.bench.health().life, Life::active) << i << u.bench.health().detail;
  }
  EXPECT_GT(u.bench.health().errors, 200u);
}

TEST(UdmxDriver, RefreshesAWidgetThatForgotEverythingWithinASecond) {
  UdmxBench u;
  u.bench.cycles(10, 0.5);
  u.widget.power_on(u.bench.cable.now);  // a supply dip that USB did not see
  EXPECT_EQ(u.bench.slot(1), -1);
  u.bench.cycles(44, 0.5);
  EXPECT_EQ(u.bench.slot(1), 128);
}

TEST(UdmxDriver, LeavesTheNewestLevelsBehind) {
  UdmxBench u;
  u.bench.cycles(5, 0.5);
  const LevelCommand last{0, 1.0}, other{1, 1.0};
  (void)u.bench.driver->level_output()->write(u.bench.cable.now, {&other, 1});
  (void)u.bench.driver->level_output()->write(u.bench.cable.now, {&last, 1});
  u.bench.driver->deactivate(u.bench.cable.now);
  EXPECT_EQ(u.bench.slot(1), 255);
  EXPECT_EQ(u.bench.slot(2), 255);
}

TEST(UsbDrivers, SendNothingBeforeTheFirstWrite) {
  UdmxBench u;
  u.bench.driver->deactivate(u.bench.cable.now);
  EXPECT_EQ(u.widget.transfers(), 0u);
  ProBench pro;
  pro.bench.driver->deactivate(pro.bench.cable.now);
  EXPECT_EQ(pro.widget.frames(), 0u);
}

TEST(UsbDrivers, FaultAtOnceWhenUnpluggedAndReturnWithTheNewestLevels) {
  const auto replug = [](Bench& bench) {
    bench.cycles(20, 0.5);
    ASSERT_EQ(bench.health().life, Life::active) << bench.health().detail;
    bench.cable.plugged_in = false;
    EXPECT_LE(bench.until(Life::faulted, 0.5), milliseconds(1000));
    EXPECT_NE(bench.health().detail.find("unplugged"), std::string::npos) << bench.health().detail;
    bench.cycles(100, 0.25);
    bench.cable.plugged_in = true;
    bench.cable.device.power_on(bench.cable.now);
    EXPECT_LE(bench.until(Life::active, 0.75), milliseconds(1500));
    bench.cycles(15, 0.75);
    EXPECT_EQ(bench.slot(1), 191);
    EXPECT_EQ(bench.health().detail, "");
  };
  ProBench pro;
  replug(pro.bench);
  OpenBench open;
  replug(open.bench);
  UdmxBench u;
  replug(u.bench);
}

TEST(UsbDrivers, OneWidgetIsOneUniverse) {
  for (const char* driver : {"enttec_pro", "open_dmx", "udmx"}) {
    Rig rig = usb_rig(driver);
    EXPECT_TRUE(check_buses(rig).empty()) << driver;
    add_dmx(rig, "elsewhere", 2, 1);
    const auto problems = check_buses(rig);
    ASSERT_EQ(problems.size(), 1u) << driver;
    EXPECT_NE(problems[0].what.find("\"elsewhere\" is in universe 2"), std::string::npos) << problems[0].text();
    Rig said = usb_rig(driver, {{"universe", std::int64_t{2}}});
    EXPECT_EQ(check_buses(said).size(), said.fixtures.size());
    Rig port = usb_rig(driver, {{"usb_port", std::string("/dev/ttyUSB0")}});
    ASSERT_EQ(check_buses(port).size(), 1u);
  }
}

TEST(UsbDrivers, SendTheSameTransfersForTheSameInputs) {
  const auto run = [](Bench& bench) {
    for (int i = 0; i < 100; ++i) (void)bench.cycle(i / 99.0);
    bench.driver->deactivate(bench.cable.now);
    return std::make_pair(bench.cable.requests, bench.cable.bulk_out);
  };
  ProBench pro_a, pro_b;
  EXPECT_EQ(run(pro_a.bench), run(pro_b.bench));
  OpenBench open_a, open_b;
  EXPECT_EQ(run(open_a.bench), run(open_b.bench));
  UdmxBench u_a, u_b;
  EXPECT_EQ(run(u_a.bench), run(u_b.bench));
}

}  // namespace
}  // namespace luxrig
