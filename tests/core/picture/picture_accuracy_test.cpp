/// picture: accuracy over many samples.
#include <gtest/gtest.h>

#include "core/picture/picture.h"
#include "tests/core/picture/picture_fixture.h"
#include "tests/core/transport/lamp_pose.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig {
namespace {

using namespace picture_fixture;

TEST(Picture, ShowsTheIlluminanceThatTheEvaluatorMeasures) {
  const RayScene rays(make_cube(2, 0.6));
  const Vec3 target_m(0.3, 0.2, -1);
  PictureOptions options;
  options.wanted_relative_error = 0.005;
  options.max_passes = 2000;
  const auto picture =
      render_picture(rays, kPictureBulb, std::vector{0.5}, looking({-0.7, -0.6, 0.4}, target_m), options);
  ASSERT_TRUE(picture.has_value());
  const auto measured =
      make_path_evaluator(rays)->evaluate(std::vector<Receiver>{{target_m, Vec3::UnitZ()}}, kPictureBulb, {});
  const double expected_lx = 0.5 * measured->lux_per_level(0, 0);
  const std::size_t middle = 10 * 33 + 16;
  EXPECT_NEAR(picture->illuminance_lx[middle], expected_lx, 0.05 * expected_lx);
  EXPECT_NEAR(picture->luminance_cd_m2[middle].x(), 0.6 * picture->illuminance_lx[middle] / kPi, 1e-3 * expected_lx);
}

}  // namespace
}  // namespace luxrig
