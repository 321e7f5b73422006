/// judged_lights: the same for any number of threads.
#include <gtest/gtest.h>

#include "core/highlight/lights/judged_lights.h"
#include "core/highlight/lights/mounted_lights.h"
#include "core/highlight/surface/relief_study.h"
#include "tests/core/highlight/lights/judged_lights_fixture.h"
#include "tests/core/highlight/shapes.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

using namespace judged_lights_fixture;

TEST(JudgedLights, AreTheSameForAnyNumberOfThreads) {
  const ReliefStudy study = studied_for_lights(make_terrain(100, 50));
  const std::vector<Vec3> places = places_around(study, 5);
  std::vector<JudgedLightCount> counts;
  for (const int threads : {1, 8}) {
    JudgedLightOptions options;
    options.threads = threads;
    options.first_points = 60;
    const auto judged = JudgedLights::make(study.surface, study.rays, study.interest, study.features, places, {},
                                           make_spot(1000, rad_from_deg(20), rad_from_deg(40)), options);
    ASSERT_TRUE(judged);
    const auto count = judged->count_lights(4);
    ASSERT_TRUE(count);
    counts.push_back(*count);
  }
  ASSERT_EQ(counts[0].by_number.size(), 4u);
  ASSERT_EQ(counts[1].by_number.size(), 4u);
  EXPECT_EQ(counts[0].best, counts[1].best);
  for (std::size_t n = 0; n < 4; ++n) {
    EXPECT_EQ(counts[0].by_number[n].score.judged, counts[1].by_number[n].score.judged);
    EXPECT_LE(0.98 * counts[0].by_number[n].score.exposed_contrast,
              counts[0].by_number[counts[0].best].score.exposed_contrast);
    for (std::size_t i = 0; i <= n; ++i) {
      EXPECT_EQ(counts[0].by_number[n].lights[i].direction, counts[1].by_number[n].lights[i].direction);
      EXPECT_EQ(counts[0].by_number[n].lights[i].lux, counts[1].by_number[n].lights[i].lux);
    }
  }
}

}  // namespace
}  // namespace luxrig
