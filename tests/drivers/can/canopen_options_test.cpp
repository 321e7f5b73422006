#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "drivers/can/can_socket.h"
#include "drivers/can/canopen_driver.h"
#include "tests/drivers/test_rig.h"

namespace luxrig {
namespace {

Rig rig_with_axes(std::vector<std::pair<std::string, OptionValue>> options = {}) {
  options.push_back({"interface", std::string("can0")});
  Rig rig = rig_with(bus_of("canopen", std::move(options)));
  rig.buses.push_back(bus_of("sacn"));
  rig.buses[1].name = "lamps";
  add_axes(add_dmx(rig, "head", 1, 1), 5, 6).bus = 1;
  return rig;
}

std::string only_problem(const Rig& rig) {
  const auto problems = check_canopen(rig, 0);
  EXPECT_EQ(problems.size(), 1u);
  return problems.empty() ? "" : problems[0].text();
}

TEST(CanopenOptions, AreValidByDefault) {
  EXPECT_TRUE(check_canopen(rig_with_axes(), 0).empty());
  EXPECT_TRUE(check_canopen(rig_with_axes({{"home", std::string("when needed")},
                                           {"on_stop", std::string("release")},
                                           {"homing_method", std::int64_t{-3}}}),
                            0)
                  .empty());
}

TEST(CanopenOptions, ReportErrorsWithARemedy) {
  EXPECT_EQ(only_problem(rig_with_axes({{"home", std::string("sometimes")}})),
            "a/rig.toml:8:5: home = \"sometimes\" is none of its values: use one of \"at start\", \"when needed\", "
            "\"never\"");
  EXPECT_NE(only_problem(rig_with_axes({{"on_stop", std::string("fall")}})).find("\"hold\", \"release\""),
            std::string::npos);
  EXPECT_NE(only_problem(rig_with_axes({{"homing_method", std::int64_t{38}}})).find("out of range"), std::string::npos);
  EXPECT_NE(only_problem(rig_with_axes({{"master_node", std::int64_t{6}}})).find("node 6 is Luxrig's own"),
            std::string::npos);

  Rig rig = rig_with_axes();
  rig.buses[0].options["interface"] = {std::string("no such name at all"), {8, 5}};
  EXPECT_NE(only_problem(rig).find("cannot be the name of an interface"), std::string::npos);
  rig = rig_with_axes();
  rig.fixtures[0].bus = 0;
  EXPECT_NE(only_problem(rig).find("has its dimmer on the bus \"the-bus\", which only turns heads"), std::string::npos);
  rig = rig_with_axes();
  rig.fixtures[0].axes->pan.counts_per_degree = 1e6;
  rig.fixtures[0].range.pan_max_rad = rad_from_deg(3600);
  EXPECT_NE(only_problem(rig).find("more than a position of 32 bit holds"), std::string::npos);
  rig = rig_with_axes();
  add_meter(rig, "meter", 1, 2);
  EXPECT_NE(only_problem(rig).find("luxmeter \"meter\" is on the bus"), std::string::npos);
}

/// On most build machines, as here, the kernel has no CAN; elsewhere the interface is missing.
TEST(CanSocket, ReportsWhyItCannotBeOpened) {
  auto channel = can::make_can_socket({"nocan9", {0x705}});
  const auto opened = channel->open();
  ASSERT_FALSE(opened);
  EXPECT_FALSE(channel->is_open());
  const int fd = ::socket(PF_CAN, SOCK_RAW, 1);
  if (fd < 0) {
    EXPECT_EQ(opened.error().cause, Cause::system);
    EXPECT_NE(opened.error().detail.find("this kernel has no CAN"), std::string::npos) << opened.error().detail;
  } else {
    ::close(fd);
    EXPECT_NE(opened.error().detail.find("nocan9"), std::string::npos) << opened.error().detail;
  }
  EXPECT_FALSE(channel->receive());
}

TEST(CanopenDriver, IsFaultedWithoutAnInterfaceAndKeepsTrying) {
  const Rig rig = rig_with_axes();
  const auto driver = make_canopen(rig, 0, std::nullopt);
  EXPECT_TRUE(driver->activate(at_ms(0)));
  for (int ms = 0; ms < 3000; ms += 20) EXPECT_FALSE(driver->mover()->move(at_ms(ms), {}));
  const auto health = driver->health(at_ms(3000));
  ASSERT_EQ(health.size(), 3u);
  EXPECT_EQ(health[0].life, Life::faulted);
  EXPECT_NE(health[0].detail.find("CAN"), std::string::npos) << health[0].detail;
  EXPECT_EQ(health[1].device, "head (pan axis)");
  EXPECT_EQ(health[1].life, Life::faulted);
  EXPECT_EQ(driver->level_output(), nullptr);
}

}  // namespace
}  // namespace luxrig
