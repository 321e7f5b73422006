// Light through panes: evaluators that support them, compared with closed forms and an independent random walk.
#include <gtest/gtest.h>

#include "core/transport/candidates/incremental_transport.h"
#include "core/transport/evaluator.h"
#include "tests/core/transport/candidates/computed.h"
#include "tests/core/transport/glass_fixture.h"
#include "tests/core/transport/within.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig {
namespace {

using namespace glass_fixture;

TEST(Glass, OfFullTransmittanceChangesNothing) {
  const Scene bare = make_cube(2 * kHalf_m, 0.5);
  Scene cube = bare;
  cube.panes = pane_at(0.25, 1);
  const RayScene with(cube), without(bare);
  const Emitter lamp = bulb_at({0.1, 0.2, 0.9});
  const auto a = make_path_evaluator(with)->evaluate(some_receivers(), {&lamp, 1}, within(0.01));
  const auto b = make_path_evaluator(without)->evaluate(some_receivers(), {&lamp, 1}, within(0.01));
  ASSERT_TRUE(a && b);
  EXPECT_LT((a->lux_per_level - b->lux_per_level).cwiseAbs().maxCoeff(), 1e-9 * b->lux_per_level.maxCoeff());
}

TEST(Glass, DimsLampsWithSizeAndLampsInTheOpen) {
  // Only a pane: no triangle stops a ray, yet the light is dimmed.
  Scene scene;
  scene.panes = pane_at(1, 0.8);
  const RayScene rays(scene);
  const std::vector<Receiver> below = {{{0, 0, 0}, Vec3::UnitZ()}};
  std::vector<Emitter> lamps = {bulb_at({0, 0, 2}), {make_lambertian(500), {Mat3::Identity(), {0, 0, 3}}}};
  lamps[1].shape = {LuminousShape::Kind::disk, Vec3(0.2, 0, 0)};
  const auto lit = make_direct_evaluator(rays)->evaluate(below, lamps, within(1e-3));
  const auto bare = make_direct_evaluator(RayScene(Scene{}))->evaluate(below, lamps, within(1e-3));
  ASSERT_TRUE(lit && bare);
  EXPECT_NEAR(lit->lux_per_level(0, 0), 0.8 * bare->lux_per_level(0, 0), 1e-9 * bare->lux_per_level(0, 0));
  // Seen within 2° of the normal, where the transmittance is nearly that at normal incidence.
  EXPECT_NEAR(lit->lux_per_level(0, 1), 0.8 * bare->lux_per_level(0, 1), 3e-3 * bare->lux_per_level(0, 1));
}

TEST(Glass, DimsTheDirectLightOfCandidates) {
  Scene cube = make_cube(2 * kHalf_m, 0.5);
  cube.panes = pane_at(0.25, 0.8);
  const RayScene rays(cube);
  const std::vector<Receiver> receivers = some_receivers();
  const Emitter lamp = bulb_at({0.3, 0.1, 0.9});
  const auto exact = make_direct_evaluator(rays)->evaluate(receivers, {&lamp, 1}, within(1e-3));
  ASSERT_TRUE(exact);
  IncrementalOptions options;
  options.indirect = false;
  const auto columns = IncrementalTransport::make(cube, rays, receivers, options);
  ASSERT_TRUE(columns);
  const auto column = (*columns)->direct_column(lamp);
  ASSERT_TRUE(column);
  EXPECT_LT((column->direct_lux - exact->lux_per_level.col(0)).cwiseAbs().maxCoeff(),
            1e-9 * exact->lux_per_level.maxCoeff());
  Eigen::MatrixXd anew = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(receivers.size()), 1);
  ASSERT_TRUE((*columns)->update_direct({&lamp, 1}, rays, rays.bounds_world_m(), anew));
  EXPECT_LT((anew - exact->lux_per_level).cwiseAbs().maxCoeff(), 1e-9 * exact->lux_per_level.maxCoeff());

  CandidateOptions of;
  of.indirect = false;
  const CandidateTransport streamed =
      computed(cube, rays, receivers, {{lamp.world_from_lamp.translation_m}, {bulb_at({0, 0, 0})}}, of);
  const Eigen::VectorXd streamed_lux = streamed.matrix.lux(receivers.size(), std::vector<double>{1});
  for (std::size_t r = 0; r < receivers.size(); ++r) {
    const auto row = static_cast<Eigen::Index>(r);
    EXPECT_NEAR(streamed_lux[row], exact->lux_per_level(row, 0), 1e-6 * exact->lux_per_level.maxCoeff()) << r;
  }
}

}  // namespace
}  // namespace luxrig
