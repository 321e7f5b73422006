// A busy computer must not look like a dead device: the driver distinguishes its own lateness from the device's.
#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "drivers/modbus/modbus_driver.h"
#include "tests/drivers/test_rig.h"

namespace luxrig {
namespace {

using std::chrono::milliseconds;

/// Answers at once or not at all; only the test's time passes.
class SteppedLink final : public modbus::Link {
 public:
  explicit SteppedLink(std::function<bool(int unit)> answers) : answers_(std::move(answers)) {}
  [[nodiscard]] bool connected() const override { return connected_; }
  Result<void> connect(milliseconds) override {
    connected_ = true;
    return {};
  }
  void close() override { connected_ = false; }
  Result<std::vector<std::uint16_t>> exchange(const modbus::Request& request, milliseconds timeout) override {
    if (!answers_(request.unit))
      return tl::unexpected(
          Fault{Cause::timeout, {}, "no answer within " + std::to_string(timeout.count()) + " ms", {}});
    return modbus::reads(request.function) ? std::vector<std::uint16_t>(request.count, 7)
                                           : std::vector<std::uint16_t>();
  }
  bool found_closed() override { return false; }
  [[nodiscard]] bool answers_are_numbered() const override { return true; }

 private:
  std::function<bool(int)> answers_;
  bool connected_ = false;
};

struct SteppedBus {
  Rig rig;
  std::function<bool(int unit)> answers = [](int) { return true; };
  std::unique_ptr<ModbusDriver> driver;
  double now_ms = 0;

  SteppedBus() {
    rig = rig_with(bus_of("modbus_tcp"));
    for (int unit = 1; unit <= 3; ++unit) add_modbus(rig, "dimmer-" + std::to_string(unit), unit, 0);
    ModbusTiming timing;
    timing.refresh = milliseconds(500);
    timing.poll = milliseconds(200);
    driver = std::make_unique<ModbusDriver>(std::make_unique<SteppedLink>([this](int unit) { return answers(unit); }),
                                            timing, rig, 0);
    EXPECT_TRUE(driver->activate(at_ms(0)));
  }
  void write(double after_ms, double drive) {
    now_ms += after_ms;
    std::vector<LevelCommand> commands;
    for (std::size_t i = 0; i < rig.fixtures.size(); ++i) commands.push_back({i, drive});
    (void)driver->write(at_ms(now_ms), commands);
  }
  [[nodiscard]] std::string faulted() const {
    std::string names;
    for (const Health& health : driver->health(at_ms(now_ms)))
      if (health.life == Life::faulted) names += health.device + " ";
    return names;
  }
};

TEST(ModbusLateness, ADelayedThreadRaisesNoFaultWhileTheFarEndAnswers) {
  SteppedBus bus;
  for (int i = 0; i < 200; ++i) {
    bus.write(i % 20 == 19 ? 5000 : 100, 0.002 * i);
    EXPECT_EQ(bus.faulted(), "") << i;
  }
}

TEST(ModbusLateness, OneAnswerMissedAfterAnOwnStallIsNoFault) {
  SteppedBus bus;
  for (int i = 0; i < 20; ++i) bus.write(100, 0.01 * i);
  int missed = 0;
  bus.answers = [&](int unit) { return unit != 2 || missed++ > 0; };
  bus.write(4000, 0.5);  // four seconds without a call; then one answer arrives too late
  EXPECT_EQ(missed, 1);
  EXPECT_EQ(bus.faulted(), "");
  for (int i = 0; i < 20; ++i) {
    bus.write(100, 0.5 + 0.01 * i);
    EXPECT_EQ(bus.faulted(), "");
  }
  EXPECT_GT(missed, 1) << "it was asked once more";
  const std::vector<Health> health = bus.driver->health(at_ms(bus.now_ms));
  EXPECT_EQ(health.at(2).errors, 1u) << "but it is counted, for who judges by how often";
  EXPECT_EQ(health.at(1).errors, 0u);
}

TEST(ModbusLateness, ASilentUnitAloneIsFaultedInBoundedTime) {
  SteppedBus bus;
  for (int i = 0; i < 20; ++i) bus.write(100, 0.01 * i);
  bus.answers = [](int unit) { return unit != 2; };
  const double gone_ms = bus.now_ms;
  while (bus.faulted().empty() && bus.now_ms < gone_ms + 60000) bus.write(100, bus.now_ms / 1e6);
  EXPECT_EQ(bus.faulted(), "dimmer-2 ");
  EXPECT_LE(milliseconds(static_cast<int>(bus.now_ms - gone_ms)), bus.driver->bounds().fault_after);
}

TEST(ModbusLateness, ASilentBusIsFaultedInBoundedTime) {
  SteppedBus bus;
  for (int i = 0; i < 20; ++i) bus.write(100, 0.01 * i);
  bus.answers = [](int) { return false; };
  const double gone_ms = bus.now_ms;
  while (bus.faulted().find("the-bus") == std::string::npos && bus.now_ms < gone_ms + 60000)
    bus.write(100, bus.now_ms / 1e6);
  EXPECT_LE(milliseconds(static_cast<int>(bus.now_ms - gone_ms)), bus.driver->bounds().fault_after);
}

}  // namespace
}  // namespace luxrig
