#include "core/show/controller/solve_beside.h"

#include <gtest/gtest.h>

#include "tests/scenarios/hall.h"

namespace luxrig {
namespace {

class SolveBesideTest : public testing::Test {
 protected:
  scenarios::Hall hall = scenarios::make_hall(1);
  GainEstimator estimator{hall.rig, hall.model};
  std::vector<std::function<void()>> waiting;
  SolveBeside solving;

  void start(SolveBeside::For what) { solving.start(what, estimator, hall.plan, Time{}); }
};

TEST_F(SolveBesideTest, WithoutARunnerItIsDoneAtOnce) {
  EXPECT_FALSE(solving.running());
  start(SolveBeside::For::round);
  ASSERT_TRUE(solving.done());
  const SolveBeside::Solved solved = solving.take();
  EXPECT_EQ(solved.what, SolveBeside::For::round);
  EXPECT_TRUE(solved.holds);
  EXPECT_EQ(solved.correction.level, estimator.correct(hall.plan, Time{}).level);
  EXPECT_FALSE(solving.running());
}

TEST_F(SolveBesideTest, WithARunnerItIsDoneWhenThatHasRun) {
  solving.use([this](std::function<void()> task) { waiting.push_back(std::move(task)); });
  start(SolveBeside::For::hands);
  EXPECT_TRUE(solving.running());
  EXPECT_FALSE(solving.done());
  EXPECT_EQ(solving.what(), SolveBeside::For::hands);
  waiting.front()();
  ASSERT_TRUE(solving.done());
  EXPECT_EQ(solving.take().correction.level, estimator.correct(hall.plan, Time{}, SolveBeside::For::hands).level);
}

TEST_F(SolveBesideTest, AChangedFactOutdatesIt) {
  start(SolveBeside::For::drift);
  solving.facts_changed();
  EXPECT_FALSE(solving.take().holds);
}

TEST_F(SolveBesideTest, ADroppedTaskMayStillRun) {
  solving.use([this](std::function<void()> task) { waiting.push_back(std::move(task)); });
  start(SolveBeside::For::round);
  solving.drop();
  EXPECT_FALSE(solving.running());
  start(SolveBeside::For::hands);
  waiting[0]();  // the dropped one
  EXPECT_FALSE(solving.done());
  waiting[1]();
  EXPECT_EQ(solving.take().what, SolveBeside::For::hands);
}

}  // namespace
}  // namespace luxrig
