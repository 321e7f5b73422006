// tasks: the same for any number of threads.
#include <gtest/gtest.h>

#include "core/tasks/rig_notes/rig_notes.h"
#include "core/tasks/solve_tasks.h"
#include "tests/core/tasks/opened_rigs.h"
#include "tests/core/tasks/tasks_fixture.h"

namespace luxrig {
namespace {

using namespace tasks_fixture;

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

}  // namespace
}  // namespace luxrig
