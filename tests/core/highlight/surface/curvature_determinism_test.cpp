/// curvature: the same for any number of threads.
#include <gtest/gtest.h>

#include <cstring>

#include "core/highlight/surface/curvature.h"
#include "tests/core/highlight/shapes.h"
#include "tests/core/highlight/surface/curvature_fixture.h"

namespace luxrig {
namespace {

using namespace curvature_fixture;

TEST(Curvature, IsTheSameBytesForAnyNumberOfThreads) {
  const Scene scene = noisy(torus(1, 0.4, 120, 50), 0.003, 2);
  const Measured one = measured(scene, 0.15, 1);
  for (const int threads : {2, 3, 8}) {
    const Measured many = measured(scene, 0.15, threads);
    for (std::size_t i = 0; i < one.curvature.size(); ++i)
      ASSERT_EQ(std::memcmp(&one.curvature[i].larger_per_m, &many.curvature[i].larger_per_m, sizeof(double)), 0);
  }
}

}  // namespace
}  // namespace luxrig
