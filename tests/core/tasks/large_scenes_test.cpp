/// Ground of 20 km, map coordinates, every face twice: a room gets the same light as on a small plot at the origin.

#include <gtest/gtest.h>

#include "core/tasks/rig_transport.h"
#include "core/tasks/scene_builder.h"
#include "core/transport/evaluator.h"
#include "tests/core/scene/room_on_ground.h"
#include "tests/random.h"

namespace luxrig {
namespace {

struct Plot {
  double ground_m;
  Vec3 aside_m, at_m;
  bool doubled;
};
const Vec3 kNowhere = Vec3::Zero();
constexpr double kSmall_m = 8;

Rig room_on(const Plot& plot, double sheet_below_lamp_m) {
  Rig rig = room_on_ground(plot.ground_m, plot.aside_m, plot.at_m, sheet_below_lamp_m);
  if (plot.doubled) {
    const std::vector<SceneObject> once = rig.scene.objects;
    rig.scene.objects.insert(rig.scene.objects.end(), once.begin(), once.end());
  }
  rig.fixtures.push_back(rig.fixtures.front());
  rig.fixtures.back().world_from_mount.translation_m = plot.at_m + Vec3(2, 2, 2.9);
  Random random(3);
  for (int i = 0; i < 12; ++i) {
    Point point;
    // On the floor, up to the walls, and below the sheet.
    point.position_world_m = plot.at_m + (i < 8 ? Vec3(2.99 * random.between(-1, 1), 2.49 * random.between(-1, 1), 0)
                                                : Vec3(0.3 * random.in_cube() + Vec3(0, 0, 2.2)));
    point.normal_world = Vec3::UnitZ();
    rig.points.push_back(point);
  }
  return rig;
}

TransportMatrix light_in(const Plot& plot, double sheet_below_lamp_m,
                         std::unique_ptr<Evaluator> (*make)(const RayScene&), std::uint64_t seed) {
  const Rig rig = room_on(plot, sheet_below_lamp_m);
  const auto scene = build_scene(rig);
  EXPECT_TRUE(scene.has_value());
  const RayScene rays(*scene);
  EvaluateOptions options;
  options.wanted_relative_error = 0.01;
  options.max_rays = 1'000'000;
  options.seed = seed;
  const auto matrix = make(rays)->evaluate(receivers_of(rig), emitters_of(rig), options);
  EXPECT_TRUE(matrix.has_value()) << (matrix ? "" : matrix.error().detail);
  return matrix ? *matrix : TransportMatrix();
}

class LargeScenes : public testing::TestWithParam<Plot> {};
INSTANTIATE_TEST_SUITE_P(OnPlots, LargeScenes,
                         testing::Values(Plot{kSmall_m, kNowhere, {1e5, 0, 0}, false},
                                         Plot{kSmall_m, kNowhere, {1e6, -1e6, 300}, true},
                                         Plot{2000, kNowhere, kNowhere, false}, Plot{20'000, kNowhere, kNowhere, false},
                                         Plot{20'000, {9000, -7000, 0}, kNowhere, true},
                                         Plot{20'000, {-9000, 100, 0}, {654'321.7, 5'432'101.3, 412.3}, false}));

TEST_P(LargeScenes, HaveTheDirectLightOfASmallPlot) {
  const auto here = light_in({kSmall_m, kNowhere, kNowhere, false}, 0.02, make_direct_evaluator, 1);
  const auto there = light_in(GetParam(), 0.02, make_direct_evaluator, 1);
  ASSERT_EQ(there.lux_per_level.rows(), here.lux_per_level.rows());
  EXPECT_LT((there.lux_per_level - here.lux_per_level).cwiseAbs().maxCoeff(), 1e-7 * here.lux_per_level.maxCoeff());
}

/// With one seed the paths are the same except where rounding diverts one: nearer than with two seeds.
TEST_P(LargeScenes, HaveTheReflectedLightOfASmallPlot) {
  const Eigen::Vector2d levels(1, 1);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto here = light_in({kSmall_m, kNowhere, kNowhere, false}, 0.4, make_path_evaluator, seed);
    const auto there = light_in(GetParam(), 0.4, make_path_evaluator, seed);
    const Eigen::VectorXd here_lx = here.lux(levels), there_lx = there.lux(levels),
                          error_lx = here.standard_error_lux(levels);
    for (Eigen::Index i = 0; i < here_lx.size(); ++i)
      EXPECT_NEAR(there_lx[i], here_lx[i], 0.5 * error_lx[i]) << "point " << i << ", seed " << seed;
    EXPECT_NEAR(there_lx.sum(), here_lx.sum(), 1e-3 * here_lx.sum()) << seed;
  }
}

}  // namespace
}  // namespace luxrig
