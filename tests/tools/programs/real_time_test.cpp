// luxrig test --real-time: scenario files with the real programs over the wire, and the same files stepped.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tests/tools/programs/process.h"

namespace luxrig::testing {
namespace {

using nlohmann::json;

/// Two lamps far apart, one on DMX with a desk, one on Modbus with a luxmeter below it. Nothing reflects.
constexpr const char* kRig = R"([rig]
name = "two lamps"
[[luminaire]]
name = "bulb"
model = "isotropic"
lumens = 2000
[[bus]]
name = "dmx"
driver = "sacn"
destination = "127.0.0.1"
input = "takeover"
input_offset = 100
[[bus]]
name = "field"
driver = "modbus_tcp"
host = "127.0.0.1"
port = 1502
[[point]]
name = "table"
position_m = [0, 0, 0]
goal_lx = 20
[[point]]
name = "desk"
position_m = [50, 0, 0]
goal_lx = 20
[[fixture]]
name = "lamp"
luminaire = "bulb"
position_m = [0, 0, 2]
bus = "dmx"
address = 20
[[fixture]]
name = "spot"
luminaire = "bulb"
position_m = [50, 0, 2]
bus = "field"
unit = 10
register = 0
full_scale = 1000
[[luxmeter]]
name = "meter"
point = "desk"
bus = "field"
unit = 1
register = 2
registers = 2
lux_per_count = 0.001
[control]
fade_s = 0.5
[safe]
level = 0.1
fade_s = 0.5
)";

class RealTime : public ::testing::Test {
 protected:
  /// A rig whose guardian holds the last look for so long.
  void rig(double hold_s) { std::ofstream(folder_ / "rig.toml") << kRig << "hold_s = " << hold_s << "\n"; }

  /// Results of the one run, or null, and what was printed.
  struct Tested {
    int code = 0;
    json run;
    std::string output;
  };
  Tested test(const std::string& scenario, bool real_time) {
    std::ofstream(folder_ / "show.toml") << scenario;
    const auto results = folder_ / "results.json";
    std::filesystem::remove(results);
    std::vector<std::string> words = {program("luxrig-test"),
                                      (folder_ / "rig.toml").string(),
                                      (folder_ / "show.toml").string(),
                                      "--json",
                                      results.string(),
                                      "--results",
                                      (folder_ / "pages").string()};
    if (real_time) words.emplace_back("--real-time");
    const Ran ran = luxrig::testing::run(words, 200s);
    Tested tested{ran.code, {}, ran.output};
    const json all = json::parse(text_of(results), nullptr, false);
    if (all.is_object()) tested.run = all["scenarios"][0]["runs"][0];
    return tested;
  }

 private:
  Folder folder_;
};

/// The next event waits for what the one before has shown, so that a slow machine only takes longer.
TEST_F(RealTime, TheSameShowPassesSteppedAndWithTheRealPrograms) {
  rig(60);
  const std::string show = R"([scenario]
name = "a death, a fault and a desk"
length_s = 30
[[event]]
name = "dies"
when = "phase holding"
do = "kill"
for_s = 1
[[event]]
name = "fails"
after = "dies"
after_s = 4
fault = "silent"
on = ["spot"]
[[event]]
name = "desk"
when = "alarm spot"
do = "desk"
on = ["lamp"]
value = 0.95
[[event]]
name = "stops"
when = "level lamp >= 0.94"
after_s = 1
do = "stop"
for_s = 100
[[expect]]
always = "level lamp >= 0.4"
after = "dies"
within_s = 1
[[expect]]
always = "lux table >= 12"
after = "dies"
within_s = 1
[[expect]]
reached = "alarm spot"
after = "fails"
[[expect]]
reached = "level lamp >= 0.94"
after = "desk"
[[expect]]
at_end = "exit == 0"
)";
  for (const bool real_time : {false, true}) {
    const Tested tested = test(show, real_time);
    EXPECT_EQ(tested.code, 0) << tested.output << tested.run.dump(1);
  }
}

TEST_F(RealTime, TheGuardianTakesTheLightDownAndWithoutItLampsKeepWhatTheyHad) {
  rig(0.5);
  const std::string kill = R"(do = "kill"
for_s = 5
[[expect]]
)";
  const std::string head = "[scenario]\nname = \"a death\"\nlength_s = 20\n[[event]]\n";
  const std::string when = "when = \"phase holding\"\nafter_s = 2\n";
  const Tested guarded = test(
      head + "name = \"dies\"\n" + when + kill + "reached = \"level lamp <= 0.11\"\nafter = \"dies\"\nwithin_s = 4.5\n",
      true);
  EXPECT_EQ(guarded.code, 0) << guarded.output;
  const Tested alone = test(head + when + "do = \"kill_guardian\"\n[[event]]\nname = \"dies\"\n" + when + kill +
                                "always = \"level lamp >= 0.4\"\nafter = \"dies\"\nwithin_s = 4\n",
                            true);
  EXPECT_EQ(alone.code, 0) << alone.output;
}

TEST_F(RealTime, AFaultOfTheWireActsOnlyThere) {
  rig(60);
  const std::string show = R"([scenario]
name = "packets overtake each other"
length_s = 8
[[event]]
at_s = 1
fault = "reordered"
on = ["dmx"]
for_s = 4
[[expect]]
at_end = "lux table >= 12"
)";
  const Tested real = test(show, true);
  EXPECT_EQ(real.code, 0) << real.output;
  const Tested stepped = test(show, false);
  EXPECT_EQ(stepped.code, 1);
  EXPECT_NE(stepped.output.find("run it with --real-time"), std::string::npos) << stepped.output;
}

TEST_F(RealTime, WhatIsNotSoFailsBothWays) {
  rig(60);
  const std::string show = R"([scenario]
name = "wrong"
length_s = 6
[[event]]
name = "park"
at_s = 2
do = "park"
refused = true
[[expect]]
always = "lux table < 1"
[[expect]]
reached = "phase safe"
[[expect]]
reached = "lux table > 12"
)";
  for (const bool real_time : {false, true}) {
    const Tested tested = test(show, real_time);
    EXPECT_EQ(tested.code, 1) << tested.output;
    ASSERT_TRUE(tested.run.is_object()) << tested.output;
    EXPECT_FALSE(tested.run.contains("error")) << tested.run["error"];
    const json& expectations = tested.run["expectations"];
    EXPECT_EQ(expectations[0]["held"], false);
    EXPECT_EQ(expectations[1]["held"], false);
    EXPECT_EQ(expectations[2]["held"], true) << tested.output;
  }
}

}  // namespace
}  // namespace luxrig::testing
