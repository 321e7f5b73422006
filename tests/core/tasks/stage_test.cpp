// Watchers get the progress of a stage. A time limit or the user ends it.
#include "core/tasks/stage.h"

#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <limits>

namespace luxrig {
namespace {

/// Waits for a stop request, which must come. The limit is minutes only for a stalled machine.
bool is_requested(const std::stop_token& token) {
  std::promise<void> requested;
  const std::stop_callback on_request(token, [&] { requested.set_value(); });
  return requested.get_future().wait_for(std::chrono::minutes(2)) == std::future_status::ready;
}

TEST(Stage, ReportsItsStartProgressAndEnd) {
  std::vector<Doing> told;
  {
    const Stage stage({{}, {}, [&](const Doing& doing) { told.push_back(doing); }}, "places", "looking");
    stage.say("3 lights");
  }
  ASSERT_EQ(told.size(), 3);
  for (const Doing& doing : told) EXPECT_EQ(doing.stage, "places");
  EXPECT_EQ(told[0].what, "looking");
  EXPECT_EQ(told[1].what, "3 lights");
  EXPECT_FALSE(told[1].ended);
  EXPECT_TRUE(told[2].ended);
}

TEST(Stage, StopsWhenItsTimeIsUp) {
  const Stage stage({}, "transport", "starting", 0.01);
  EXPECT_TRUE(is_requested(stage.stop()));
  EXPECT_TRUE(stage.time_is_up());
}

TEST(Stage, StopsWhenAskedWithoutItsTimeBeingUp) {
  std::stop_source outside;
  const Stage stage({outside.get_token(), {}}, "transport", "starting", 3600);
  EXPECT_FALSE(stage.stop().stop_requested());
  outside.request_stop();
  EXPECT_TRUE(stage.stop().stop_requested());
  EXPECT_FALSE(stage.time_is_up());
}

TEST(Stage, StatesWhetherAStopKeepsTheBestSoFar) {
  std::vector<bool> told;
  const Tell tell = [&](const Doing& doing) { told.push_back(doing.can_be_taken); };
  const std::stop_source person;
  { const Stage search({person.get_token(), {}, tell}, "places", "looking"); }
  { const Stage transport({{}, {}, tell}, "transport", "starting", 3600); }
  EXPECT_EQ(told, (std::vector<bool>{true, true, false, false}));
}

TEST(Stage, StartedAfterTheStopIsStopped) {
  std::stop_source outside;
  outside.request_stop();
  const Stage stage({outside.get_token(), {}}, "transport", "starting");
  EXPECT_TRUE(stage.stop().stop_requested());
}

TEST(Stage, EndsAtOnceWithAnyTimeLimit) {
  for (const double seconds : {0.0, -1.0, 1e300, std::numeric_limits<double>::infinity()}) {
    const Stage stage({}, "transport", "starting", seconds);
    if (seconds <= 0) {
      EXPECT_TRUE(is_requested(stage.stop())) << seconds;
    }
  }
}

}  // namespace
}  // namespace luxrig
