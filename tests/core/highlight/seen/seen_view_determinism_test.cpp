/// see_object: the same for any number of threads.
#include <gtest/gtest.h>

#include "tests/core/highlight/seen/seen_fixture.h"

namespace luxrig {
namespace {

TEST(SeenView, DoesNotDependOnTheThreads) {
  const RayScene object(torus(0.5, 0.2, 60, 30));
  std::vector<SeenView> views;
  for (const int threads : {1, 2, 5}) {
    SeenViewOptions options;
    options.threads = threads;
    views.push_back(*see_object(object, object, {1, -2, 1}, options));
  }
  for (const SeenView& view : views) {
    EXPECT_EQ(view.sample_of_pixel, views[0].sample_of_pixel);
    EXPECT_EQ(view.reflectance, views[0].reflectance);
    ASSERT_EQ(view.samples.size(), views[0].samples.size());
    for (std::size_t s = 0; s < view.samples.size(); ++s)
      EXPECT_EQ(view.samples[s].position_world_m, views[0].samples[s].position_world_m);
  }
}

}  // namespace
}  // namespace luxrig
