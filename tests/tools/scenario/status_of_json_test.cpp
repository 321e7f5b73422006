// What the daemon says of itself, written by the daemon's own code and read back; and what is no status.
#include "tools/scenario/status_of_json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/tools/scenario/small_rig.h"
#include "tools/luxrigd/api/status_json.h"

namespace luxrig::scenario {
namespace {

using nlohmann::json;

const Rig& rig() {
  static const Rig named = [] {
    Rig small = small_rig();
    small.luminaires.resize(1);  // the status tells each fixture's
    return small;
  }();
  return named;
}

ShowStatus full_status() {
  ShowStatus show;
  show.phase = Phase::correcting;
  show.blackout = true;
  show.plan_waits = true;
  show.goals = {3, 1, 32};
  show.points.resize(rig().points.size());
  show.points[0].goal_lx = 150.25;
  show.points[0].verdict = Verdict::met;
  show.fixtures.resize(rig().fixtures.size());
  show.fixtures[1].level = 0.375;
  show.alarms.push_back({true, "dmx", "does not answer", Time{}});
  DeskStatus desk;
  desk.name = rig().buses[1].name + ", universe 1";
  desk.silent = true;
  show.desks.push_back(desk);
  show.by_hand.push_back({ByHand::What::level, 2, 0.1, Time{}, Time{} + std::chrono::seconds(90)});
  show.by_hand.push_back({ByHand::What::goal, 4, 80, Time{}, {}, false, true});
  return show;
}

std::string written(const ShowStatus& show, const std::optional<AskedQuestion>& question = {}) {
  std::vector<Health> devices;
  for (const Bus& bus : rig().buses) {
    Health health;
    health.device = bus.name;
    health.life = Life::active;
    health.sent = 1234;
    devices.push_back(health);
  }
  const Time now = Time{} + std::chrono::seconds(30);
  return status_json({.rig = rig(),
                      .show = show,
                      .devices = devices,
                      .output = {},
                      .simulated = true,
                      .started = Time{} + std::chrono::seconds(10),
                      .now = now,
                      .sim_control = {},
                      .question = question});
}

TEST(StatusOfJson, IsWhatTheDaemonWrote) {
  const ShowStatus show = full_status();
  const auto read = status_of_json(written(show), rig());
  ASSERT_TRUE(read.has_value()) << read.error().detail;
  EXPECT_EQ(read->time_s, 20);
  EXPECT_EQ(read->show.phase, Phase::correcting);
  EXPECT_TRUE(read->show.blackout);
  EXPECT_TRUE(read->show.plan_waits);
  EXPECT_EQ(read->show.goals.met, 3);
  EXPECT_EQ(read->show.goals.missed, 1);
  EXPECT_EQ(read->show.goals.unknown, 32);
  EXPECT_EQ(read->show.points[0].goal_lx, 150.25);
  EXPECT_TRUE(read->show.points[0].met());
  EXPECT_FALSE(read->show.points[1].goal_lx.has_value());
  EXPECT_EQ(read->show.fixtures[1].level, 0.375);
  ASSERT_EQ(read->show.alarms.size(), 1U);
  EXPECT_TRUE(read->show.alarms[0].severe);
  EXPECT_EQ(read->show.alarms[0].device + ": " + read->show.alarms[0].text, "dmx: does not answer");
  ASSERT_EQ(read->show.by_hand.size(), 2U);
  EXPECT_EQ(read->show.by_hand[0].what, ByHand::What::level);
  EXPECT_EQ(read->show.by_hand[0].index, 2U);
  EXPECT_EQ(read->show.by_hand[0].value, 0.1);
  EXPECT_TRUE(read->show.by_hand[0].until.has_value());
  EXPECT_EQ(read->show.by_hand[1].what, ByHand::What::goal);
  EXPECT_EQ(read->show.by_hand[1].index, 4U);
  EXPECT_TRUE(read->show.by_hand[1].of_plan);
  EXPECT_FALSE(read->show.by_hand[1].until.has_value());
  EXPECT_EQ(read->sent, std::vector<std::uint64_t>(rig().buses.size(), 1234));
  EXPECT_EQ(read->sends, (std::vector<bool>{true, false, true})) << "it is silent beside a desk";
}

TEST(StatusOfJson, HasTheQuestionOfAClientUntilItsTime) {
  EXPECT_FALSE(json::parse(written(full_status())).contains("question"));
  AskedQuestion asked;
  asked.question.id = "a-1";
  asked.question.text = "hold it here";
  asked.question.position_world_m = {1, 2, 0.8};
  asked.until = Time{} + std::chrono::seconds(75);
  asked.answer = HandAnswer{HandAnswer::What::reading, 182.5};
  const std::string text = written(full_status(), asked);
  const json question = json::parse(text)["question"];
  EXPECT_EQ(question["id"], "a-1");
  EXPECT_EQ(question["text"], "hold it here");
  EXPECT_EQ(question["position"], json::array({1, 2, 0.8}));
  EXPECT_EQ(question["normal"], json::array({0, 0, 1}));
  EXPECT_EQ(question["remaining_s"], 45);
  EXPECT_EQ(question["answer"], (json{{"what", "reading"}, {"lux", 182.5}}));
  EXPECT_FALSE(question.contains("fixture")) << "every lamp is dark";
  EXPECT_TRUE(status_of_json(text, rig()));
}

/// What is said of the status with one place of it changed.
std::string refused(const char* place, const json& instead) {
  json status = json::parse(written(full_status()));
  status[json::json_pointer(place)] = instead;
  const auto read = status_of_json(status.dump(), rig());
  return read ? "taken" : read.error().detail;
}

TEST(StatusOfJson, OfAnyOtherKindIsRefused) {
  const char* const said = "the daemon's status has no good \"";
  EXPECT_EQ(refused("/phase", "dancing"), std::string(said) + "phase\"");
  EXPECT_EQ(refused("/phase", 7), std::string(said) + "phase\"");
  EXPECT_EQ(refused("/blackout", "yes"), std::string(said) + "blackout\"");
  EXPECT_EQ(refused("/time_s", nullptr), std::string(said) + "time_s\"");
  EXPECT_EQ(refused("/goals", json::array()), std::string(said) + "met\"");
  EXPECT_EQ(refused("/goals/missed", -1), std::string(said) + "missed\"");
  EXPECT_EQ(refused("/goals/missed", 1e300), std::string(said) + "missed\"");
  EXPECT_EQ(refused("/points", json::array()), std::string(said) + "points\"");
  EXPECT_EQ(refused("/points/3", 5), std::string(said) + "name\"");
  EXPECT_EQ(refused("/points/3/name", "elsewhere"), std::string(said) + "points\"");
  EXPECT_EQ(refused("/points/3/goal_lux", "much"), std::string(said) + "goal_lux\"");
  EXPECT_EQ(refused("/points/3/verdict", "good"), std::string(said) + "verdict\"");
  EXPECT_EQ(refused("/fixtures/0/level", json::object()), std::string(said) + "level\"");
  EXPECT_EQ(refused("/alarms", "none"), std::string(said) + "alarms\"");
  EXPECT_EQ(refused("/alarms/0", "fire"), std::string(said) + "severe\"");
  EXPECT_EQ(refused("/overrides/0/kind", "colour"), std::string(said) + "overrides\"");
  EXPECT_EQ(refused("/overrides/0/name", "nobody"), std::string(said) + "overrides\"");
  EXPECT_EQ(refused("/overrides/0/remaining_s", -5), std::string(said) + "remaining_s\"");
  EXPECT_EQ(refused("/devices/0/sent", -1), std::string(said) + "sent\"");
  EXPECT_EQ(status_of_json("", rig()).error().detail, "the daemon's status is no JSON object");
  EXPECT_EQ(status_of_json("[1,2]", rig()).error().detail, "the daemon's status is no JSON object");
  EXPECT_EQ(status_of_json(std::string(100'000, '['), rig()).error().detail, "the daemon's status is no JSON object");
}

}  // namespace
}  // namespace luxrig::scenario
