// Whole shows of a rig that ships, under the stepped clock.
#include "tools/scenario/stepped_show.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/core/rig/listed_problems.h"
#include "tests/folders.h"
#include "tools/scenario/explore.h"
#include "tools/scenario/jobs.h"
#include "tools/scenario/outcome_text.h"
#include "tools/scenario/scenario_file.h"

namespace luxrig::scenario {
namespace {

const PreparedRig& gallery() {
  static const PreparedRig prepared = [] {
    PrepareOptions options;
    options.compute.max_error = options.max_truth_error = 0.05;
    auto made = prepare(test::source_folder() / "rigs/gallery", options);
    EXPECT_TRUE(made.has_value()) << (made ? "" : test::listed(made.error()));
    return std::move(*made);
  }();
  return prepared;
}

Scenario scenario_of(const std::string& events, double length_s = 30) {
  auto scenario = parse_scenario("[scenario]\nname = \"t\"\nlength_s = " + std::to_string(length_s) + "\n" + events,
                                 "t.toml", gallery().session->rig);
  EXPECT_TRUE(scenario.has_value()) << (scenario ? "" : test::listed(scenario.error()));
  return scenario ? *scenario : Scenario{};
}

/// What failed, in lines; empty if nothing did.
std::string failed(const Outcome& outcome) {
  std::string text = outcome.error;
  for (const auto* list : {&outcome.expectations, &outcome.rules})
    for (const Judged& one : *list)
      if (!one.held) text += one.expected + ": " + one.found + "\n";
  return text;
}

TEST(SteppedShow, ASolvedRigReachesItsGoalsAndKeepsWhatAlwaysHolds) {
  const Scenario scenario = scenario_of(
      "[[expect]]\nreached = \"phase holding\"\nwithin_s = 25\n[[expect]]\nalways = \"lux fern <= 50\"\n"
      "[[expect]]\nat_end = \"missed == 0\"\n");
  EXPECT_EQ(failed(run_stepped(gallery(), scenario, 1)), "");
}

/// The scenario in rigs/README.md, as a reader would copy it.
TEST(SteppedShow, TheExampleForReadersPasses) {
  std::ifstream page(test::source_folder() / "rigs/README.md");
  std::string text, line;
  while (std::getline(page, line) && line != "```toml") {
  }
  while (std::getline(page, line) && line != "```") text += line + "\n";
  const auto scenario = parse_scenario(text, "README.md", gallery().session->rig);
  ASSERT_TRUE(scenario.has_value()) << text << test::listed(scenario.error());
  EXPECT_EQ(scenario->expectations.size(), 2U);
  EXPECT_EQ(failed(run_stepped(gallery(), *scenario, 1)), "");
}

TEST(SteppedShow, ARandomShowIsTheSameAsItsFile) {
  const Rig& rig = gallery().session->rig;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Scenario show = random_show(rig, seed, 60);
    const auto read = parse_scenario(to_toml(show), show.file, rig);
    ASSERT_TRUE(read.has_value()) << to_toml(show) << test::listed(read.error());
    EXPECT_EQ(to_toml(*read), to_toml(show));
  }
}

TEST(SteppedShow, WhatIsNotSoFails) {
  const Scenario scenario = scenario_of(
      "[[expect]]\nalways = \"lux harbour < 20\"\nwhy = \"as a test\"\n[[expect]]\nreached = \"phase safe\"\n");
  const Outcome outcome = run_stepped(gallery(), scenario, 1);
  EXPECT_FALSE(outcome.passed());
  EXPECT_FALSE(outcome.expectations[0].held);
  EXPECT_FALSE(outcome.expectations[1].held);
  EXPECT_EQ(outcome.expectations[0].why, "as a test");
  EXPECT_GT(outcome.expectations[0].at_s, 0);
}

TEST(SteppedShow, AFaultRaisesItsAlarmAndEnds) {
  const Scenario scenario = scenario_of(
      "[[event]]\nname = \"it\"\nwhen = \"phase holding\"\nfault = \"silent\"\non = [\"meter-fern\"]\nfor_s = 5\n"
      "[[expect]]\nreached = \"alarm meter-fern\"\nafter = \"it\"\nwithin_s = 4\n"
      "[[expect]]\nnever = \"alarm meter-fern\"\nafter = \"it\"\nfrom_s = 9\n",
      40);
  EXPECT_EQ(failed(run_stepped(gallery(), scenario, 1)), "");
}

TEST(SteppedShow, CommandsAreGivenAndRefused) {
  const Scenario scenario = scenario_of(
      "[[event]]\nat_s = 5\ndo = \"blackout\"\nfor_s = 3\n"
      "[[event]]\nat_s = 15\ndo = \"level\"\non = [\"harbour-spot\"]\nvalue = 0.2\n"
      "[[event]]\nat_s = 16\ndo = \"park\"\nrefused = true\n"
      "[[expect]]\nalways = \"level * == 0\"\nfrom_s = 5.2\nwithin_s = 2\n"
      "[[expect]]\nat_end = \"level harbour-spot <= 0.201\"\n");
  EXPECT_EQ(failed(run_stepped(gallery(), scenario, 1)), "");
}

TEST(SteppedShow, ARefusedCommandFailsTheScenario) {
  const Scenario scenario = scenario_of("[[event]]\nat_s = 5\ndo = \"park\"\n");
  EXPECT_NE(run_stepped(gallery(), scenario, 1).error.find("line 4: park is refused"), std::string::npos);
}

TEST(SteppedShow, ADaemonThatDiesComesBackWithWhatWasOrdered) {
  const Scenario scenario = scenario_of(
      "[[event]]\nat_s = 10\ndo = \"level\"\non = [\"harbour-spot\"]\nvalue = 0.2\n"
      "[[event]]\nat_s = 20\ndo = \"kill\"\nfor_s = 2\n"
      "[[event]]\nat_s = 28\ndo = \"blackout\"\n"
      "[[event]]\nat_s = 30\ndo = \"power_cut\"\nfor_s = 1\n"
      "[[expect]]\nat_end = \"blackout\"\n",
      35);
  EXPECT_EQ(failed(run_stepped(gallery(), scenario, 1)), "");
}

TEST(SteppedShow, TheRoomIsJudgedAndGoesOnWhileNoDaemonRuns) {
  const Scenario scenario = scenario_of(
      "[[event]]\nat_s = 12\ndo = \"shade\"\non = [\"harbour\"]\nvalue = 0\nfor_s = 10\n"
      "[[event]]\nat_s = 20\ndo = \"kill\"\nfor_s = 6\n"
      "[[event]]\nat_s = 21\ndo = \"blackout\"\nrefused = true\n"
      "[[expect]]\nalways = \"lux harbour < 1\"\nfrom_s = 20.5\nwithin_s = 1\n"
      "[[expect]]\nat_end = \"lux harbour > 100\"\nfrom_s = 22\nwithin_s = 1\n");
  EXPECT_EQ(failed(run_stepped(gallery(), scenario, 1)), "");
  const Scenario wrong = scenario_of(
      "[[event]]\nat_s = 15\ndo = \"kill\"\nfor_s = 6\n"
      "[[expect]]\nalways = \"lux harbour < 20\"\nfrom_s = 17\nwithin_s = 2\n");
  EXPECT_FALSE(run_stepped(gallery(), wrong, 1).passed()) << "lamps hold their light without data";
}

TEST(SteppedShow, ADaemonThatIsStoppedLeavesTheSafeLook) {
  const Scenario scenario = scenario_of(
      "[[event]]\nat_s = 15\ndo = \"stop\"\nfor_s = 2\n[[expect]]\nreached = \"phase "
      "holding\"\nfrom_s = 20\n",
      45);
  EXPECT_EQ(failed(run_stepped(gallery(), scenario, 1)), "");
}

TEST(SteppedShow, ACoveredMeterAndAPersonInTheLightRaiseNoLimit) {
  const Scenario scenario = scenario_of(
      "[[event]]\nat_s = 15\ndo = \"cover\"\non = [\"meter-fern\"]\nvalue = 0.02\nfor_s = 10\n"
      "[[event]]\nat_s = 40\ndo = \"shade\"\non = [\"heron\"]\nvalue = 0.3\nfor_s = 10\n"
      "[[expect]]\nalways = \"lux fern <= 52\"\n",
      60);
  EXPECT_EQ(failed(run_stepped(gallery(), scenario, 2)), "");
}

TEST(SteppedShow, ADeskTakesOverAndTurnsAHeadThatStaysDarkWhereItMustNotShine) {
  auto prepared = prepare(test::source_folder() / "tests/rigs/visitors", {});
  ASSERT_TRUE(prepared.has_value()) << test::listed(prepared.error());
  const auto scenario = parse_scenario(R"([scenario]
name = "a desk"
length_s = 40
[[event]]
name = "the desk is there"
at_s = 12
do = "desk"
on = ["head", "bulb"]
value = 0.6
pan_deg = -90   # over the audience
tilt_deg = 55
for_s = 10
[[expect]]
reached = "level bulb >= 0.59"
after = "the desk is there"
within_s = 3
[[expect]]
at_end = "phase holding"
)",
                                       "desk.toml", prepared->session->rig);
  ASSERT_TRUE(scenario.has_value()) << test::listed(scenario.error());
  const Outcome outcome = run_stepped(*prepared, *scenario, 1);
  EXPECT_EQ(failed(outcome), "");
}

