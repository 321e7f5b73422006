/// picture: the same for any number of threads.
#include <gtest/gtest.h>

#include <algorithm>

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

TEST(PlanView, IsTheSameForAnyNumberOfThreads) {
  const RayScene rays(make_cube(2, 0.6));
  const PlanView one = render_plan_view(rays, 60, std::nullopt, 1);
  EXPECT_GT(*std::max_element(one.shade.begin(), one.shade.end()),
            *std::min_element(one.shade.begin(), one.shade.end()));
  EXPECT_EQ(render_plan_view(rays, 60, std::nullopt, 3).shade, one.shade);
}

}  // namespace
}  // namespace luxrig
