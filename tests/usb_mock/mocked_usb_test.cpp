/// The USB drivers through the real libusb on a usbfs simulated by umockdev: found, claimed, frames whole and in order,
/// stall, hang, unplugged, plugged in again, the kernel's driver detached and attached again. In real time.

#include <gtest/gtest.h>

#include <thread>

#include "drivers/registry.h"
#include "sim/devices/usb/dmx_line.h"
#include "sim/devices/usb/enttec_widget.h"
#include "sim/devices/usb/udmx_widget.h"
#include "tests/drivers/test_rig.h"
#include "tests/usb_mock/usbfs_mock.h"

#ifdef __SANITIZE_ADDRESS__
// umockdev's library is loaded before the sanitizer's own, which would then refuse to start.
extern "C" const char* __asan_default_options() { return "verify_asan_link_order=0"; }
#endif

namespace luxrig {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

struct Desk {
  Desk(sim::UsbDevice& device, const std::string& name, std::vector<std::pair<std::string, OptionValue>> options = {})
      : mock(device), rig(rig_with(bus_of(name, std::move(options)))) {
    for (int i = 1; i <= 4; ++i) add_dmx(rig, "dimmer-" + std::to_string(i), 1, i);
    EXPECT_TRUE(check_buses(rig).empty());
    driver = find_driver(name)->make(rig, 0, std::nullopt);
  }
  static Time now() { return Time{} + std::chrono::duration_cast<Duration>(steady_clock::now().time_since_epoch()); }
  void activate() { EXPECT_TRUE(driver->activate(now())); }
  void write(double drive) {
    std::vector<LevelCommand> commands;
    for (std::size_t i = 0; i < rig.fixtures.size(); ++i) commands.push_back({i, drive});
    const auto start = steady_clock::now();
    (void)driver->level_output()->write(now(), commands);
    longest = std::max<Duration>(longest, steady_clock::now() - start);
  }
  /// Runs cycles of 23 ms until the condition holds; false after five seconds.
  template <class Condition>
  bool run_until(double drive, Condition condition) {
    for (const auto end = steady_clock::now() + std::chrono::seconds(5); steady_clock::now() < end;) {
      const auto next = steady_clock::now() + milliseconds(23);
      write(drive);
      if (condition()) return true;
      std::this_thread::sleep_until(next);
    }
    return false;
  }
  bool lit(double drive, int value) {
    return run_until(drive, [&] { return slot(1) == value && slot(4) == value; });
  }
  int slot(int address) {
    const auto look = mock.line();
    return look ? look->at(static_cast<std::size_t>(address - 1)) : -1;
  }
  [[nodiscard]] Health health() const { return driver->health(now()).at(0); }