TEST(SteppedShow, AFaultOfTheWireIsNotPassedOver) {
  const Scenario scenario = scenario_of("[[event]]\nat_s = 5\nfault = \"reordered\"\non = [\"track\"]\n");
  EXPECT_NE(run_stepped(gallery(), scenario, 1).error.find("fault reordered is of the wire"), std::string::npos);
}

TEST(SteppedShow, TheSameSeedGivesTheSameBytesInAnyNumberOfProcesses) {
  const Scenario scenario = scenario_of(
      "[[event]]\nat_s = 8\nfault = \"lost\"\nvalue = 0.4\non = [\"conservation\"]\nfor_s = 5\n"
      "[[event]]\nat_s = 9\ndo = \"level\"\non = [\"venus-spot\"]\nvalue = 0.3\nfor_s = 8\n"
      "[[event]]\nat_s = 11\ndo = \"kill\"\nfor_s = 0.7\n"
      "[[expect]]\nalways = \"lux harbour < 100\"\n",
      20);
  const auto all = [&](int jobs) {
    std::string bytes;
    for (const Outcome& outcome :
         run_all(5, jobs, [&](std::size_t i) { return run_stepped(gallery(), scenario, i + 1, {true}); }))
      bytes += to_json(outcome).dump();
    return bytes;
  };
  const std::string one = all(1);
  EXPECT_EQ(one, all(2));
  EXPECT_EQ(one, all(4));
  EXPECT_EQ(one.find("died"), std::string::npos);
}

