// A whole show on one RS-485 line: four outputs of an analogue module and a luxmeter, both by their register maps, with
// a real serial driver. The lamps give less than in the model, so the light is right only if the loop closes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/rig/rig_file.h"
#include "core/show/show_controller.h"
#include "drivers/registry.h"
#include "tests/conformance/far_end.h"
#include "tests/drivers/test_rig.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

constexpr double kGoal_lx = 200, kLimit_lx = 260;
constexpr double kModel_lx = 110;  // of each lamp at full level; the far end gives 100

Rig line_show_rig() {
  std::string text = R"(
[rig]
name = "line"
[[luminaire]]
name = "bulb"
model = "isotropic"
lumens = 1000
[[bus]]
name = "line"
driver = "modbus_rtu"
device = "/dev/luxrig-no-such-port"
baud = 9600
[[point]]
name = "table"
position_m = [0, 0, 0]
goal_lx = 200
max_lx = 260
[[luxmeter]]
name = "meter"
point = "table"
bus = "line"
unit = 2
register_map = "../register-maps/dfrobot-sen0644.toml"
[control]
fade_s = 1
correction_fade_s = 0.5
[safe]
level = 0.1
hold_s = 1
fade_s = 1
)";
  for (int i = 1; i <= 4; ++i) {
    text +=
        "[[fixture]]\nname = \"lamp-" + std::to_string(i) +
        "\"\nluminaire = \"bulb\"\nposition_m = [0, 0, 2]\nbus = \"line\"\nunit = 1\nchannel = " + std::to_string(i) +
        "\nregister_map = \"../register-maps/waveshare-analog-output-8ch-b.toml\"\n";
  }
  auto rig = parse_rig(text, "line.toml", test::source_folder() / "rigs/gallery");
  if (!rig) {
    for (const Problem& problem : rig.error()) ADD_FAILURE() << problem.text();
    return {};
  }
  return *rig;
}

struct LineShow {
  LineShow() : rig(line_show_rig()), far(rig) {
    driver = find_driver("modbus_rtu")->make(rig, 0, far.redirect());
    EXPECT_TRUE(find_driver("modbus_rtu")->check(rig, 0).empty());
    LightModel model;
    model.point_lux_per_level = Eigen::MatrixXd::Constant(1, 4, kModel_lx);
    model.meter_lux_per_level = Eigen::MatrixXd::Constant(1, 4, kModel_lx);
    show.emplace(rig, model);
    far.step_to(now);
    EXPECT_TRUE(driver->activate(now));
  }
  void cycle() {
    show->health(now, driver->health(now));
    show->step(now);
    std::vector<double> level(rig.fixtures.size());
    show->program().levels_at(now, level);
    std::vector<LevelCommand> commands;
    for (std::size_t i = 0; i < level.size(); ++i) commands.push_back({i, level[i]});
    (void)driver->level_output()->write(now, commands);
    if (const auto readings = driver->lux_reader()->read(now)) {
      for (const LuxReading& reading : *readings) show->reading(now, reading);
    }
    far.step_to(now);
    brightest_lx = std::max(brightest_lx, true_lx());
    now += milliseconds_per_cycle;
  }
  void run(double seconds) {
    const Time end = now + from_seconds(seconds);
    while (now < end) cycle();
  }
  [[nodiscard]] double true_lx() const {
    double lux = 0;
    for (const double drive : far.drives()) lux += 100 * drive;
    return lux;
  }

  static constexpr std::chrono::milliseconds milliseconds_per_cycle{100};
  Rig rig;
  FarEnd far;
  std::unique_ptr<Driver> driver;
  std::optional<ShowController> show;
  Time now = at_ms(0);
  double brightest_lx = 0;
};

TEST(ModbusLineShow, ReachesItsGoalByItsLuxmeterAndKeepsTheLimit) {
  LineShow line;
  line.show->apply(line.now, std::vector<double>(4, kGoal_lx / (4 * kModel_lx)));
  line.run(2);
  EXPECT_LT(line.true_lx(), 0.95 * kGoal_lx) << "as the model has it, it is too dark";
  line.run(15);
  EXPECT_NEAR(line.true_lx(), kGoal_lx, 0.02 * kGoal_lx);
  EXPECT_LE(line.brightest_lx, kLimit_lx);
  EXPECT_EQ(line.show->status(line.now).phase, Phase::holding) << line.show->status(line.now).detail;
  EXPECT_EQ(line.driver->health(line.now).at(0).errors, 0u);
}

TEST(ModbusLineShow, HoldsItsLightWhileTheAdapterIsOutAndResumesByItself) {
  LineShow line;
  line.show->apply(line.now, std::vector<double>(4, kGoal_lx / (4 * kModel_lx)));
  line.run(17);
  const double before_lx = line.true_lx();
  ASSERT_NEAR(before_lx, kGoal_lx, 0.02 * kGoal_lx);
  line.far.faults().set("line", sim::FaultKind::dead, true);
  line.run(6);
  EXPECT_DOUBLE_EQ(line.true_lx(), before_lx) << "the module holds its outputs";
  const ShowStatus lost = line.show->status(line.now);
  EXPECT_TRUE(std::any_of(lost.alarms.begin(), lost.alarms.end(), [](const Alarm& alarm) {
    return alarm.text.find("plug the adapter in") != std::string::npos;
  }));
  line.far.faults().clear();
  line.run(25);
  EXPECT_NEAR(line.true_lx(), kGoal_lx, 0.02 * kGoal_lx) << line.show->status(line.now).detail;
  EXPECT_LE(line.brightest_lx, kLimit_lx);
}

}  // namespace
}  // namespace luxrig
