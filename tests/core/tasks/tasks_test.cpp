// The tasks of a rig file as values: a result, a stop midway, a refusal, and the same result for the same seed.
#include <gtest/gtest.h>

#include "core/tasks/solve_tasks.h"
#include "tests/core/tasks/opened_rigs.h"
#include "tests/core/tasks/tasks_fixture.h"

namespace luxrig {
namespace {

using namespace tasks_fixture;

TEST(Session, IsRefusedForALampAtAPoint) {
  const auto session =
      open_rig(replaced(room_text(), "position_m = [-1.5, 0.0, 2.9]", "position_m = [1.5, -1.0, 0.0]"), room_folder());
  ASSERT_FALSE(session);
  EXPECT_NE(session.error()[0].text().find("\"floor\""), std::string::npos) << session.error()[0].text();
}

TEST(Session, IsRefusedWithoutItsMesh) {
  const auto session = open_rig(replaced(room_text(), "file = \"room.obj\"", "file = \"hall.obj\""), room_folder());
  ASSERT_FALSE(session);
  EXPECT_NE(session.error()[0].text().find("hall.obj"), std::string::npos) << session.error()[0].text();
}

TEST(ComputeTransport, ReportsItsStageAndReachesTheWantedError) {
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

TEST(ComputeTransport, EndsWhenItsTimeIsUpAndReportsIt) {
  const Session session = opened(room_text());
  ComputeOptions options;
  options.model = Model::gather;
  options.max_error = 1e-9;  // never reached
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

TEST(SolveTasks, SetsLevelsThatMeetTheGoals) {
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

TEST(SolveTasks, RefusesWhenFixedLightExceedsALimit) {
  const Session session = opened(replaced(room_with_places(), "fixtures = \"off\"", "fixtures = \"full\""));
  const auto solved = solve_tasks(session, transport_of(session, {}), {});
  ASSERT_FALSE(solved);
  EXPECT_EQ(solved.error().cause, Cause::invalid);
  EXPECT_NE(solved.error().detail.find("plinth-top"), std::string::npos) << solved.error().detail;
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

TEST(SolveWhatHangs, SkipsPlacementsAndLightsExistingFixtures) {
  const Session session = opened(room_with_places());
  const auto solved = solve_what_hangs(session, transport_of(session, {}), {});
  ASSERT_TRUE(solved) << solved.error().detail;
  ASSERT_EQ(solved->plan.tasks.size(), 1);
  EXPECT_EQ(solved->plan.tasks[0].lights.size(), 3);
  EXPECT_EQ(solved->rig.fixtures.size(), 3);
}

TEST(LightModel, SeparatesTheTransportOfPointsAndMeters) {
  const Session session = opened(room_text());
  const TransportMatrix transport = transport_of(session, {});
  const LightModel model = light_model(session.rig, transport);
  EXPECT_EQ(model.point_lux_per_level, transport.lux_per_level.topRows(2));
  EXPECT_EQ(model.meter_lux_per_level, transport.lux_per_level.bottomRows(2));
}

}  // namespace
}  // namespace luxrig
