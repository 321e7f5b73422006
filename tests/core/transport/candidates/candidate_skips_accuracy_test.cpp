/// candidate_skips: accuracy over many samples.

#include <gtest/gtest.h>

#include "core/transport/candidates/candidate_transport.h"
#include "tests/core/transport/candidates/box_rooms.h"
#include "tests/core/transport/candidates/candidate_skips_fixture.h"
#include "tools/bench/rooms/lit_room.h"

namespace luxrig {
namespace {

using namespace candidate_skips_fixture;

// Without a skip, different rays are cast, so reflected light is a new estimate. For two estimates, 95 % of differences
// should be within twice their combined error.
TEST(CandidateSkips, ChangeReflectedLightOnlyWithinItsError) {
  const LitRoom room = make_box_room();
  const RayScene rays(room.scene);
  const CandidateSet set = places_in(rays, 60);
  CandidateOptions options;
  options.surface_cells = 700;
  options.max_rays_per_candidate = 256;
  options.min_lux = 0.05;
  const auto all = candidate_transport(room.scene, rays, room.receivers, set, options);
  ASSERT_TRUE(all);
  for (const auto skip : kAll) {
    options.skips = {};
    options.skips.*skip = false;
    const auto got = candidate_transport(room.scene, rays, room.receivers, set, options);
    ASSERT_TRUE(got);
    // The planned number of rays may differ a little.
    EXPECT_GE(got->statistics.rays, all->statistics.rays * 9 / 10);
    std::size_t entries = 0, moved = 0;
    double sum = 0, other_sum = 0;
    for (std::size_t c = 0; c < set.columns(); ++c) {
      const auto a = dense_column(all->matrix, c, all->matrix.total_lux, room.receivers.size());
      const auto error_a = dense_column(all->matrix, c, all->matrix.standard_error_lux, room.receivers.size());
      const auto b = dense_column(got->matrix, c, got->matrix.total_lux, room.receivers.size());
      const auto error_b = dense_column(got->matrix, c, got->matrix.standard_error_lux, room.receivers.size());
      for (std::size_t r = 0; r < room.receivers.size(); ++r) {
        entries += a[r] > 0 || b[r] > 0;
        moved += std::abs(a[r] - b[r]) > 2 * std::hypot(error_a[r], error_b[r]) + 1e-6f * a[r] +
                                             (skip == &CandidateSkips::reach ? 0.05f : 0.0f);
        sum += static_cast<double>(a[r]), other_sum += static_cast<double>(b[r]);
      }
    }
    EXPECT_GT(entries, 1000u);
    EXPECT_LE(moved, 0.05 * static_cast<double>(entries));
    EXPECT_NEAR(sum, other_sum, 0.005 * sum);
  }
}

}  // namespace
}  // namespace luxrig
