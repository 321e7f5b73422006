#include "tools/scenario/scenario_file.h"

#include <gtest/gtest.h>

#include "tests/core/rig/listed_problems.h"
#include "tests/tools/scenario/small_rig.h"
#include "tools/scenario/condition.h"

namespace luxrig::scenario {
namespace {

Scenario parsed(const std::string& text) {
  auto scenario = parse_scenario(text, "tests/show.toml", small_rig());
  EXPECT_TRUE(scenario.has_value()) << text << (scenario ? "" : test::listed(scenario.error()));
  return scenario ? *scenario : Scenario{};
}

TEST(ScenarioFile, IsReadWhole) {
  const Scenario s = parsed(R"([scenario]
name = "a meter goes blind"
length_s = 60
seeds = "3, 1..2"
deviations = "none,output_min=0.7,output_max=0.8"
start = "dark"

[[event]]
name = "begin"
at_s = 1
do = "apply"
plan = "evening.json"

[[event]]
when = "phase holding"
after_s = 2
fault = "lying"
on = ["meter-*"]
value = 0.3
for_s = 5

[[event]]
after = "begin"
after_s = 9
do = "level"
on = ["spot-2", "spot-1"]
value = 0.25
refused = true

[[expect]]
always = "lux work-? <= 50 lx"
after = "begin"
from_s = 3
within_s = 20
why = "paper fades"
)");
  EXPECT_EQ(s.file, "tests/show.toml");
  EXPECT_EQ(s.name, "a meter goes blind");
  EXPECT_EQ(s.length_s, 60);
  EXPECT_EQ(s.seeds, (std::vector<std::uint64_t>{1, 2, 3}));
  EXPECT_EQ(s.deviations.output_min, 0.7);
  EXPECT_EQ(s.deviations.meter_noise, 0);
  EXPECT_TRUE(s.starts_dark);
  ASSERT_EQ(s.events.size(), 3U);
  EXPECT_EQ(s.events[0].what, Event::What::apply);
  EXPECT_EQ(s.events[0].plan, "tests/evening.json");
  EXPECT_EQ(s.events[1].fault, sim::FaultKind::lying);
  EXPECT_EQ(s.events[1].on.size(), 6U);
  EXPECT_EQ(s.events[1].when->phase, Phase::holding);
  EXPECT_EQ(s.events[1].at_s, 2);
  EXPECT_EQ(s.events[1].for_s, 5);
  EXPECT_EQ(s.events[2].after, 0U);
  EXPECT_EQ(s.events[2].on, (std::vector<std::string>{"spot-2", "spot-1"}));
  EXPECT_TRUE(s.events[2].refused);
  ASSERT_EQ(s.expectations.size(), 1U);
  const Expectation& e = s.expectations[0];
  EXPECT_EQ(e.text(), "always lux work-? <= 50 lx");
  EXPECT_EQ(e.condition.which, (std::vector<std::size_t>{0, 1, 2, 3}));
  EXPECT_EQ(e.condition.relation, Condition::Relation::at_most);
  EXPECT_EQ(e.condition.value, 50);
  EXPECT_EQ(e.after, 0U);
  EXPECT_EQ(e.from_s, 3);
  EXPECT_EQ(e.within_s, 20);
  EXPECT_EQ(e.why, "paper fades");
}

TEST(ScenarioFile, NamesInQuotesMayHaveSpaces) {
  Rig rig = small_rig();
  rig.points[7].name = "shelf 2, top";
  ProblemList problems("show.toml");
  const auto condition = parse_condition("lux 'shelf 2, top' > 5", {1, 1}, rig, problems);
  ASSERT_TRUE(condition.has_value());
  EXPECT_EQ(condition->which, (std::vector<std::size_t>{7}));
}

TEST(ScenarioFile, AnAlarmsTextIsTheRestOfTheLine) {
  ProblemList problems("show.toml");
  const auto condition = parse_condition("alarm meter-1: does not  answer", {1, 1}, small_rig(), problems);
  ASSERT_TRUE(condition.has_value());
  EXPECT_EQ(condition->text, "meter-1: does not  answer");
}

TEST(Seeds, AreNumbersAndRanges) {
  EXPECT_EQ(parse_seeds("7"), (std::vector<std::uint64_t>{7}));
  EXPECT_EQ(parse_seeds("2..4"), (std::vector<std::uint64_t>{2, 3, 4}));
  EXPECT_EQ(parse_seeds(" 9, 2..3 ,2"), (std::vector<std::uint64_t>{2, 3, 9}));
  EXPECT_EQ(parse_seeds("18446744073709551615").size(), 1U);
  EXPECT_EQ(parse_seeds("18446744073709551614..18446744073709551615").size(), 2U);
  for (const char* bad : {"", " ", "a", "1..", "..2", "3..2", "1;2", "1,", "1..200000", "-1", "1.5"})
    EXPECT_TRUE(parse_seeds(bad).empty()) << bad;
}

}  // namespace
}  // namespace luxrig::scenario
