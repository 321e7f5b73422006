/// candidate_transport: the same for any number of threads.
#include <gtest/gtest.h>

#include "core/transport/candidates/candidate_transport.h"
#include "tests/core/transport/candidates/box_rooms.h"
#include "tests/core/transport/candidates/candidate_transport_fixture.h"
#include "tests/core/transport/candidates/computed.h"

namespace luxrig {
namespace {

using namespace candidate_transport_fixture;

TEST(CandidateTransport, StreamsTheSameColumnsInAnyMemoryAndOnAnyThreads) {
  const Scene scene = two_rooms(0.6, true);
  const RayScene rays(scene);
  const auto receivers = receivers_in_two_rooms(20);
  const CandidateSet set{lattice_m(0.25), {isotropic_luminaire(), spot_luminaire(-Vec3::UnitZ())}};
  CandidateOptions options = direct_only();
  options.threads = 1;
  const auto whole = computed(scene, rays, receivers, set, options);
  for (const int threads : {2, 8}) {
    options.threads = threads;
    expect_same_bytes(computed(scene, rays, receivers, set, options).matrix, whole.matrix);
  }
  options.memory_bound_bytes = 300'000;
  CandidateColumns joined;
  int blocks = 0;
  const auto statistics = stream_candidates(scene, rays, receivers, set, options, [&](const CandidateColumns& block) {
    EXPECT_EQ(block.first_column, joined.columns());
    EXPECT_LE(block.bytes(), options.memory_bound_bytes);
    for (std::size_t c = 0; c < block.columns(); ++c)
      joined.begin.push_back(joined.begin.back() + block.begin[c + 1] - block.begin[c]);
    joined.receiver.insert(joined.receiver.end(), block.receiver.begin(), block.receiver.end());
    joined.direct_lux.insert(joined.direct_lux.end(), block.direct_lux.begin(), block.direct_lux.end());
    joined.total_lux.insert(joined.total_lux.end(), block.total_lux.begin(), block.total_lux.end());
    joined.standard_error_lux.insert(joined.standard_error_lux.end(), block.standard_error_lux.begin(),
                                     block.standard_error_lux.end());
    ++blocks;
    return true;
  });
  ASSERT_TRUE(statistics);
  EXPECT_GT(blocks, 5);
  expect_same_bytes(joined, whole.matrix);
  options.memory_bound_bytes = 500'000;
  const auto refused = candidate_transport(scene, rays, receivers, set, options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().cause, Cause::invalid);
  EXPECT_NE(refused.error().detail.find("columns fill the"), std::string::npos);
}

}  // namespace
}  // namespace luxrig
