/// relief_lights: the same for any number of threads.
#include <gtest/gtest.h>

#include <cstring>

#include "core/highlight/distant/relief_lights.h"
#include "core/highlight/surface/relief_study.h"
#include "tests/core/highlight/distant/relief_lights_fixture.h"
#include "tests/core/highlight/shapes.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

using namespace relief_lights_fixture;

TEST(ReliefLights, AreTheSameBytesForAnyNumberOfThreads) {
  const ReliefStudy study = studied(make_carved_relief(0.02), 150);
  ReliefLightOptions options;
  options.threads = 1;
  const auto one = searched(study, options).lights(3);
  for (const int threads : {2, 5}) {
    options.threads = threads;
    const ReliefLightSearch search = searched(study, options);
    const auto many = search.lights(3);
    ASSERT_EQ(one->directions.size(), many->directions.size());
    EXPECT_EQ(std::memcmp(one->directions.data(), many->directions.data(), one->directions.size() * sizeof(Vec3)), 0);
    EXPECT_EQ(one->local_contrast_lx, many->local_contrast_lx);
  }
}

}  // namespace
}  // namespace luxrig
