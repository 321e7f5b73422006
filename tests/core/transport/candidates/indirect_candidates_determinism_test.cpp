/// indirect_candidates: the same for any number of threads.

#include <gtest/gtest.h>

#include "core/parallel.h"
#include "core/transport/candidates/candidate_transport.h"
#include "core/transport/candidates/incremental_transport.h"
#include "tests/core/transport/candidates/box_rooms.h"
#include "tests/core/transport/candidates/computed.h"
#include "tests/core/transport/candidates/indirect_candidates_fixture.h"

namespace luxrig {
namespace {

using namespace indirect_candidates_fixture;

TEST(IndirectCandidates, AreTheSameBytesOnAnyThreadsAndInAnyMemory) {
  const Scene scene = two_rooms(0.7, true);
  const RayScene rays(scene);
  const auto receivers = receivers_in_two_rooms(8);
  const CandidateSet set{lattice_m(0.7), {isotropic_luminaire()}};
  CandidateOptions options = coarse();
  options.surface_cells = 300;
  options.max_rays_per_candidate = 256;
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

TEST(IncrementalTransport, GivesTheSameBytesOnAnyThreadsAlsoToManyCallersAtOnce) {
  const Scene scene = two_rooms(0.7, true);
  const RayScene rays(scene);
  std::vector<Emitter> emitters(6, isotropic_luminaire());
  for (std::size_t e = 0; e < emitters.size(); ++e)
    emitters[e].world_from_lamp.translation_m = {1 + 1.1 * static_cast<double>(e), 1.2, 2.2};
  std::vector<std::vector<Eigen::VectorXd>> total_lux;
  std::vector<Eigen::MatrixXd> direct_lux;
  for (const int threads : {1, 3}) {
    IncrementalOptions options;
    options.cells = 400;
    options.rays_per_column = 512;
    options.threads = threads;
    const auto transport = std::move(*IncrementalTransport::make(scene, rays, receivers_in_two_rooms(9), options));
    ASSERT_TRUE(transport->move_receiver(4, {{6.5, 1.1, 0.8}, Vec3::UnitZ()}));
    std::vector<Eigen::VectorXd>& columns = total_lux.emplace_back(emitters.size());
    parallel_for(emitters.size(), threads,
                 [&](std::size_t e) { columns[e] = transport->column(emitters[e])->total_lux; });
    Eigen::MatrixXd& lux = direct_lux.emplace_back(Eigen::MatrixXd::Zero(18, 6));
    EXPECT_GT(*transport->update_direct(emitters, rays, rays.bounds_world_m(), lux), 10u);
  }
  EXPECT_GT(total_lux[0][0].sum(), 0);
  EXPECT_EQ(total_lux[1], total_lux[0]);
  EXPECT_GT(direct_lux[0].sum(), 0);
  EXPECT_EQ(direct_lux[1], direct_lux[0]);
}

}  // namespace
}  // namespace luxrig
