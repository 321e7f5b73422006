#include <gtest/gtest.h>

#include "core/transport/evaluator.h"
#include "tests/core/transport/cube_radiosity.h"
#include "tests/core/transport/lamp_pose.h"
#include "tests/core/transport/paths/path_evaluator_fixture.h"
#include "tests/core/transport/within.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig {
namespace {

using namespace path_evaluator_fixture;

TEST(PathEvaluator, TheMatrixIsTheMeanOfItsReplicates) {
  const RayScene rays(make_cube(2, 0.5));
  const auto matrix = path(rays, {{{0.1, 0.2, -1}, Vec3::UnitZ()}},
                           {bulb_at(100, {0, 0, 0}), bulb_at(50, {0.5, 0.5, 0.5})}, within(0.05));
  ASSERT_EQ(matrix.replicates.size(), 16u);
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(1, 2);
  for (const auto& replicate : matrix.replicates) mean += replicate / 16;
  EXPECT_LT((mean - matrix.lux_per_level).cwiseAbs().maxCoeff(), 1e-12 * mean.maxCoeff());
}

TEST(PathEvaluator, ReachesASmallerErrorWithMoreRays) {
  const RayScene rays(make_cube(2, 0.5));
  const std::vector<Receiver> receivers = {{{0.1, 0.2, -1}, Vec3::UnitZ()}};
  const std::vector<Emitter> emitters = {
      {make_spot(900, rad_from_deg(24), rad_from_deg(40)), lamp_at({0.3, 0.2, 0.9}, {0.6, -0.6, -1})}};
  std::uint64_t rays_before = 0;
  for (const double error : {0.1, 0.03, 0.01}) {
    const auto matrix = path(rays, receivers, emitters, within(error));
    EXPECT_LE(matrix.relative_error, error);
    EXPECT_GT(matrix.relative_error, 0);
    EXPECT_GE(matrix.rays, rays_before);
    rays_before = matrix.rays;
  }
}

TEST(PathEvaluator, ErrorsOfUnlitLampsCostNothing) {
  const RayScene rays(make_cube(2, 0.5));
  const std::vector<Receiver> receivers = {{{0.1, 0.2, -1}, Vec3::UnitZ()}};
  const std::vector<Emitter> emitters = {
      bulb_at(300, {-0.2, 0.1, 0.2}),
      {make_spot(9000, rad_from_deg(16), rad_from_deg(24)), lamp_at({0.3, 0.2, 0.9}, {0.5, -0.6, -1})}};
  auto options = within(0.02);
  const auto both = path(rays, receivers, emitters, options);
  options.levels = {1, 0};
  const auto one = path(rays, receivers, emitters, options);
  EXPECT_LT(one.rays, both.rays / 4);
  EXPECT_GT(one.lux_per_level(0, 1), 0) << "its column is there all the same";
}

TEST(PathEvaluator, StopsAtTheMaximumOfRaysAndReportsItsError) {
  const RayScene rays(make_cube(2, 0.5));
  auto options = within(1e-5);
  options.max_rays = 200'000;
  const auto matrix = path(rays, {{{0.1, 0.2, -1}, Vec3::UnitZ()}, {{-1, 0.2, 0}, Vec3::UnitX()}},
                           {bulb_at(300, {-0.2, 0.1, 0.2})}, options);
  EXPECT_LT(matrix.rays, 220'000u);
  EXPECT_GT(matrix.rays, 50'000u);
  EXPECT_GT(matrix.relative_error, 1e-5);
  EXPECT_LT(matrix.relative_error, 0.05);
}

TEST(PathEvaluator, BlackRoomsNeedNoPaths) {
  const RayScene rays(make_cube(2, 0));
  const auto matrix = path(rays, {{{0.1, 0.2, -1}, Vec3::UnitZ()}}, {bulb_at(300, {-0.2, 0.1, 0.2})}, within(1e-6));
  EXPECT_EQ(matrix.lux_per_level, matrix.direct_lux_per_level);
  EXPECT_LE(matrix.rays, 1u) << "the shadow ray of the direct light; what reflects nothing costs nothing";
}

TEST(PathEvaluator, LampsThatReachNothingCastNoShadowRays) {
  const RayScene rays(make_cube(2, 0.5));
  const std::vector<Receiver> receivers = {{{0.1, 0.2, -1}, Vec3::UnitZ()}};
  const auto options = within(10);
  const auto alone = path(rays, receivers, {bulb_at(300, {-0.2, 0.1, 0.2})}, options);
  std::vector<Emitter> many = {bulb_at(300, {-0.2, 0.1, 0.2})};
  // Outside the room, aimed away from it.
  for (int i = 0; i < 200; ++i)
    many.push_back({make_spot(900, rad_from_deg(24), rad_from_deg(40)), lamp_at({0.01 * i, 0, 5}, {0.01 * i, 0, 9})});
  EXPECT_EQ(path(rays, receivers, many, options).rays, alone.rays);
}

TEST(PathEvaluator, AnEmptySceneCostsNoRaysAndIsExact) {
  const RayScene rays{Scene{}};
  const auto matrix = path(rays, {{{0, 0, 0}, Vec3::UnitZ()}}, {bulb_at(4 * kPi, {0, 0, 2})}, within(0.01));
  EXPECT_EQ(matrix.rays, 0u);
  EXPECT_DOUBLE_EQ(matrix.lux_per_level(0, 0), 0.25);
  EXPECT_EQ(matrix.standard_error_lux(Eigen::VectorXd::Ones(1))[0], 0);
}

}  // namespace
}  // namespace luxrig
