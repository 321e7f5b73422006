/// choose_lights: the same for any number of threads.
#include <gtest/gtest.h>

#include "core/solve/placement/search/choose_lights.h"
#include "tests/core/solve/placement/choose_lights_fixture.h"
#include "tests/core/solve/placement/lit_hall.h"

namespace luxrig {
namespace {

using namespace choose_lights_fixture;

TEST(ChooseLights, IsTheSameForAnyNumberOfThreadsAndKeepsTheBestWhenStopped) {
  const LitHall hall(make_box_room(2), 0.4);
  LightingGoal goal;
  goal.lux = Eigen::VectorXd::Constant(hall.light->points(), 200);
  const ComplementSearch candidates(hall.view(), hall.poses, goal);
  ChooseOptions options = choose_most(6);
  options.max_columns = 3000;
  options.exchange.threads = 1;
  const LightCurve one = choose_lights(*hall.light, goal, candidates, options);
  options.exchange.threads = 4;
  const LightCurve four = choose_lights(*hall.light, goal, candidates, options);
  ASSERT_EQ(one.cuts.size(), four.cuts.size());
  for (std::size_t k = 0; k < one.cuts.size(); ++k) EXPECT_EQ(one.cuts[k].poses(), four.cuts[k].poses());

  std::stop_source stop;
  options.exchange.watch.stop = stop.get_token();
  options.better = [&](const PlacedLights& best, std::size_t) {
    if (best.size() == 2) stop.request_stop();
  };
  const LightCurve stopped = choose_lights(*hall.light, goal, candidates, options);
  EXPECT_GE(stopped.cuts.size(), 3u);
  EXPECT_LT(stopped.columns, one.columns);
}

}  // namespace
}  // namespace luxrig
