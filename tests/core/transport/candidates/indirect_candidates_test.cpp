/// Reflected light of candidates, held against radiosity, against path tracing, and against itself with nothing
/// skipped.

#include <gtest/gtest.h>

#include "core/photometry/sky.h"
#include "core/transport/candidates/candidate_transport.h"
#include "core/transport/candidates/incremental_transport.h"
#include "tests/core/transport/candidates/box_rooms.h"
#include "tests/core/transport/candidates/computed.h"
#include "tests/core/transport/cube_radiosity.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig {
namespace {

CandidateOptions coarse() {
  CandidateOptions options;
  options.surface_cells = 2000;
  options.most_rays_per_candidate = 512;
  return options;
}

TEST(IndirectCandidates, AgreeWithRadiosityInACube) {
  const double edge_m = 4, reflectance = 0.7;
  const Scene scene = make_cube(edge_m, reflectance);
  const RayScene rays(scene);
  std::vector<Receiver> receivers;
  for (const WallPoint& p : cube_wall_grid(edge_m, 3)) receivers.push_back({p.position_m, p.normal});
  const std::vector<Vec3> sources_m = {{0, 0, 0}, {0.3, 0.2, 1.8}, {-1, 0.5, -1.85}, {1.2, -1.1, 0.4}};
  CandidateOptions options = coarse();
  options.wanted_relative_error = 0.005;
  options.most_rays_per_candidate = 2048;
  const auto got = computed(scene, rays, receivers, {sources_m, {isotropic_luminaire()}}, options);
  int inside = 0, all = 0;
  for (std::size_t c = 0; c < sources_m.size(); ++c) {
    const CubeRadiosity radiosity(edge_m, reflectance, 1000, sources_m[c], 16);
    double sum = 0, want_sum = 0;
    for (auto i = got.matrix.begin[c]; i < got.matrix.begin[c + 1]; ++i) {
      const Receiver& r = receivers[got.matrix.receiver[i]];
      const double want = radiosity.reflected_lx(r.position_world_m, r.normal_world);
      const double reflected = static_cast<double>(got.matrix.total_lux[i] - got.matrix.direct_lux[i]);
      EXPECT_NEAR(reflected, want, 0.15 * want);
      inside += std::abs(reflected - want) <= 2 * static_cast<double>(got.matrix.standard_error_lux[i]);
      ++all;
      sum += reflected, want_sum += want;
    }
    EXPECT_NEAR(sum, want_sum, 0.015 * want_sum) << "source " << sources_m[c].transpose();
  }
  EXPECT_EQ(all, 4 * 54);
  EXPECT_GE(inside, 0.85 * all);
  EXPECT_LT(got.statistics.median_relative_error, 0.03);
}

TEST(IndirectCandidates, AgreeWithPathsThroughADoorWithinTheirErrors) {
  const Scene scene = two_rooms(0.7, true);
  const RayScene rays(scene);
  const auto receivers = receivers_in_two_rooms(20);
  std::vector<Vec3> positions_m = {{2, 1.5, 2.3}, {1.2, 0.6, 0.4}, {6, 2, 1.5}, {3.5, 2.5, 2.45}, {7.9, 0.3, 0.2}};
  CandidateOptions options = coarse();
  options.surface_cells = 2500;
  options.wanted_relative_error = 0.01;
  options.most_rays_per_candidate = 2048;
  const auto got = computed(scene, rays, receivers, {positions_m, {isotropic_luminaire()}}, options);
  std::vector<Emitter> emitters;
  for (const Vec3& at : positions_m) emitters.push_back({make_isotropic(1000), {Mat3::Identity(), at}});
  EvaluateOptions reference;
  reference.wanted_relative_error = 0.01;
  reference.max_rays = 12'000'000;
  const auto paths = make_path_evaluator(rays)->evaluate(receivers, emitters, reference);
  ASSERT_TRUE(paths);
  int inside = 0, all = 0;
  double sum = 0, want_sum = 0;
  for (std::size_t c = 0; c < positions_m.size(); ++c) {
    Eigen::VectorXd levels = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(positions_m.size()));
    levels[static_cast<Eigen::Index>(c)] = 1;
    const Eigen::VectorXd want = paths->lux(levels), error = paths->standard_error_lux(levels);
    for (auto i = got.matrix.begin[c]; i < got.matrix.begin[c + 1]; ++i) {
      const auto r = static_cast<Eigen::Index>(got.matrix.receiver[i]);
      const auto lux = static_cast<double>(got.matrix.total_lux[i]);
      inside += std::abs(lux - want[r]) <=
                2 * std::hypot(static_cast<double>(got.matrix.standard_error_lux[i]), error[r]) + 0.02 * want[r];
      ++all;
      sum += lux, want_sum += want[r];
    }
  }
  EXPECT_EQ(all, 5 * 40);
  EXPECT_GE(inside, 0.9 * all);
  EXPECT_NEAR(sum, want_sum, 0.02 * want_sum);
}