  UsbfsMock mock;
  Rig rig;
  std::unique_ptr<Driver> driver;
  Duration longest{};
};

/// A driver's life at a widget: the same for all three drivers.
void plug_and_replug(Desk& desk) {
  desk.activate();
  EXPECT_EQ(desk.health().life, Life::faulted);
  EXPECT_NE(desk.health().detail.find("plugged in"), std::string::npos) << desk.health().detail;
  desk.mock.plug();
  ASSERT_TRUE(desk.lit(0.5, 128)) << desk.health().detail;
  ASSERT_TRUE(desk.run_until(0.5, [&] { return desk.health().life == Life::active; })) << desk.health().detail;
  ASSERT_TRUE(desk.lit(1.0, 255));
  desk.mock.unplug();
  ASSERT_TRUE(desk.run_until(1.0, [&] { return desk.health().life == Life::faulted; }));
  desk.mock.plug();
  ASSERT_TRUE(desk.lit(0.25, 64)) << desk.health().detail;
  ASSERT_TRUE(desk.run_until(0.25, [&] { return desk.health().life == Life::active; }));
  EXPECT_LE(desk.longest, desk.driver->bounds().write);
  desk.driver->deactivate(Desk::now());
  desk.mock.with([](const UsbfsMock::State& state) {
    EXPECT_EQ(state.claims, 2);
    EXPECT_GE(state.releases, 1);  // the unplugged one has nothing to release
  });
}

TEST(MockedUsb, EnttecProIsFoundLitUnpluggedAndFoundAgain) {
  sim::EnttecWidget widget;
  sim::FtdiChip chip(widget, "DMX USB PRO", "EN012345", false);
  Desk desk(chip, "enttec_pro", {{"serial", std::string("EN012345")}});
  plug_and_replug(desk);
  EXPECT_EQ(widget.dropped(), 0u);
}

TEST(MockedUsb, OpenDmxIsFoundLitUnpluggedAndFoundAgain) {
  sim::DmxLine line;
  sim::FtdiChip chip(line, "FT232R USB UART", "A1", true);
  Desk desk(chip, "open_dmx", {{"usb_port", std::string("1-1")}});
  plug_and_replug(desk);
}

TEST(MockedUsb, UdmxIsFoundLitUnpluggedAndFoundAgain) {
  sim::UdmxWidget widget;
  Desk desk(widget, "udmx");
  plug_and_replug(desk);
}

TEST(MockedUsb, AnotherDeviceOfTheSharedIdIsLeftAlone) {
  sim::UdmxWidget other("www.fischl.de", "USBasp");
  Desk desk(other, "udmx");
  desk.mock.plug();
  desk.activate();
  EXPECT_EQ(desk.health().life, Life::faulted);
  desk.mock.with([](const UsbfsMock::State& state) { EXPECT_EQ(state.claims, 0); });
}

TEST(MockedUsb, AnotherSerialNumberOrPortIsLeftAlone) {
  sim::EnttecWidget widget;
  sim::FtdiChip chip(widget, "DMX USB PRO", "EN012345", false);
  for (const auto& [key, value] : {std::pair("serial", "EN099999"), std::pair("usb_port", "1-2")}) {
    Desk desk(chip, "enttec_pro", {{key, std::string(value)}});
    desk.mock.plug();
    desk.activate();
    EXPECT_EQ(desk.health().life, Life::faulted);
    EXPECT_NE(desk.health().detail.find(value), std::string::npos) << desk.health().detail;
    desk.mock.with([](const UsbfsMock::State& state) { EXPECT_EQ(state.claims, 0); });
  }
}

TEST(MockedUsb, OpenDmxPacketsAreWholeAfterTheirBreaks) {
  sim::DmxLine line;
  sim::FtdiChip chip(line, "FT232R USB UART", "A1", true);
  Desk desk(chip, "open_dmx", {{"rate_hz", std::int64_t{40}}});
  desk.mock.plug();
  desk.activate();
  const auto start = steady_clock::now();
  while (steady_clock::now() < start + milliseconds(1500)) {
    const auto next = steady_clock::now() + milliseconds(23);
    desk.write(0.5);
    std::this_thread::sleep_until(next);
  }
  desk.driver->deactivate(Desk::now());
  desk.mock.with([&](const UsbfsMock::State& state) {
    EXPECT_EQ(line.spoiled(), 0u);
    EXPECT_EQ(line.short_ones(), 0u);
    EXPECT_GE(line.packets(), 20u);
    EXPECT_GE(line.shortest_break(), std::chrono::microseconds(92));
    EXPECT_GE(line.shortest_mark(), std::chrono::microseconds(12));
    std::vector<int> formats;
    for (const sim::UsbControl& request : state.requests) {
      if (request.request == 4) formats.push_back(request.value);
    }
    ASSERT_GE(formats.size(), 41u);
    for (std::size_t i = 1; i + 1 < formats.size(); i += 2) {
      EXPECT_EQ(formats[i], 0x5008);
      EXPECT_EQ(formats[i + 1], 0x1008);
    }
    RecordProperty("packets", static_cast<int>(line.packets()));
    std::printf("open_dmx: %d packets in 1.5 s, longest write %.1f ms\n", static_cast<int>(line.packets()),
                to_seconds(desk.longest) * 1e3);
  });
}

/// Number of cancelled transfers. On a busy machine a transfer may also be late by itself.
std::uint64_t cancelled(Desk& desk) {
  std::uint64_t count = 0;
  desk.mock.with([&](const UsbfsMock::State& state) { count = static_cast<std::uint64_t>(state.discarded); });
  return count;
}

TEST(MockedUsb, AStallIsCountedAndAHangCancelled) {
  sim::UdmxWidget widget;
  Desk desk(widget, "udmx");
  desk.mock.plug();
  desk.activate();
  ASSERT_TRUE(desk.lit(0.5, 128));
  desk.mock.with([](UsbfsMock::State& state) { state.stalls = 1; });
  ASSERT_TRUE(desk.lit(0.75, 191));
  const std::uint64_t before = cancelled(desk);
  EXPECT_EQ(desk.health().errors, 1 + before);
  EXPECT_EQ(desk.health().life, Life::active);
  desk.mock.with([](UsbfsMock::State& state) { state.hangs = 1; });
  ASSERT_TRUE(desk.lit(0.25, 64));
  EXPECT_EQ(desk.health().errors, 1 + cancelled(desk));
  EXPECT_EQ(desk.health().life, Life::active);
  EXPECT_GT(cancelled(desk), before);
}

TEST(MockedUsb, RefusalsThatDelayTheLightAreReportedAndPass) {
  sim::UdmxWidget widget;
  Desk desk(widget, "udmx");
  desk.mock.plug();
  desk.activate();
  ASSERT_TRUE(desk.lit(0.5, 128));
  desk.mock.with([](UsbfsMock::State& state) { state.stalls = 50; });  // 1.2 s at 44 Hz, fewer than a lost device's 100
  EXPECT_TRUE(desk.run_until(0.75, [&] { return desk.health().life == Life::faulted; }));
  EXPECT_NE(desk.health().detail.find("light follows late"), std::string::npos) << desk.health().detail;
  EXPECT_EQ(desk.slot(1), 128);
  EXPECT_TRUE(desk.lit(0.75, 191));
  EXPECT_TRUE(desk.run_until(0.75, [&] { return desk.health().life == Life::active; }));
  EXPECT_EQ(desk.health().errors, 50 + cancelled(desk));
  desk.mock.with([](const UsbfsMock::State& state) { EXPECT_EQ(state.claims, 1); });
}

TEST(MockedUsb, ClaimsTheInterfaceFromTheKernelDriverAndReturnsIt) {
  sim::EnttecWidget widget;
  sim::FtdiChip chip(widget, "DMX USB PRO", "EN012345", false);
  Desk desk(chip, "enttec_pro");
  desk.mock.with([](UsbfsMock::State& state) { state.kernel_driver = true; });
  desk.mock.plug();
  desk.activate();
  ASSERT_TRUE(desk.lit(0.5, 128)) << desk.health().detail;
  desk.mock.with([](const UsbfsMock::State& state) {
    EXPECT_EQ(state.detached, 1);
    EXPECT_FALSE(state.kernel_driver);
  });
  desk.driver->deactivate(Desk::now());
  EXPECT_EQ(desk.slot(1), 128);  // and the widget goes on
  desk.mock.with([](const UsbfsMock::State& state) {
    EXPECT_EQ(state.attached, 1);
    EXPECT_TRUE(state.kernel_driver);
  });
}

TEST(MockedUsb, AProgramThatClaimedTheDeviceIsNamedAndLeftAlone) {
  sim::EnttecWidget widget;
  sim::FtdiChip chip(widget, "DMX USB PRO", "EN012345", false);
  Desk desk(chip, "enttec_pro");
  desk.mock.with([](UsbfsMock::State& state) { state.other_program = true; });
  desk.mock.plug();
  desk.activate();
  EXPECT_EQ(desk.health().life, Life::faulted);
  EXPECT_NE(desk.health().detail.find("another program"), std::string::npos) << desk.health().detail;
  desk.mock.with([](UsbfsMock::State& state) {
    EXPECT_EQ(state.detached, 0);
    state.other_program = false;
  });
  ASSERT_TRUE(desk.lit(0.5, 128)) << desk.health().detail;
}

}  // namespace
}  // namespace luxrig