TEST(SteppedShow, ADeadWorkerIsAnErrorOfItsRunsOnly) {
  const auto outcomes = run_all(4, 2, [](std::size_t i) {
    if (i == 1) std::_Exit(3);
    Outcome outcome;
    outcome.seed = i;
    return outcome;
  });
  EXPECT_TRUE(outcomes[0].passed());
  EXPECT_EQ(outcomes[1].error, "its process died");
  EXPECT_TRUE(outcomes[2].passed());
  EXPECT_EQ(outcomes[3].error, "its process died");
}

TEST(Results, AreJsonAndJunit) {
  const Scenario scenario = scenario_of("[[expect]]\nalways = \"lux harbour < 20\"\n");
  Outcome bad;
  bad.expectations = {{"always lux harbour < 20", false, 3.5, "lux of harbour is 21 lx", "", 5}};
  bad.rules = {{"light does not jump", true, {}, "", "", 0}};
  const std::vector<Tested> tested = {{scenario, {bad}}};
  const auto results = nlohmann::json::parse(results_json("gallery", tested));
  EXPECT_EQ(results["passed"], false);
  EXPECT_EQ(results["scenarios"][0]["runs"][0]["expectations"][0]["at_s"], 3.5);
  const std::string xml = junit_xml("gallery", tested);
  EXPECT_NE(xml.find("<testsuite name=\"t\" tests=\"2\" failures=\"1\">"), std::string::npos) << xml;
  EXPECT_NE(xml.find("lux harbour &lt; 20, seed 1"), std::string::npos) << xml;
  EXPECT_NE(xml.find("<failure message=\"at 3.50 s: lux of harbour is 21 lx\"/>"), std::string::npos) << xml;
}

}  // namespace
}  // namespace luxrig::scenario