TEST(IndirectCandidates, SendNothingThroughAClosedWall) {
  const Scene scene = two_rooms(0.9, false);
  const RayScene rays(scene);
  const auto receivers = receivers_in_two_rooms(10);
  const CandidateSet set{lattice_m(0.6), {isotropic_luminaire()}};
  CandidateOptions options = coarse();
  options.surface_cells = 500;  // cells of half a metre, the wall of 15 cm
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

TEST(IndirectCandidates, SkipsMoveNoAnswerByMoreThanItsError) {
  const Scene scene = two_rooms(0.7, true);
  const RayScene rays(scene);
  auto receivers = receivers_in_two_rooms(12);
  const CandidateSet set{lattice_m(0.7), {isotropic_luminaire(), spot_luminaire({1, 0.2, -1})}};
  CandidateOptions options = coarse();
  options.surface_cells = 400;
  options.most_rays_per_candidate = 256;
  options.skips = {false, false, false, false, false, false};
  const auto all = computed(scene, rays, receivers, set, options);
  for (const auto skip :
       {&CandidateSkips::other_air, &CandidateSkips::behind, &CandidateSkips::blockers, &CandidateSkips::unlit}) {
    CandidateOptions one = options;
    one.skips.*skip = true;
    const auto got = computed(scene, rays, receivers, set, one);
    EXPECT_LE(got.statistics.rays, all.statistics.rays);
    int moved = 0;
    for (std::size_t c = 0; c < set.columns(); ++c) {
      const auto a = dense_column(all.matrix, c, all.matrix.total_lux, receivers.size());
      const auto error = dense_column(all.matrix, c, all.matrix.standard_error_lux, receivers.size());
      const auto b = dense_column(got.matrix, c, got.matrix.total_lux, receivers.size());
      const auto error_b = dense_column(got.matrix, c, got.matrix.standard_error_lux, receivers.size());
      for (std::size_t r = 0; r < receivers.size(); ++r)
        moved += std::abs(a[r] - b[r]) > 3 * std::hypot(error[r], error_b[r]) + 1e-6f * a[r];
    }
    EXPECT_LE(moved, 0.02 * static_cast<double>(all.matrix.entries()));
  }
}

TEST(IndirectCandidates, AreTheSameBytesOnAnyThreadsAndInAnyMemory) {
  const Scene scene = two_rooms(0.7, true);
  const RayScene rays(scene);
  const auto receivers = receivers_in_two_rooms(8);
  const CandidateSet set{lattice_m(0.7), {isotropic_luminaire()}};
  CandidateOptions options = coarse();
  options.surface_cells = 300;
  options.most_rays_per_candidate = 256;
  options.threads = 1;
  const auto one = computed(scene, rays, receivers, set, options);
  for (const int threads : {2, 8}) {
    options.threads = threads;
    const auto many = computed(scene, rays, receivers, set, options);
    EXPECT_EQ(many.matrix.total_lux, one.matrix.total_lux);
    EXPECT_EQ(many.matrix.standard_error_lux, one.matrix.standard_error_lux);
    EXPECT_EQ(many.statistics.rays, one.statistics.rays);
  }
  std::vector<float> streamed;
  std::size_t blocks = 0;
  options.memory_bound_bytes = 4'000'000;
  const auto done = stream_candidates(scene, rays, receivers, set, options, [&](const CandidateColumns& block) {
    streamed.insert(streamed.end(), block.total_lux.begin(), block.total_lux.end());
    ++blocks;
    return true;
  });
  ASSERT_TRUE(done) << done.error().detail;
  EXPECT_EQ(streamed, one.matrix.total_lux);
  EXPECT_GE(blocks, 1u);
}

TEST(IndirectCandidates, CostGrowsLinearlyInCandidates) {
  const Scene scene = two_rooms(0.7, true);
  const RayScene rays(scene);
  const auto receivers = receivers_in_two_rooms(6);
  CandidateOptions options = coarse();
  options.surface_cells = 300;
  options.wanted_relative_error = 1;  // so that all cast the same number of rays
  std::vector<double> cost;
  for (const double step_m : {0.5, 0.25}) {
    CandidateSet set{lattice_m(step_m), {isotropic_luminaire()}};
    const auto got = computed(scene, rays, receivers, set, options);
    cost.push_back(static_cast<double>(got.statistics.rays) / static_cast<double>(set.columns()));
  }
  EXPECT_LT(cost[1], cost[0]);
}

TEST(IndirectCandidates, InterpolatedColumnsAreWhatLookingGives) {
  const Scene scene = two_rooms(0.7, true);
  const RayScene rays(scene);
  const auto receivers = receivers_in_two_rooms(8);
  CandidateSet all{lattice_m(0.3), {isotropic_luminaire()}};
  CandidateOptions options = coarse();
  options.surface_cells = 500;
  options.wanted_relative_error = 0.04;
  const auto got = computed(scene, rays, receivers, all, options);
  EXPECT_GT(got.statistics.nodes, 150u);
  EXPECT_LT(got.statistics.columns_looked_at * 2, all.columns()) << "most are interpolated";
  options.skips.foretold = false;  // the same surfaces, each position with rays of its own
  const auto looked = computed(scene, rays, receivers, all, options);
  EXPECT_EQ(looked.statistics.nodes, 0u);
  EXPECT_EQ(looked.statistics.columns_looked_at, all.columns() - looked.statistics.columns_other_air);
  int inside = 0, entries = 0;
  double sum = 0, looked_sum = 0;
  for (std::size_t c = 0; c < all.columns(); ++c) {
    const auto a = dense_column(got.matrix, c, got.matrix.total_lux, receivers.size());
    const auto error = dense_column(got.matrix, c, got.matrix.standard_error_lux, receivers.size());
    const auto b = dense_column(looked.matrix, c, looked.matrix.total_lux, receivers.size());
    const auto error_b = dense_column(looked.matrix, c, looked.matrix.standard_error_lux, receivers.size());
    for (std::size_t r = 0; r < receivers.size(); ++r) {
      if (!(b[r] > 0)) continue;
      inside += std::abs(a[r] - b[r]) <= 2 * std::hypot(error[r], error_b[r]);
      ++entries;
      sum += static_cast<double>(a[r]), looked_sum += static_cast<double>(b[r]);
    }
  }
  EXPECT_GT(entries, 5000);
  EXPECT_GE(inside, 0.93 * entries);
  EXPECT_NEAR(sum, looked_sum, 0.005 * looked_sum);
}

TEST(IncrementalTransport, AColumnIsWhatTheEvaluatorsSay) {
  const Scene scene = two_rooms(0.7, true);
  const RayScene rays(scene);
  const auto receivers = receivers_in_two_rooms(15);
  IncrementalOptions options;
  options.cells = 2000;
  const auto made = IncrementalTransport::make(scene, rays, receivers, options);
  ASSERT_TRUE(made);
  const IncrementalTransport& transport = **made;
  for (const Emitter& kind : {isotropic_luminaire(), spot_luminaire({0.3, 0.2, -1})}) {
    Emitter emitter = kind;
    emitter.world_from_lamp.translation_m = {2.2, 1.2, 2.2};
    const auto column = transport.column(emitter);
    ASSERT_TRUE(column);
    const auto direct = make_direct_evaluator(rays)->evaluate(receivers, std::span(&emitter, 1), {});
    EXPECT_LT((column->direct_lux - direct->lux_per_level.col(0)).norm(), 1e-9 * direct->lux_per_level.norm());
    EXPECT_EQ(transport.direct_column(emitter)->direct_lux, column->direct_lux);
    EXPECT_EQ(transport.column(emitter)->total_lux, column->total_lux);
    EvaluateOptions reference;
    reference.max_rays = 3'000'000;
    const auto paths = make_path_evaluator(rays)->evaluate(receivers, std::span(&emitter, 1), reference);
    const Eigen::VectorXd one = Eigen::VectorXd::Ones(1), want = paths->lux(one),
                          error = paths->standard_error_lux(one);
    int inside = 0;
    for (Eigen::Index r = 0; r < want.size(); ++r)
      inside += std::abs(column->total_lux[r] - want[r]) <=
                2 * std::hypot(column->standard_error_lux[r], error[r]) + 0.02 * want[r];
    EXPECT_GE(inside, 26) << "of 30";
  }
}

TEST(IncrementalTransport, AMovedReceiverGetsTheRowThatItWouldHaveHadThere) {
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

TEST(IncrementalTransport, AMovedTableIsAskedAboutOnlyWhereItMattersForDirectLight) {
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

TEST(IncrementalTransport, RefusesAndStops) {
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
  // A moved object, with luminaires that are refused, a matrix that does not fit, a box without a place, no box.
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
