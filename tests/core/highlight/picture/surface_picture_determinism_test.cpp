/// surface_picture: the same for any number of threads.
#include <gtest/gtest.h>

#include "core/highlight/picture/surface_picture.h"
#include "tests/core/highlight/picture/surface_picture_fixture.h"
#include "tests/core/highlight/shapes.h"

namespace luxrig {
namespace {

using namespace surface_picture_fixture;

TEST(SurfacePicture, IsTheSameForAnyNumberOfThreads) {
  const auto one = picture_of(uv_sphere(0.6, 40), 2, 0, 1).resolved(),
             three = picture_of(uv_sphere(0.6, 40), 2, 0, 3).resolved();
  EXPECT_EQ(one.rgb, three.rgb);
}

}  // namespace
}  // namespace luxrig
