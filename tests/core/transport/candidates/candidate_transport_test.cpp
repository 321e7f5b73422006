#include "core/transport/candidates/candidate_transport.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/core/transport/candidates/box_rooms.h"
#include "tests/core/transport/candidates/candidate_transport_fixture.h"
#include "tests/core/transport/candidates/computed.h"

namespace luxrig {
namespace {

using namespace candidate_transport_fixture;

/// Results of the direct evaluator for every candidate, as float.
std::vector<float> evaluated(const RayScene& rays, std::span<const Receiver> receivers, const CandidateSet& set) {
  std::vector<Emitter> emitters;
  for (const Vec3& at : set.positions_world_m)
    for (Emitter e : set.luminaires) {
      e.world_from_lamp.translation_m += at;
      emitters.push_back(e);
    }
  const auto matrix = make_direct_evaluator(rays)->evaluate(receivers, emitters, {});
  EXPECT_TRUE(matrix);
  std::vector<float> lux;
  for (Eigen::Index c = 0; c < matrix->emitters(); ++c)
    for (Eigen::Index r = 0; r < matrix->receivers(); ++r)
      lux.push_back(static_cast<float>(matrix->lux_per_level(r, c)));
  return lux;
}

TEST(CandidateTransport, DirectLightMatchesTheDirectEvaluator) {
  const Scene scene = two_rooms(0.7, true);
  const RayScene rays(scene);
  const auto receivers = receivers_in_two_rooms(30);
  CandidateSet set{lattice_m(0.37),
                   {isotropic_luminaire(), spot_luminaire(-Vec3::UnitZ()), spot_luminaire({1, 1, -1}),
                    spot_luminaire(Vec3::UnitX(), {0, 0, -0.1})}};
  const auto expected = evaluated(rays, receivers, set);
  const auto got = computed(scene, rays, receivers, set, direct_only());
  ASSERT_EQ(got.matrix.columns(), set.columns());
  std::size_t lit = 0;
  for (std::size_t c = 0; c < set.columns(); ++c) {
    const auto column = dense_column(got.matrix, c, got.matrix.total_lux, receivers.size());
    for (std::size_t r = 0; r < receivers.size(); ++r) {
      const float want = expected[c * receivers.size() + r];
      ASSERT_NEAR(column[r], want, 1e-6f * want) << "column " << c << " receiver " << r;
      lit += want > 0;
    }
  }
  EXPECT_EQ(got.matrix.entries(), lit);
  EXPECT_EQ(got.matrix.direct_lux, got.matrix.total_lux);
  EXPECT_EQ(got.statistics.median_relative_error, 0);
}

TEST(CandidateTransport, ExactSkipsSaveRaysAndChangeNoByte) {
  const Scene scene = two_rooms(0.7, true);
  const RayScene rays(scene);
  const auto receivers = receivers_in_two_rooms(30);
  const CandidateSet set{lattice_m(0.2), {isotropic_luminaire(), spot_luminaire(-Vec3::UnitZ())}};
  CandidateOptions options = direct_only();
  options.skips = {false, false, false, false, false};
  const auto all = computed(scene, rays, receivers, set, options);
  const auto fewer_rays_with = [&](bool CandidateSkips::*skip, double share) {
    CandidateOptions one = options;
    one.skips.*skip = true;
    const auto got = computed(scene, rays, receivers, set, one);
    expect_same_bytes(got.matrix, all.matrix);
    EXPECT_LT(static_cast<double>(got.statistics.rays), share * static_cast<double>(all.statistics.rays));
  };
  fewer_rays_with(&CandidateSkips::other_air, 0.9);
  fewer_rays_with(&CandidateSkips::behind, 1.0001);  // saves visits, but not rays
  fewer_rays_with(&CandidateSkips::blockers, 0.9);
  options.skips = {};
  const auto skipped = computed(scene, rays, receivers, set, options);
  expect_same_bytes(skipped.matrix, all.matrix);
  const auto& s = skipped.statistics;
  EXPECT_EQ((s.columns - s.columns_other_air) * receivers.size(),
            s.pairs_behind + s.pairs_dark + s.pairs_out_of_reach + s.pairs_blocked_in_groups + s.pairs_traced);
  EXPECT_EQ(s.pairs_lit, skipped.matrix.entries());
  EXPECT_GT(s.columns_other_air, 0u);
  EXPECT_GT(s.pairs_blocked_in_groups, s.pairs_traced / 4);
}

TEST(CandidateTransport, ReachDropsOnlyEntriesBelowIt) {
  const Scene scene = two_rooms(0.7, true);
  const RayScene rays(scene);
  const auto receivers = receivers_in_two_rooms(20);
  const CandidateSet set{lattice_m(0.3), {isotropic_luminaire()}};
  const auto all = computed(scene, rays, receivers, set, direct_only());
  CandidateOptions options = direct_only();
  options.min_lux = 12;
  const auto near = computed(scene, rays, receivers, set, options);
  EXPECT_LT(near.matrix.entries(), all.matrix.entries() * 3 / 4);
  EXPECT_LT(near.statistics.rays, all.statistics.rays);
  for (std::size_t c = 0; c < set.columns(); ++c) {
    auto want = dense_column(all.matrix, c, all.matrix.total_lux, receivers.size());
    for (float& lux : want) lux = lux < 12 ? 0 : lux;
    EXPECT_EQ(dense_column(near.matrix, c, near.matrix.total_lux, receivers.size()), want);
  }
}

TEST(CandidateTransport, ColumnsAddUpToTheLightOfAll) {
  const Scene scene = two_rooms(0.6, true);
  const RayScene rays(scene);
  const auto receivers = receivers_in_two_rooms(20);
  const CandidateSet set{lattice_m(0.5), {isotropic_luminaire()}};
  const auto got = computed(scene, rays, receivers, set, direct_only());
  std::vector<double> levels(set.columns());
  for (std::size_t c = 0; c < levels.size(); ++c) levels[c] = static_cast<double>(c % 5);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(receivers.size()));
  for (std::size_t c = 0; c < levels.size(); ++c) {
    std::vector<double> one(levels.size(), 0.0);
    one[c] = levels[c];
    sum += got.matrix.lux(receivers.size(), one);
  }
  EXPECT_LT((sum - got.matrix.lux(receivers.size(), levels)).norm(), 1e-12 * sum.norm());
}

TEST(CandidateTransport, StopsAndReportsProgress) {
  const Scene scene = two_rooms(0.6, true);
  const RayScene rays(scene);
  const auto receivers = receivers_in_two_rooms(10);
  const CandidateSet set{lattice_m(0.3), {isotropic_luminaire()}};
  for (const bool indirect : {false, true}) {
    CandidateOptions options;
    options.indirect = indirect;
    std::stop_source source;
    source.request_stop();
    options.watch.stop = source.get_token();
    const auto stopped = candidate_transport(scene, rays, receivers, set, options);
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.error().cause, Cause::cancelled);
  }
  CandidateOptions options = direct_only();
  options.memory_bound_bytes = 1'000'000;
  double last = 0;
  options.watch.progress = [&](double done) {
    EXPECT_GE(done, last);
    last = done;
  };
  const auto done = stream_candidates(scene, rays, receivers, set, options, [](const auto&) { return true; });
  EXPECT_TRUE(done);
  EXPECT_EQ(last, 1);
  const auto stopped = stream_candidates(scene, rays, receivers, set, options, [](const auto&) { return false; });
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().cause, Cause::cancelled);
}

