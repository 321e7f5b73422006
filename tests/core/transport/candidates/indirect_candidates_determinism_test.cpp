/// indirect_candidates: the same for any number of threads.

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace luxrig
