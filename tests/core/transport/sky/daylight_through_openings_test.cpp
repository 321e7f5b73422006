#include <gtest/gtest.h>

#include "core/photometry/sky/sky.h"
#include "core/picture/picture.h"
#include "tests/core/transport/sky/daylight_through_openings_fixture.h"
#include "tests/core/transport/sky/room_with_windows.h"
#include "tests/core/transport/within.h"

namespace luxrig {
namespace {

using namespace daylight_through_openings_fixture;

// Sky component: ∫ L cosθ dω over the window, L = Lz (1 + 2 sin h) / 3, Lz = 9 E / 7π, by the midpoint rule.
TEST(DaylightThroughOpenings, OvercastSkyMatchesTheConfigurationFactorOfAWindow) {
  RoomWithWindows room = with_a_small_window();
  room.reflectance = 0;
  room.ground_reflectance = 0;
  const RayScene rays(room.scene());
  const auto& w = room.near_window_m;
  for (const bool path : {false, true}) {
    const auto evaluator = path ? make_path_evaluator(rays) : make_direct_evaluator(rays);
    const auto matrix = evaluated(*evaluator, room.desks(), under(make_overcast_sky(7000)), within(0.005));
    const Eigen::VectorXd error_lx = matrix.standard_error_lux(Eigen::VectorXd::Ones(1));
    EXPECT_LE(matrix.relative_error, 0.005);
    for (std::size_t r = 0; r < room.desks().size(); ++r) {
      const Receiver desk = room.desks()[r];
      constexpr int kGrid = 400;
      double expected_lx = 0;
      for (int i = 0; i < kGrid; ++i)
        for (int j = 0; j < kGrid; ++j) {
          const Vec3 to_m =
              Vec3(w[0] + (w[1] - w[0]) * (i + 0.5) / kGrid, 0, w[2] + (w[3] - w[2]) * (j + 0.5) / kGrid) -
              desk.position_world_m;
          const double distance_m = to_m.norm(), cosine = desk.normal_world.dot(to_m) / distance_m;
          const double slope = -to_m.y() / distance_m,
                       luminance = 9 * 7000 / (7 * kPi) * (1 + 2 * to_m.z() / distance_m) / 3;
          if (cosine > 0 && to_m.z() > 0)
            expected_lx += luminance * cosine * slope / (distance_m * distance_m) * (w[1] - w[0]) * (w[3] - w[2]) /
                           (kGrid * kGrid);
        }
      const auto row = static_cast<Eigen::Index>(r);
      EXPECT_NEAR(matrix.lux_per_level(row, 0), expected_lx, 3.5 * error_lx[row] + 2e-4 * expected_lx) << r;
    }
  }
}

// Takes 83 000 rays, most of them to find the window. Without finding it, 2.2 million rays gave three times the error.
TEST(DaylightThroughOpenings, DirectLightThroughASmallWindowTakesFewRays) {
  const RoomWithWindows room = with_a_small_window();
  const RayScene rays(room.scene());
  const auto matrix =
      evaluated(*make_direct_evaluator(rays), room.desks(), under(make_overcast_sky(10'000)), within(0.01));
  EXPECT_LE(matrix.relative_error, 0.01);
  EXPECT_LT(matrix.rays, 250'000u);
}

}  // namespace
}  // namespace luxrig
