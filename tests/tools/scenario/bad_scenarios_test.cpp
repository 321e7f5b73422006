// Wrong scenarios, each with the place and the beginning of what is said. Nothing else may be said.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/core/rig/listed_problems.h"
#include "tests/tools/scenario/small_rig.h"
#include "tools/scenario/scenario_file.h"

namespace luxrig::scenario {
namespace {

struct Bad {
  const char* text;
  const char* said;  ///< "line:column: beginning of what is wrong"
};

constexpr const char* kHead = "[scenario]\nname = \"bad\"\nlength_s = 100\n";  // the text goes on in line 4

/// Whole files.
constexpr Bad kFiles[] = {
    {"", "1:1: there is no [scenario]"},
    {"[[event]]\nat_s = 1\ndo = \"blackout\"\n", "1:1: there is no [scenario]"},
    {"[scenario]\nname = \"bad\"\n", "1:1: [scenario] has no \"length_s\""},
    {"[scenario]\nlength_s = 10\n", "1:1: [scenario] has no \"name\""},
    {"[scenario]\nname = 7\nlength_s = 10\n", "2:8: name must be text"},
    {"[scenario]\nname = \"\"\nlength_s = 10\n", "2:8: name is empty"},
    {"[scenario]\nname = \"bad\"\nlength_s = 0\n", "3:12: length_s is 0, which is out of range"},
    {"[scenario]\nname = \"bad\"\nlength_s = -5\n", "3:12: length_s is -5, which is out of range"},
    {"[scenario]\nname = \"bad\"\nlength_s = 2e6\n", "3:12: length_s is 2000000, which is out of range"},
    {"[scenario]\nname = \"bad\"\nlength_s = nan\n", "3:12: length_s is not a finite number"},
    {"[scenario]\nname = \"bad\"\nlength_s = \"long\"\n", "3:12: length_s must be a number"},
    {"[scenario]\nname = \"bad\"\nlength_s = 10\nlenght = 1\n", "4:1: unknown key \"lenght\" in [scenario]"},
    {"[scenario]\nname = \"bad\"\nlength_s = 10\nseeds = 4\n", "4:9: seeds must be text"},
    {"[scenario]\nname = \"bad\"\nlength_s = 10\nseeds = \"\"\n", "4:9: seeds is empty"},
    {"[scenario]\nname = \"bad\"\nlength_s = 10\nseeds = \"a\"\n", "4:9: seeds cannot be \"a\""},
    {"[scenario]\nname = \"bad\"\nlength_s = 10\nseeds = \"1..\"\n", "4:9: seeds cannot be \"1..\""},
    {"[scenario]\nname = \"bad\"\nlength_s = 10\nseeds = \"5..1\"\n", "4:9: seeds cannot be \"5..1\""},
    {"[scenario]\nname = \"bad\"\nlength_s = 10\nseeds = \"1,,2\"\n", "4:9: seeds cannot be \"1,,2\""},
    {"[scenario]\nname = \"bad\"\nlength_s = 10\nseeds = \"1..200000\"\n", "4:9: seeds cannot be \"1..200000\""},
    {"[scenario]\nname = \"bad\"\nlength_s = 10\nseeds = \"-1\"\n", "4:9: seeds cannot be \"-1\""},
    {"[scenario]\nname = \"bad\"\nlength_s = 10\nseeds = \"99999999999999999999\"\n",
     "4:9: seeds cannot be \"99999999999999999999\""},
    {"[scenario]\nname = \"bad\"\nlength_s = 10\nstart = \"bright\"\n", "4:9: start cannot be \"bright\""},
    {"[scenario]\nname = \"bad\"\nlength_s = 10\ndeviations = \"wild\"\n", "4:14: unknown deviation 'wild'"},
    {"[scenario]\nname = \"bad\"\nlength_s = 10\ndeviations = \"none,output_min=9\"\n",
     "4:14: 'output_min=9' has no good value"},
    {"[scenario]\nname = \"bad\"\nlength_s = 10\ndeviations = \"output_min=1.9\"\n",
     "4:14: output_min is above output_max"},
    {"[[scenario]]\nname = \"bad\"\nlength_s = 10\n", "1:3: scenario is not a table"},
    {"scenario = 3\n", "1:1: scenario is not a table"},
    {"[scenario]\nname = \"bad\"\nlength_s = 10\n[events]\n", "4:2: unknown section \"events\" in a scenario"},
    {"[scenario]\nname = \"bad\"\nlength_s = 10\n[rig]\nname = \"x\"\n", "4:2: unknown section \"rig\" in a scenario"},
    {"[scenario]\nname = \"bad\"\nlength_s = 10\n[event]\nat_s = 1\ndo = \"park\"\n", "4:2: event is not a list"},
    {"[scenario]\nname = \"bad\"\nlength_s = 10\n[expect]\nalways = \"blackout\"\n", "4:2: expect is not a list"},
    {"[scenario]\nname = \"bad\nlength_s = 10\n", "2:12: "},
    {"[scenario]\nname = \"bad\"\nname = \"worse\"\nlength_s = 10\n", "3:8: "},
    {"[scenario\n", "1:10: "},
};

/// After kHead.
constexpr Bad kParts[] = {
    // When something happens.
    {"[[event]]\ndo = \"blackout\"\n", "4:1: nothing says when this happens"},
    {"[[event]]\nat_s = 1\nwhen = \"phase holding\"\ndo = \"blackout\"\n", "4:1: this event has more than one time"},
    {"[[event]]\nat_s = -1\ndo = \"blackout\"\n", "5:8: at_s is -1, which is out of range"},
    {"[[event]]\nat_s = \"now\"\ndo = \"blackout\"\n", "5:8: at_s must be a number"},
    {"[[event]]\nat_s = 100\ndo = \"blackout\"\n", "5:8: that is not before the end of the show at 100 s"},
    {"[[event]]\nat_s = 1\nafter_s = 2\ndo = \"blackout\"\n", "6:1: after_s has no effect with at_s"},
    {"[[event]]\nafter = \"it\"\ndo = \"blackout\"\n", "5:9: no event above is called \"it\""},
    {"[[event]]\nname = \"it\"\nafter = \"it\"\ndo = \"blackout\"\n", "6:9: no event above is called \"it\""},
    {"[[event]]\nname = \"it\"\nat_s = 1\ndo = \"blackout\"\n[[event]]\nafter = \"its\"\ndo = \"blackout\"\n",
     "9:9: no event above is called \"its\""},
    {"[[event]]\nname = \"it\"\nat_s = 1\ndo = \"blackout\"\n[[event]]\nname = \"it\"\nat_s = 2\ndo = \"blackout\"\n",
     "9:8: a second event is called \"it\""},
    {"[[event]]\nname = \"it\"\nat_s = 1\ndo = \"blackout\"\n[[event]]\nafter = \"it\"\nafter_s = 200\ndo = "
     "\"blackout\"\n",
     "10:11: that is not before the end of the show at 100 s"},
    {"[[event]]\nwhen = \"\"\ndo = \"blackout\"\n", "5:8: when is empty"},
    {"[[event]]\nwhen = \"phase hold\"\ndo = \"blackout\"\n", "5:15: there is no phase \"hold\""},
    {"[[event]]\nwhen = 5\ndo = \"blackout\"\n", "5:8: when must be text"},
    // What happens.
    {"[[event]]\nat_s = 1\n", "4:1: this event does nothing"},
    {"[[event]]\nat_s = 1\ndo = \"blackout\"\nfault = \"dead\"\non = [\"track\"]\n",
     "4:1: this event has both a fault and an action"},
    {"[[event]]\nat_s = 1\ndo = \"dance\"\n", "6:6: do cannot be \"dance\""},
    {"[[event]]\nat_s = 1\ndo = true\n", "6:6: do must be text"},
    {"[[event]]\nat_s = 1\ndoo = \"blackout\"\ndo = \"blackout\"\n", "6:1: unknown key \"doo\" in [[event]]"},
    {"[[event]]\nat_s = 1\ndo = \"blackout\"\nfor_s = 0\n", "7:9: for_s is 0, which is out of range"},
    {"[[event]]\nat_s = 1\ndo = \"blackout\"\non = [\"spot-1\"]\n", "7:1: on has no effect on blackout"},
    {"[[event]]\nat_s = 1\ndo = \"blackout\"\nvalue = 1\n", "7:1: value has no effect on blackout"},
    {"[[event]]\nat_s = 1\ndo = \"blackout\"\nplan = \"a.json\"\n", "7:1: plan has no effect"},
    {"[[event]]\nat_s = 1\ndo = \"lift_blackout\"\nfor_s = 3\n", "7:1: for_s has no effect on lift_blackout"},
    {"[[event]]\nat_s = 1\ndo = \"level\"\nvalue = 0.5\n", "4:1: [[event]] has no \"on\""},
    {"[[event]]\nat_s = 1\ndo = \"level\"\non = [\"spot-1\"]\n", "4:1: [[event]] has no \"value\""},
    {"[[event]]\nat_s = 1\ndo = \"level\"\non = [\"spot-1\"]\nvalue = 1.5\n",
     "8:9: value 1.5 of level is out of range"},
    {"[[event]]\nat_s = 1\ndo = \"level\"\non = [\"spot-1\"]\nvalue = \"half\"\n", "8:9: value must be a number"},
    {"[[event]]\nat_s = 1\ndo = \"level\"\non = [\"sport-1\"]\nvalue = 1\n",
     "7:7: \"sport-1\" fits none of the fixtures"},
    {"[[event]]\nat_s = 1\ndo = \"level\"\non = [\"spot-1\", \"x*\"]\nvalue = 1\n",
     "7:17: \"x*\" fits none of the fixtures"},
    {"[[event]]\nat_s = 1\ndo = \"level\"\non = []\nvalue = 1\n", "7:6: on is empty"},
    {"[[event]]\nat_s = 1\ndo = \"level\"\non = \"spot-1\"\nvalue = 1\n", "7:6: on must be a list of text"},
    {"[[event]]\nat_s = 1\ndo = \"level\"\non = [1]\nvalue = 1\n", "7:7: on must be text"},
    {"[[event]]\nat_s = 1\ndo = \"goal\"\non = [\"spot-1\"]\nvalue = 1\n", "7:7: \"spot-1\" fits none of the points"},
    {"[[event]]\nat_s = 1\ndo = \"goal\"\non = [\"work-1\"]\nvalue = -1\n", "8:9: value -1 of goal is out of range"},
    {"[[event]]\nat_s = 1\ndo = \"cover\"\non = [\"work-1\"]\nvalue = 0\n",
     "7:7: \"work-1\" fits none of the luxmeters"},
    {"[[event]]\nat_s = 1\ndo = \"cover\"\non = [\"meter-1\"]\nvalue = 2\n", "8:9: value 2 of cover is out of range"},
    {"[[event]]\nat_s = 1\ndo = \"shade\"\non = [\"meter-1\"]\nvalue = 0\n",
     "7:7: \"meter-1\" fits none of the points"},
    {"[[event]]\nat_s = 1\ndo = \"shade\"\non = [\"work-1\"]\n", "4:1: [[event]] has no \"value\""},
    {"[[event]]\nat_s = 1\ndo = \"daylight\"\nvalue = 2\n", "6:6: this rig has no daylight"},
    {"[[event]]\nat_s = 1\ndo = \"bypass\"\n", "4:1: [[event]] has no \"on\""},
    {"[[event]]\nat_s = 1\ndo = \"bypass\"\non = [\"work-1\"]\n",
     "7:7: \"work-1\" fits none of the fixtures and luxmeters"},
    {"[[event]]\nat_s = 1\ndo = \"desk\"\non = [\"spot-1\"]\nvalue = 1\n",
     "7:6: bus \"track\" of fixture \"spot-1\" listens to no desk"},
    {"[[event]]\nat_s = 1\ndo = \"replay\"\n", "4:1: [[event]] has no \"recording\""},
    {"[[event]]\nat_s = 1\ndo = \"blackout\"\nrecording = \"a.pcap\"\n", "7:1: recording has no effect: only do"},
    {"[[event]]\nat_s = 1\nfault = \"silent\"\non = [\"spot-1\"]\nrecording = \"a.pcap\"\n",
     "8:1: recording has no effect on a fault"},
    {"[[event]]\nat_s = 1\ndo = \"blackout\"\npan_deg = 5\n", "7:1: pan_deg has no effect: only a desk turns heads"},
    {"[[event]]\nat_s = 1\ndo = \"kill\"\nrefused = true\n", "7:1: nobody can refuse kill"},
    {"[[event]]\nat_s = 1\ndo = \"park\"\nrefused = 1\n", "7:11: refused must be true or false"},
    // Faults.
    {"[[event]]\nat_s = 1\nfault = \"dead\"\n", "4:1: [[event]] has no \"on\""},
    {"[[event]]\nat_s = 1\nfault = \"deaf\"\non = [\"track\"]\n", "6:9: unknown fault \"deaf\""},
    {"[[event]]\nat_s = 1\nfault = \"\"\non = [\"track\"]\n", "6:9: fault is empty"},
    {"[[event]]\nat_s = 1\nfault = \"dead\"\non = [\"tracks\"]\n", "7:7: \"tracks\" fits none of the devices"},
    {"[[event]]\nat_s = 1\nfault = \"dead\"\non = [\"work-1\"]\n", "7:7: \"work-1\" fits none of the devices"},
    {"[[event]]\nat_s = 1\nfault = \"lost\"\non = [\"track\"]\nvalue = 2\n",
     "8:9: value 2 of fault 'lost' is out of range"},
    {"[[event]]\nat_s = 1\nfault = \"dead\"\non = [\"track\"]\nrefused = true\n", "8:1: nobody can refuse a fault"},
    {"[[event]]\nat_s = 1\nfault = \"dead\"\non = [\"track\"]\nplan = \"a.json\"\n", "8:1: plan has no effect"},
    // Expectations.
    {"[[expect]]\n", "4:1: this expectation expects nothing"},
    {"[[expect]]\nwhy = \"x\"\n", "4:1: this expectation expects nothing"},
    {"[[expect]]\nalways = \"blackout\"\nnever = \"blackout\"\n", "4:1: this expectation has more than one"},
    {"[[expect]]\nalway = \"blackout\"\nnever = \"blackout\"\n", "5:1: unknown key \"alway\" in [[expect]]"},
    {"[[expect]]\nalways = true\n", "5:10: always must be text"},
    {"[[expect]]\nalways = \"\"\n", "5:10: always is empty"},
    {"[[expect]]\nalways = \"   \"\n", "5:14: the condition is empty"},
    {"[[expect]]\nalways = \"lumen work-1 < 5\"\n", "5:11: unknown subject \"lumen\""},
    {"[[expect]]\nalways = \"lux\"\n", "5:14: lux needs the name of a point"},
    {"[[expect]]\nalways = \"lux wrk-1 < 5\"\n", "5:15: \"wrk-1\" fits no point"},
    {"[[expect]]\nalways = \"lux spot-1 < 5\"\n", "5:15: \"spot-1\" fits no point"},
    {"[[expect]]\nalways = \"reading work-1 < 5\"\n", "5:19: \"work-1\" fits no luxmeter"},
    {"[[expect]]\nalways = \"level meter-1 < 1\"\n", "5:17: \"meter-1\" fits no fixture"},
    {"[[expect]]\nalways = \"pan spot-1 < 1\"\n", "5:15: fixture \"spot-1\" does not turn"},
    {"[[expect]]\nalways = \"lux work-1\"\n", "5:21: lux is not compared with anything"},
    {"[[expect]]\nalways = \"lux work-1 50\"\n", "5:22: \"50\" is no comparison"},
    {"[[expect]]\nalways = \"lux work-1 =< 50\"\n", "5:22: \"=<\" is no comparison"},
    {"[[expect]]\nalways = \"lux work-1 <\"\n", "5:23: the number is missing"},
    {"[[expect]]\nalways = \"lux work-1 < fifty\"\n", "5:24: \"fifty\" is not a number"},
    {"[[expect]]\nalways = \"lux work-1 < 50lx\"\n", "5:24: \"50lx\" is not a number"},
    {"[[expect]]\nalways = \"lux work-1 < inf\"\n", "5:24: \"inf\" is not a number"},
    {"[[expect]]\nalways = \"lux work-1 between 45\"\n", "5:32: between has one number"},
    {"[[expect]]\nalways = \"lux work-1 between 45 and\"\n", "5:36: the number is missing"},
    {"[[expect]]\nalways = \"lux work-1 between 50 and 45\"\n", "5:37: nothing lies between 50 and 45"},
    {"[[expect]]\nalways = \"lux work-1 == 45 +- much\"\n", "5:31: \"much\" is not a number"},
    {"[[expect]]\nalways = \"lux work-1 == 45 +- -2\"\n", "5:31: a tolerance of -2 is below 0"},
    {"[[event]]\nat_s = 1\ndo = \"clock_step\"\n", "4:1: [[event]] has no \"value\""},
    {"[[expect]]\nalways = \"lux work-1 < 50 deg\"\n", "5:27: \"deg\" is one word too many"},
    {"[[expect]]\nalways = \"lux work 1 < 50\"\n", "5:15: \"work\" fits no point"},
    {"[[expect]]\nalways = \"phase\"\n", "5:16: phase without its name"},
    {"[[expect]]\nalways = \"phase holdin\"\n", "5:17: there is no phase \"holdin\""},
    {"[[expect]]\nalways = \"blackout on\"\n", "5:20: \"on\" is one word too many"},
    {"[[expect]]\nreached = \"alarm\"\n", "5:17: alarm without a text"},
    {"[[expect]]\nat_end = \"missed = 0\"\n", "5:18: \"=\" is no comparison"},
    {"[[expect]]\nreached = \"phase safe\"\nwithin_s = 0\n", "6:12: within_s is 0, which is out of range"},
    {"[[expect]]\nreached = \"phase safe\"\nwithin_s = 200\n", "6:12: the show is over at 100 s, before that time"},
    {"[[expect]]\nreached = \"phase safe\"\nfrom_s = 100\n", "6:10: the show is over at 100 s"},
    {"[[expect]]\nreached = \"phase safe\"\nafter = \"it dies\"\n", "6:9: no event above is called \"it dies\""},
    {"[[expect]]\nreached = \"phase safe\"\nwhy = \"\"\n", "6:7: why is empty"},
};

void expect_refused(const std::string& text, const std::string& said) {
  const auto scenario = parse_scenario(text, "bad.toml", small_rig());
  ASSERT_FALSE(scenario.has_value()) << "accepted:\n" << text;
  const Problem& first = scenario.error().front();
  const std::string found = fmt::format("{}:{}: {}", first.line, first.column, first.what);
  EXPECT_EQ(found.substr(0, said.size()), said) << text << test::listed(scenario.error());
  EXPECT_EQ(scenario.error().size(), 1U) << text << test::listed(scenario.error());
  for (const Problem& problem : scenario.error()) EXPECT_FALSE(problem.mend.empty()) << problem.text();
}

TEST(BadScenarios, AreRefusedWithTheirPlaceAndARemedy) {
  for (const Bad& bad : kFiles) expect_refused(bad.text, bad.said);
  for (const Bad& bad : kParts) expect_refused(std::string(kHead) + bad.text, bad.said);
  EXPECT_GE(std::size(kFiles) + std::size(kParts), 100U);
}

TEST(BadScenarios, ListAllProblemsAtOnce) {
  const auto scenario = parse_scenario(
      std::string(kHead) + "[[event]]\nat_s = -1\ndo = \"dance\"\n[[expect]]\nalways = \"lux nobody < 5\"\n",
      "bad.toml", small_rig());
  ASSERT_FALSE(scenario.has_value());
  EXPECT_EQ(scenario.error().size(), 3U) << test::listed(scenario.error());
}

TEST(BadScenarios, OfMoreThanAMegabyteAreNotRead) {
  const auto scenario = parse_scenario(std::string((std::size_t{1} << 20) + 1, '#'), "bad.toml", small_rig());
  ASSERT_FALSE(scenario.has_value());
  EXPECT_EQ(scenario.error().front().what, "the file has 1048577 bytes");
}

}  // namespace
}  // namespace luxrig::scenario
