// What a rig file asks, done as values: a result, the end in the middle, a refusal, and the same for a seed.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "core/tasks/rig_notes/rig_notes.h"
#include "core/tasks/solve_tasks.h"
#include "tests/core/tasks/opened_rigs.h"

namespace luxrig {
namespace {

constexpr const char* kLevels = "[[task]]\nname = \"levels\"\nkind = \"emittance\"\n";

std::filesystem::path room_folder() { return test::source_folder() / "tests/rigs/room"; }

std::string room_text() {
  std::ifstream in(room_folder() / "rig.toml");
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

Session opened(const std::string& text) { return opened_rig(text, room_folder()); }

/// Two bulbs somewhere under the ceiling, in place of the tasks of the room.
std::string room_with_places() {
  return replaced(room_text(), kLevels,
                  "[mounting]\nsurfaces = [\"ceiling\"]\noffset_m = [0.1, 0.3]\n\n"
                  "[[task]]\nname = \"bulbs\"\nkind = \"placement\"\nluminaire = \"bulb\"\nlights = 2\n"
                  "fixtures = \"off\"\nseconds = 60\n");
}

TEST(Session, OfARigWithALampInAPointIsRefused) {
  const auto session =
      open_rig(replaced(room_text(), "position_m = [-1.5, 0.0, 2.9]", "position_m = [1.5, -1.0, 0.0]"), room_folder());
  ASSERT_FALSE(session);
  EXPECT_NE(session.error()[0].text().find("\"floor\""), std::string::npos) << session.error()[0].text();
}

TEST(Session, WithoutItsMeshIsRefused) {
  const auto session = open_rig(replaced(room_text(), "file = \"room.obj\"", "file = \"hall.obj\""), room_folder());
  ASSERT_FALSE(session);
  EXPECT_NE(session.error()[0].text().find("hall.obj"), std::string::npos) << session.error()[0].text();
}

TEST(ComputeTransport, TellsItsStageAndReachesTheErrorWanted) {
  const Session session = opened(room_text());
  std::vector<Doing> told;
  ComputeOptions options;
  options.stage = "light of the room";
  options.watch.tell = [&](const Doing& doing) { told.push_back(doing); };
  ModelUsed used;
  const TransportMatrix transport = transport_of(session, options, &used);
  EXPECT_EQ(transport.receivers(), 4);
  EXPECT_EQ(transport.emitters(), 3);
  EXPECT_TRUE(used.reached()) << used.rms_error;
  EXPECT_LE(used.rms_error, 0.01);
  ASSERT_GE(told.size(), 2);
  EXPECT_EQ(told.front().stage, "light of the room");
  EXPECT_TRUE(told.back().ended);
}

TEST(ComputeTransport, EndsWhenItsTimeIsUpAndSaysSo) {
  const Session session = opened(room_text());
  ComputeOptions options;
  options.model = Model::gather;
  options.max_error = 1e-9;  // for ever
  options.error_floor_lx = 1e-9;
  options.max_seconds = 0.2;
  ModelUsed used;
  const TransportMatrix transport = transport_of(session, options, &used);
  EXPECT_TRUE(used.time_was_up);
  EXPECT_FALSE(used.reached());
  EXPECT_NE(used.warning().find("0.2 s"), std::string::npos) << used.warning();
  EXPECT_GT(transport.lux_per_level.minCoeff(), 0) << "what it has by then";
}

TEST(ComputeTransport, EndsWhenAskedWhileItRuns) {
  const Session session = opened(room_text());
  ComputeOptions options;
  options.model = Model::gather;
  options.max_error = options.error_floor_lx.emplace(1e-9);
  options.max_seconds = 0;
  std::stop_source person;
  options.watch.stop = person.get_token();
  options.watch.tell = [&](const Doing& doing) {
    if (doing.what.ends_with('%')) person.request_stop();  // it is under way
  };
  const auto transport = compute_transport(session, options);
  ASSERT_FALSE(transport);
  EXPECT_EQ(transport.error().cause, Cause::cancelled);
}

TEST(SolveTasks, SetsLevelsThatGiveThePointsTheirGoals) {
  const Session session = opened(room_text());
  const TransportMatrix transport = transport_of(session, {});
  const auto solved = solve_tasks(session, transport, {});
  ASSERT_TRUE(solved) << solved.error().detail;
  ASSERT_EQ(solved->plan.tasks.size(), 1);
  Eigen::VectorXd level(3);
  for (std::size_t j = 0; j < 3; ++j) level[static_cast<Eigen::Index>(j)] = solved->plan.tasks[0].lights[j].level;
  const Eigen::VectorXd lux = transport.lux(level);
  for (std::size_t i = 0; i < 2; ++i) {
    const PlannedPoint& point = solved->plan.points[i];
    EXPECT_DOUBLE_EQ(point.lux, lux[static_cast<Eigen::Index>(i)]) << point.name;
    EXPECT_NEAR(point.lux, *point.goal_lux, 0.01 * *point.goal_lux) << point.name;
  }
}

TEST(SolveTasks, RefusesWhereLightThatStaysIsAboveALimit) {
  const Session session = opened(replaced(room_with_places(), "fixtures = \"off\"", "fixtures = \"full\""));
  const auto solved = solve_tasks(session, transport_of(session, {}), {});
  ASSERT_FALSE(solved);
  EXPECT_EQ(solved.error().cause, Cause::invalid);
  EXPECT_NE(solved.error().detail.find("plinth-top"), std::string::npos) << solved.error().detail;
}

TEST(SolveTasks, PlacesLightsTheSameForASeedAndAnyNumberOfThreads) {
  const Session session = opened(room_with_places());
  const double ceiling_m = room_of(session.rig, session.scene).max().z();
  const TransportMatrix transport = transport_of(session, {});
  std::string first;
  for (const int threads : {1, 2}) {
    ComputeOptions options;
    options.threads = threads;
    options.seed = 7;
    const auto solved = solve_tasks(session, transport, options);
    ASSERT_TRUE(solved) << solved.error().detail;
    ASSERT_EQ(solved->plan.tasks[0].lights.size(), 2);
    EXPECT_EQ(solved->rig.fixtures.size(), session.rig.fixtures.size() + 2);
    Eigen::VectorXd level = Eigen::VectorXd::Zero(5);
    for (std::size_t l = 0; l < 2; ++l) {
      const PlannedLight& light = solved->plan.tasks[0].lights[l];
      EXPECT_GE(light.position_world_m.z(), ceiling_m - 0.3 - 1e-6);
      EXPECT_LE(light.position_world_m.z(), ceiling_m - 0.1 + 1e-6);
      level[static_cast<Eigen::Index>(3 + l)] = light.level;
    }
    const Eigen::VectorXd lux = solved->transport.lux(level);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_DOUBLE_EQ(solved->plan.points[i].lux, lux[static_cast<Eigen::Index>(i)]);
      EXPECT_GT(lux[static_cast<Eigen::Index>(i)], 30) << "two bulbs of 800 lm in a small room";
    }
    if (first.empty()) first = text_of(solved->plan);
    EXPECT_EQ(text_of(solved->plan), first) << threads;
  }
}

TEST(SolveTasks, ASearchEndedByAPersonGivesItsBestSoFar) {
  const Session session = opened(room_with_places());
  const TransportMatrix transport = transport_of(session, {});
  ComputeOptions options;
  std::stop_source person;
  options.watch.stop = person.get_token();
  std::vector<std::string> bests;
  options.watch.tell = [&](const Doing& doing) {
    if (doing.stage != "bulbs" || !doing.what.ends_with('%')) return;
    bests.push_back(doing.what);
    person.request_stop();
  };
  const auto solved = solve_tasks(session, transport, options);
  ASSERT_FALSE(bests.empty()) << "it tells the best it has";
  ASSERT_TRUE(solved) << solved.error().detail;
  EXPECT_FALSE(solved->plan.tasks[0].lights.empty());
}

TEST(SolveWhatHangs, LeavesOutPlacesAndLightsWhatHangs) {
  const Session session = opened(room_with_places());
  const auto solved = solve_what_hangs(session, transport_of(session, {}), {});
  ASSERT_TRUE(solved) << solved.error().detail;
  ASSERT_EQ(solved->plan.tasks.size(), 1);
  EXPECT_EQ(solved->plan.tasks[0].lights.size(), 3);
  EXPECT_EQ(solved->rig.fixtures.size(), 3);
}

TEST(LightModel, HasTheTransportOfPointsAndMetersApart) {
  const Session session = opened(room_text());
  const TransportMatrix transport = transport_of(session, {});
  const LightModel model = light_model(session.rig, transport);
  EXPECT_EQ(model.point_lux_per_level, transport.lux_per_level.topRows(2));
  EXPECT_EQ(model.meter_lux_per_level, transport.lux_per_level.bottomRows(2));
}

}  // namespace
}  // namespace luxrig