TEST(CandidateTransport, RefusesInvalidInput) {
  const Scene scene = two_rooms(0.6, false);
  const RayScene rays(scene);
  const auto receivers = receivers_in_two_rooms(3);
  const auto refused = [&](const CandidateSet& set, CandidateOptions options, const char* why) {
    const auto result = candidate_transport(scene, rays, receivers, set, options);
    ASSERT_FALSE(result) << why;
    EXPECT_EQ(result.error().cause, Cause::invalid);
    EXPECT_NE(result.error().detail.find(why), std::string::npos) << result.error().detail;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused({{{1, 1, nan}}, {isotropic_luminaire()}}, {}, "position 0 is not finite");
  refused({{{1, 1, 1}}, {}}, {}, "no luminaire");
  Emitter disk = isotropic_luminaire();
  disk.shape = {LuminousShape::Kind::disk, Vec3::Constant(0.3)};
  refused({{{1, 1, 1}}, {disk}}, {}, "has a size");
  refused({{{1, 1, 1}}, {Emitter{}}}, {}, "no intensity");
  CandidateOptions options;
  options.min_lux = -1;
  refused({{{1, 1, 1}}, {isotropic_luminaire()}}, options, "least lux");
  options = {};
  options.wanted_relative_error = 0;
  refused({{{1, 1, 1}}, {isotropic_luminaire()}}, options, "wanted relative error");
  options = direct_only();
  options.memory_bound_bytes = 64;
  refused({{{1, 1, 1}}, {isotropic_luminaire()}}, options, "the bound is");
}

TEST(CandidateTransport, EmptyInputsGiveEmptyColumns) {
  const Scene scene = two_rooms(0.6, false);
  const RayScene rays(scene);
  const auto receivers = receivers_in_two_rooms(3);
  for (const bool indirect : {false, true}) {
    CandidateOptions options;
    options.indirect = indirect;
    const auto none = computed(scene, rays, receivers, {{}, {isotropic_luminaire()}}, options);
    EXPECT_EQ(none.matrix.columns(), 0u);
    const auto unread = computed(scene, rays, {}, {{{1, 1, 1}, {2, 1, 1}}, {isotropic_luminaire()}}, options);
    EXPECT_EQ(unread.matrix.columns(), 2u);
    EXPECT_EQ(unread.matrix.entries(), 0u);
    const Scene nothing;
    const RayScene no_rays(nothing);
    const auto open = computed(nothing, no_rays, receivers, {{{1, 1, 2}}, {isotropic_luminaire()}}, options);
    EXPECT_GT(open.matrix.entries(), 0u);
    EXPECT_EQ(open.statistics.rays, 0u);
  }
}

TEST(CandidateTransport, CandidatesInReceiversAndOnSurfacesGiveFiniteNumbers) {
  const Scene scene = two_rooms(0.6, true);
  const RayScene rays(scene);
  auto receivers = receivers_in_two_rooms(3);
  receivers.push_back({{1, 0, 1}, Vec3::UnitY()});  // in the wall's surface
  CandidateSet set{{}, {isotropic_luminaire()}};
  for (const Receiver& r : receivers) {
    set.positions_world_m.push_back(r.position_world_m);
    set.positions_world_m.push_back(r.position_world_m + 1e-300 * r.normal_world);
    set.positions_world_m.push_back(r.position_world_m + 1e-9 * r.normal_world);
    set.positions_world_m.push_back(r.position_world_m + 0.3 * r.normal_world);
  }
  set.positions_world_m.insert(set.positions_world_m.end(), {{2, 1, 2.5}, {0, 0, 0}, {8.15, 3, 2.5}, {4, 1.5, 2.0}});
  for (const bool indirect : {false, true}) {
    CandidateOptions options;
    options.indirect = indirect;
    options.surface_cells = 500;  // this test needs no accuracy
    options.max_rays_per_candidate = 256;
    const auto got = computed(scene, rays, receivers, set, options);
    EXPECT_GT(got.matrix.entries(), 0u);
    for (const auto* part : {&got.matrix.total_lux, &got.matrix.direct_lux, &got.matrix.standard_error_lux})
      for (const float lux : *part) EXPECT_TRUE(std::isfinite(lux) && lux >= 0);
  }
}

}  // namespace
}  // namespace luxrig
