/// A lighting desk -> Luxrig's input -> the merged levels, within limits -> the simulated rig, over loopback under a
/// stepped clock.
#include <gtest/gtest.h>

#include <cmath>

#include "core/show/show_controller.h"
#include "drivers/registry.h"
#include "tests/conformance/far_end.h"
#include "tests/drivers/test_rig.h"
#include "tests/loopback_desk.h"

namespace luxrig {
namespace {

/// Two lamps on slots 1 and 2 of universe 1; the first lights a point with a limit of 50 lx, 100 lx per level.
struct FollowedRig {
  FollowedRig(const std::string& protocol, const std::string& input, const std::string& hand_back)
      : protocol_(protocol), rig(make_rig(protocol, input, hand_back, desk.port())), far(rig) {
    const DriverEntry* entry = find_driver(protocol);
    EXPECT_TRUE(entry->check(rig, 0).empty());
    driver = entry->make(rig, 0, Redirect{"127.0.0.1", far.port()});
    LightModel model;
    model.point_lux_per_level = Eigen::MatrixXd{{100, 0}};
    model.meter_lux_per_level = Eigen::MatrixXd(0, 2);
    show.emplace(rig, model);
    EXPECT_EQ(driver->level_input()->parts().size(), 1u);
    show->add_desk(driver->level_input()->rules(), driver->level_input()->parts()[0]);
    EXPECT_TRUE(driver->activate(now));
    show->apply(now, std::vector<double>{0.2, 0.2});
  }
  static Rig make_rig(const std::string& protocol, const std::string& input, const std::string& hand_back, int port) {
    Rig made = rig_with(
        bus_of(protocol, {{"input", input}, {"input_hand_back", hand_back}, {"input_port", std::int64_t{port}}}));
    add_dmx(made, "limited", 1, 1);
    add_dmx(made, "free", 1, 2);
    made.points.emplace_back();
    made.points.back().name = "drawing";
    made.points.back().max_lx = 50;
    made.control.fade_s = 2;
    return made;
  }
  /// A cycle of the output; the desk sends first if it is on.
  void cycle() {
    if (desk_dmx) {
      ++sequence_;
      const auto level_dmx = static_cast<std::uint8_t>(*desk_dmx);
      desk.send(protocol_ == "sacn"
                    ? test::sacn_packet(1, sequence_, {level_dmx, level_dmx})
                    : test::artdmx_packet(1, sequence_ == 0 ? sequence_ = 1 : sequence_, {level_dmx, level_dmx}));
    }
    const auto frames = driver->level_input()->listen(now);
    show->desk(now, 0, frames[0]);
    show->step(now);
    const OutputProgram& program = show->program();
    driver->level_input()->set_silent(now, 0, program.desks[0].silent);
    std::vector<double> level(2);
    program.levels_at(now, level);
    const LevelCommand commands[] = {{0, level[0]}, {1, level[1]}};
    (void)driver->level_output()->write(now, commands);
    far.step_to(now);
    now += driver->bounds().write_period;
    const std::vector<double> drives = far.drives();
    max_jump = std::max(max_jump, std::abs(drives[1] - last_free_));
    last_free_ = drives[1];
    max_limited = std::max(max_limited, drives[0]);
  }
  void run(double seconds) {
    const Time end = now + from_seconds(seconds);
    while (now < end) cycle();
  }

  test::LoopbackDesk desk;
  std::string protocol_;
  Rig rig;
  FarEnd far;
  std::unique_ptr<Driver> driver;
  std::optional<ShowController> show;
  Time now = at_ms(0);
  std::optional<int> desk_dmx;
  double max_jump = 0, max_limited = 0;

 private:
  std::uint8_t sequence_ = 0;
  double last_free_ = 0;
};

class FollowedDesk : public ::testing::TestWithParam<const char*> {};

TEST_P(FollowedDesk, MergesTheBrighterLevelWithinTheLimit) {
  FollowedRig rig(GetParam(), "merge", "at-once");
  rig.run(5);
  EXPECT_NEAR(rig.far.drives()[1], 0.2, 0.003);
  rig.desk_dmx = 255;
  rig.run(3);  // sACN samples for 1.5 s
  EXPECT_NEAR(rig.far.drives()[1], 1, 0.003);
  // 50 lx, less the margin of a model that no meter confirms, over 100 lx per level.
  EXPECT_GT(rig.max_limited, 0.3);
  EXPECT_LE(rig.max_limited, 0.5 * 0.75 / 1.0 + 0.002);
  rig.desk_dmx = 26;
  rig.run(1);
  EXPECT_NEAR(rig.far.drives()[1], 0.2, 0.003);
}

TEST_P(FollowedDesk, IsReplacedWithoutAFlashWhenLostAndRegainsTheLightByFade) {
  FollowedRig rig(GetParam(), "takeover", "fade");
  rig.desk_dmx = 204;
  rig.run(6);
  EXPECT_NEAR(rig.far.drives()[1], 0.8, 0.003);
  rig.max_jump = 0;
  rig.desk_dmx.reset();
  rig.run(2);
  EXPECT_NEAR(rig.far.drives()[1], 0.8, 0.003);  // it may come back at any moment
  rig.run(12);
  EXPECT_NEAR(rig.far.drives()[1], 0.2, 0.003);
  EXPECT_LE(rig.max_jump, 1.5 * 0.6 * 0.0228 / 2 + 2.0 / 255);  // an s-curve's steepest slope, and an 8-bit step
  rig.desk_dmx = 204;
  rig.run(5);
  EXPECT_NEAR(rig.far.drives()[1], 0.8, 0.003);
  EXPECT_LE(rig.max_jump, 1.5 * 0.6 * 0.0228 / 2 + 2.0 / 255);
}

TEST_P(FollowedDesk, IsBackedUpInSilence) {
  FollowedRig rig(GetParam(), "standby", "at-once");
  rig.desk_dmx = 204;
  rig.run(3);
  const std::uint64_t polls_only = rig.driver->health(rig.now)[0].sent;
  EXPECT_LE(polls_only, 6u);  // no sACN, Art-Net polls and one answer
  EXPECT_EQ(rig.far.drives()[1], 0);
  rig.desk_dmx.reset();
  rig.run(std::string(GetParam()) == "sacn" ? 2.7 : 10.2);
  EXPECT_NEAR(rig.far.drives()[1], 0.8, 0.1);  // from the last values seen
  rig.run(4);
  EXPECT_NEAR(rig.far.drives()[1], 0.2, 0.003);
}

INSTANTIATE_TEST_SUITE_P(Protocols, FollowedDesk, ::testing::Values("sacn", "artnet"),
                         [](const auto& which) { return std::string(which.param); });

}  // namespace
}  // namespace luxrig
