/// picture: the same for any number of threads.
#include <gtest/gtest.h>

#include "core/picture/picture.h"
#include "tests/core/picture/picture_fixture.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig {
namespace {

using namespace picture_fixture;

TEST(Picture, IsTheSameForAnyNumberOfThreads) {
  const RayScene rays(make_cube(2, 0.6));
  PictureOptions options;
  options.threads = 1;
  const auto one =
      render_picture(rays, kPictureBulb, std::vector{1.0}, looking({-0.7, -0.6, 0.4}, {0, 0, -1}), options);
  options.threads = 3;
  const auto three =
      render_picture(rays, kPictureBulb, std::vector{1.0}, looking({-0.7, -0.6, 0.4}, {0, 0, -1}), options);
  EXPECT_EQ(one->illuminance_lx, three->illuminance_lx);
}

}  // namespace
}  // namespace luxrig
