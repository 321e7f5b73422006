// A person bypasses a failed luxmeter, over the wire.
#include <gtest/gtest.h>

#include "tests/tools/programs/live_rig.h"

namespace luxrig::testing {
namespace {

Ran client_of(LiveRig& rig, std::vector<std::string> words) {
  words.insert(words.begin(), program("luxrig"));
  words.insert(words.end(), {"--port", std::to_string(rig.port())});
  return luxrig::testing::run(words);
}

bool is_bypassed(const json& status, const std::string& name) {
  for (const json& one : status["bypassed"])
    if (one["name"] == name) return true;
  return false;
}

// In this rig a lost luxmeter sends all lamps to the safe look.
TEST(Bypass, OfADeadMeterRestoresTheLightReportsTheRiskAndSurvivesAKill) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 90s)) << rig.daemon().output();
  rig.fault("meter-1", "dead", true);
  ASSERT_TRUE(rig.wait_phase("safe", 30s)) << rig.last();
  const Ran unknown = client_of(rig, {"bypass", "meter-7"});
  EXPECT_EQ(unknown.code, 2) << unknown.output;
  EXPECT_NE(unknown.output.find("the rig has no fixture or luxmeter \"meter-7\""), std::string::npos) << unknown.output;
  const Ran bypassed = client_of(rig, {"bypass", "meter-1"});
  ASSERT_EQ(bypassed.code, 0) << bypassed.output;
  EXPECT_NE(bypassed.output.find("plinth-top is then"), std::string::npos) << bypassed.output;
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.last();
  EXPECT_TRUE(is_bypassed(rig.last(), "meter-1")) << rig.last();
  EXPECT_FALSE(rig.has_severe_alarm()) << rig.last()["alarms"];
  EXPECT_EQ(rig.last()["alarms"].size(), 1u) << rig.last()["alarms"];
  const Ran told = client_of(rig, {"status"});
  EXPECT_NE(told.output.find("watched by nobody") != std::string::npos ||
                told.output.find("by the model alone") != std::string::npos,
            false)
      << told.output;

  rig.daemon().signal(SIGKILL);
  rig.start_daemon();
  ASSERT_TRUE(rig.wait_phase("holding", 90s)) << rig.daemon().output();
  EXPECT_TRUE(is_bypassed(rig.last(), "meter-1")) << rig.last();
  rig.fault("meter-1", "dead", false);
  ASSERT_EQ(client_of(rig, {"bypass", "meter-1", "--undo"}).code, 0);
  ASSERT_TRUE(rig.wait_status(
      [](const json& s) { return s["phase"] == "holding" && s["bypassed"].empty() && s["alarms"].empty(); }, 60s))
      << rig.last();
}

}  // namespace
}  // namespace luxrig::testing
