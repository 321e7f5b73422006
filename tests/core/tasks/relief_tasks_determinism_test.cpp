// relief_tasks: the same for any number of threads.
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/tasks/solve_tasks.h"
#include "tests/core/tasks/opened_rigs.h"
#include "tests/core/tasks/relief_tasks_fixture.h"

namespace luxrig {
namespace {

using namespace relief_tasks_fixture;

TEST_F(AimTask, GivesTheSamePlanForASeedWithAnyNumberOfThreads) {
  const Session session = well(with_limit(kWellRig, 60) + kAim + "max_object_lx = 300\n");
  std::string first;
  for (const int threads : {1, 2}) {
    ComputeOptions options;
    options.threads = threads;
    options.seed = 7;
    options.max_error = 0.05;
    const SolvedTasks solved = solved_of(session, options);
    EXPECT_GT(levels_of(solved).maxCoeff(), 0);
    if (first.empty()) first = text_of(solved.plan);
    EXPECT_EQ(text_of(solved.plan), first) << threads;
  }
}

TEST_F(HighlightTask, GivesTheSamePlanForASeedWithAnyNumberOfThreads) {
  const Session session = well(with_limit(kWellRig, 60) + kHighlight);
  std::string first;
  for (const int threads : {1, 2}) {
    ComputeOptions options;
    options.threads = threads;
    options.seed = 7;
    options.max_error = 0.05;
    const SolvedTasks solved = solved_of(session, options);
    EXPECT_EQ(solved.plan.tasks[0].lights.size(), 2);
    if (first.empty()) first = text_of(solved.plan);
    EXPECT_EQ(text_of(solved.plan), first) << threads;
  }
}

TEST_F(ReliefTask, GivesTheSameDirectionsForASeedWithAnyNumberOfThreads) {
  const Session session =
      well(std::string(kWellRig) + "[[task]]\nname = \"held\"\nkind = \"directions\"\nobject = \"slab\"\nlights = 2\n");
  std::string first;
  for (const int threads : {1, 2}) {
    ComputeOptions options = direct_light();
    options.threads = threads;
    const SolvedTasks solved = solved_of(session, options);
    EXPECT_EQ(solved.plan.tasks[0].directions.size(), 2);
    if (first.empty()) first = text_of(solved.plan);
    EXPECT_EQ(text_of(solved.plan), first) << threads;
  }
}

}  // namespace
}  // namespace luxrig
