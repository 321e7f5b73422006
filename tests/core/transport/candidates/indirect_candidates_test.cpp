/// Reflected light of candidates, compared with radiosity, with path tracing, and with itself without skips.

#include <gtest/gtest.h>

#include "core/photometry/sky/sky.h"
#include "core/transport/candidates/candidate_transport.h"
#include "core/transport/candidates/incremental_transport.h"
#include "tests/core/transport/candidates/box_rooms.h"
#include "tests/core/transport/candidates/computed.h"
#include "tests/core/transport/candidates/indirect_candidates_fixture.h"
#include "tests/core/transport/cube_radiosity.h"

namespace luxrig {
namespace {

using namespace indirect_candidates_fixture;

TEST(IndirectCandidates, SendNothingThroughAClosedWall) {
  const Scene scene = two_rooms(0.9, false);
  const RayScene rays(scene);
  const auto receivers = receivers_in_two_rooms(10);
  const CandidateSet set{lattice_m(0.6), {isotropic_luminaire()}};
  CandidateOptions options = coarse();
  options.surface_cells = 500;  // cells of half a metre against a wall of 15 cm
  const auto got = computed(scene, rays, receivers, set, options);
  int inside_rooms = 0;
  for (std::size_t c = 0; c < set.columns(); ++c)
    for (auto i = got.matrix.begin[c]; i < got.matrix.begin[c + 1]; ++i) {
      const bool candidate_left = set.positions_world_m[c].x() < 4.075, receiver_left = got.matrix.receiver[i] < 10;
      EXPECT_EQ(candidate_left, receiver_left) << "column " << c;
      ++inside_rooms;
    }
  EXPECT_GT(inside_rooms, 1000);
}

TEST(IncrementalTransport, AMovedReceiverGetsTheRowOfItsNewPlace) {
  const Scene scene = two_rooms(0.7, true);
  const RayScene rays(scene);
  auto receivers = receivers_in_two_rooms(9);
  IncrementalOptions options;
  options.cells = 2000;
  auto moved = std::move(*IncrementalTransport::make(scene, rays, receivers, options));
  const std::uint64_t rays_to_make = moved->rays();
  Emitter emitter = isotropic_luminaire();
  emitter.world_from_lamp.translation_m = {2.2, 1.2, 2.2};
  const auto before = *moved->column(emitter);
  const Receiver home = receivers[4], away{{6.5, 1.1, 0.8}, Vec3::UnitZ()};
  ASSERT_TRUE(moved->move_receiver(4, away));
  EXPECT_LT(moved->rays() * 20, rays_to_make);
  const auto there = *moved->column(emitter);
  receivers[4] = away;
  const auto fresh = *(*IncrementalTransport::make(scene, rays, receivers, options))->column(emitter);
  EXPECT_EQ(there.direct_lux, fresh.direct_lux);
  EXPECT_NEAR(there.total_lux[4], fresh.total_lux[4], 3 * (there.standard_error_lux[4] + fresh.standard_error_lux[4]));
  ASSERT_TRUE(moved->move_receiver(4, home));
  const auto after = *moved->column(emitter);
  EXPECT_LT((after.total_lux - before.total_lux).norm(), 2e-2 * before.total_lux.norm());
  EXPECT_FALSE(moved->move_receiver(99, home));
  EXPECT_FALSE(moved->move_receiver(0, {{0, 0, std::nan("")}, Vec3::UnitZ()}));
}

TEST(IncrementalTransport, AMovedTableCastsRaysOnlyWhereItAffectsDirectLight) {
  const Scene before = two_rooms(0.7, true);
  Scene after = before;
  const std::size_t table = after.vertices_m.size() - 8;
  Eigen::AlignedBox3d box;
  for (std::size_t v = table; v < after.vertices_m.size(); ++v) {
    box.extend(after.vertices_m[v].cast<double>());
    after.vertices_m[v] += Vec3f(0.4f, 0.3f, 0.6f);
    box.extend(after.vertices_m[v].cast<double>());
  }
  const RayScene rays_before(before), rays_after(after);
  const auto receivers = receivers_in_two_rooms(60);
  std::vector<Emitter> emitters;
  for (const Vec3& at : lattice_m(0.8)) emitters.push_back({make_isotropic(1000), {Mat3::Identity(), at}});
  IncrementalOptions options;
  options.indirect = false;
  const auto made = IncrementalTransport::make(before, rays_before, receivers, options);
  Eigen::MatrixXd lux = make_direct_evaluator(rays_before)->evaluate(receivers, emitters, {})->lux_per_level;
  const auto want = *make_direct_evaluator(rays_after)->evaluate(receivers, emitters, {});
  EXPECT_GT((lux - want.lux_per_level).norm(), 0.01 * lux.norm());
  const auto cast = (*made)->update_direct(emitters, rays_after, box, lux);
  ASSERT_TRUE(cast) << cast.error().detail;
  EXPECT_LT((lux - want.lux_per_level).norm(), 1e-9 * lux.norm());
  EXPECT_LT(*cast * 4, want.rays);
}

TEST(IncrementalTransport, RefusesInvalidInputAndStopsWhenAsked) {
  const Scene scene = two_rooms(0.7, false);
  const RayScene rays(scene);
  const auto receivers = receivers_in_two_rooms(3);
  IncrementalOptions options;
  options.cells = 0;
  EXPECT_FALSE(IncrementalTransport::make(scene, rays, receivers, options));
  options.cells = 500;
  std::stop_source source;
  source.request_stop();
  IncrementalOptions stopping = options;
  stopping.watch.stop = source.get_token();
  const auto stopped = IncrementalTransport::make(scene, rays, receivers, stopping);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().cause, Cause::cancelled);
  const auto made = IncrementalTransport::make(scene, rays, receivers, options);
  ASSERT_TRUE(made);
  Emitter bad = isotropic_luminaire();
  bad.world_from_lamp.translation_m.x() = std::nan("");
  EXPECT_FALSE((*made)->column(bad));
  bad = isotropic_luminaire();
  bad.shape.kind = LuminousShape::Kind::sphere;
  EXPECT_FALSE((*made)->column(bad));
  // A moved object: with refused luminaires, an infinite box, a matrix of the wrong size, and an empty box.
  Eigen::MatrixXd lux = Eigen::MatrixXd::Constant(6, 1, 7);
  const Eigen::MatrixXd before = lux;
  const Eigen::AlignedBox3d box(Vec3(0, 0, 0), Vec3(8, 3, 2.5));
  EXPECT_FALSE((*made)->update_direct(std::span(&bad, 1), rays, box, lux));
  bad = {};
  bad.sky = make_uniform_sky(1000);
  EXPECT_FALSE((*made)->update_direct(std::span(&bad, 1), rays, box, lux));
  const Emitter good = isotropic_luminaire();
  EXPECT_FALSE((*made)->update_direct(std::span(&good, 1), rays, {Vec3(0, 0, 0), Vec3(1, 1, HUGE_VAL)}, lux));
  Eigen::MatrixXd narrow(6, 2);
  EXPECT_FALSE((*made)->update_direct(std::span(&good, 1), rays, box, narrow));
  const auto nothing = (*made)->update_direct(std::span(&good, 1), rays, {}, lux);
  ASSERT_TRUE(nothing);
  EXPECT_EQ(*nothing, 0u);
  EXPECT_EQ(lux, before);
}

}  // namespace
}  // namespace luxrig
