/// indirect_candidates: accuracy over many samples.

#include <gtest/gtest.h>

#include "core/transport/candidates/candidate_transport.h"
#include "core/transport/candidates/incremental_transport.h"
#include "tests/core/transport/candidates/box_rooms.h"
#include "tests/core/transport/candidates/computed.h"
#include "tests/core/transport/candidates/indirect_candidates_fixture.h"
#include "tests/core/transport/cube_radiosity.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig {
namespace {

using namespace indirect_candidates_fixture;

TEST(IndirectCandidates, AgreeWithRadiosityInACube) {
  const double edge_m = 4, reflectance = 0.7;
  const Scene scene = make_cube(edge_m, reflectance);
  const RayScene rays(scene);
  std::vector<Receiver> receivers;
  for (const WallPoint& p : cube_wall_grid(edge_m, 3)) receivers.push_back({p.position_m, p.normal});
  const std::vector<Vec3> sources_m = {{0, 0, 0}, {0.3, 0.2, 1.8}, {-1, 0.5, -1.85}, {1.2, -1.1, 0.4}};
  CandidateOptions options = coarse();
  options.wanted_relative_error = 0.005;
  options.max_rays_per_candidate = 2048;
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
  options.max_rays_per_candidate = 2048;
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

TEST(IndirectCandidates, SkipsMoveNoAnswerByMoreThanItsError) {
  const Scene scene = two_rooms(0.7, true);
  const RayScene rays(scene);
  auto receivers = receivers_in_two_rooms(12);
  const CandidateSet set{lattice_m(0.7), {isotropic_luminaire(), spot_luminaire({1, 0.2, -1})}};
  CandidateOptions options = coarse();
  options.surface_cells = 400;
  options.max_rays_per_candidate = 256;
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

TEST(IndirectCandidates, CostGrowsLinearlyInCandidates) {
  const Scene scene = two_rooms(0.7, true);
  const RayScene rays(scene);
  const auto receivers = receivers_in_two_rooms(6);
  CandidateOptions options = coarse();
  options.surface_cells = 300;
  options.wanted_relative_error = 1;  // every position casts the same number of rays
  std::vector<double> cost;
  for (const double step_m : {0.5, 0.25}) {
    CandidateSet set{lattice_m(step_m), {isotropic_luminaire()}};
    const auto got = computed(scene, rays, receivers, set, options);
    cost.push_back(static_cast<double>(got.statistics.rays) / static_cast<double>(set.columns()));
  }
  EXPECT_LT(cost[1], cost[0]);
}

TEST(IndirectCandidates, InterpolatedColumnsMatchTracedOnes) {
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
  options.skips.foretold = false;  // same surfaces, but every position casts its own rays
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

TEST(IncrementalTransport, AColumnMatchesTheEvaluators) {
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

}  // namespace
}  // namespace luxrig
