// A dead part as a person sees it, and a limit at an unmeasured point.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/tools/programs/live_rig.h"

namespace luxrig::testing {
namespace {

/// A copy of tests/rigs/room whose rig file was changed.
struct ChangedRoom {
  explicit ChangedRoom(const std::function<void(std::string&)>& change) {
    std::filesystem::copy(source("tests/rigs/room"), folder / "room", std::filesystem::copy_options::recursive);
    std::string text = text_of(folder / "room/rig.toml");
    change(text);
    std::ofstream(folder / "room/rig.toml") << text;
  }
  [[nodiscard]] std::string path() const { return (folder / "room").string(); }
  Folder folder;
};

void replace(std::string& text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
}

TEST(FailureDomains, ADeadDimmerLogsOneLineAndTheOtherLampsStay) {
  const ChangedRoom room([](std::string& text) { replace(text, "on_meter_loss = true", "on_meter_loss = false"); });
  LiveRig rig(room.path());
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  const double spot = level_of(rig.last(), "spot-1"), head = level_of(rig.last(), "head-1");
  ASSERT_GT(spot + head, 0.05);
  rig.fault("bulb-1", "silent", true);
  ASSERT_TRUE(rig.wait_status([&](const json& s) { return !s["alarms"].empty(); }, 3s)) << rig.last().dump(1);
  for (int i = 0; i < 20; ++i) {
    std::this_thread::sleep_for(500ms);
    ASSERT_TRUE(rig.wait_status([](const json&) { return true; }, 5s));
    EXPECT_NEAR(level_of(rig.last(), "spot-1"), spot, 1e-6) << rig.last().dump(1);
    EXPECT_NEAR(level_of(rig.last(), "head-1"), head, 1e-6) << rig.last().dump(1);
    EXPECT_NE(rig.last()["phase"], "frozen");
    EXPECT_NE(rig.last()["phase"], "safe");
  }
  const std::string log = rig.daemon().output();
  std::size_t lines = 0;
  for (auto at = log.find("ALARM"); at != std::string::npos; at = log.find("ALARM", at + 1)) ++lines;
  EXPECT_EQ(lines, 1u) << log;
  rig.fault("bulb-1", "silent", false);
  EXPECT_TRUE(rig.wait_status([](const json& s) { return s["phase"] == "holding" && s["alarms"].empty(); }, 30s))
      << rig.last().dump(1);
}

TEST(FailureDomains, SolveStatesTheMarginOfALimitAndTheDaemonAppliesIt) {
  const ChangedRoom room([](std::string& text) {
    const auto meters = text.find("[[luxmeter]]"), points = text.find("[[point]]");
    text.erase(meters, points - meters);
    replace(text, "max_lx = 200", "max_lx = 150");
  });
  const Folder folder;
  const std::string plan = (folder / "plan.json").string();
  const Ran ran = luxrig::testing::run({program("luxrig"), "solve", room.path(), "-o", plan});
  EXPECT_NE(ran.output.find("plinth-top: "), std::string::npos) << ran.output;
  EXPECT_NE(ran.output.find("no luxmeter stands at a limited point"), std::string::npos) << ran.output;
  const json points = json::parse(text_of(plan))["points"];
  ASSERT_TRUE(points[0].contains("opening_lux")) << points.dump(1);
  const double opening_lx = points[0]["opening_lux"];
  EXPECT_LT(opening_lx, 0.75 * points[0]["lux"].get<double>());

  LiveRig rig(room.path());
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  EXPECT_NEAR(rig.last()["points"][0]["predicted_lux"].get<double>(), opening_lx, 0.05 * opening_lx)
      << rig.last().dump(1);
}

}  // namespace
}  // namespace luxrig::testing
