/// curvature: accuracy over many samples.
#include <gtest/gtest.h>

#include "core/highlight/surface/curvature.h"
#include "tests/core/highlight/shapes.h"
#include "tests/core/highlight/surface/curvature_fixture.h"

namespace luxrig {
namespace {

using namespace curvature_fixture;

TEST(Curvature, OfAFineMeshMatchesThatOfItsMergedSamples) {
  // 0.3 m on a sphere of 200 rings: 300 vertices at the equator, more at the poles.
  const Errors e = errors_against(measured(uv_sphere(1, 200), 0.3), kEverywhereOne);
  EXPECT_EQ(e.unknown, 0u);
  EXPECT_NEAR(e.mean_rms, 0.17 * 0.09, 0.01);
  EXPECT_LT(e.mean_worst, 0.05);
}

}  // namespace
}  // namespace luxrig
