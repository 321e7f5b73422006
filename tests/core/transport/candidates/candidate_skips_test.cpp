/// In furnished rooms no skip of the candidate matrix moves an answer by more than its stated error: exact ones by
/// nothing.

#include <gtest/gtest.h>

#include <random>

#include "core/transport/candidates/candidate_transport.h"
#include "tests/core/transport/candidates/box_rooms.h"
#include "tools/bench/rooms/lit_room.h"

namespace luxrig {
namespace {

/// Anywhere in the box around the scene, solids included: a lamp to all sides and a spot.
CandidateSet places_in(const RayScene& rays, std::size_t count) {
  std::mt19937_64 random(11);
  const Eigen::AlignedBox3d box = rays.bounds_world_m();
  CandidateSet set{{}, {isotropic_luminaire(), spot_luminaire({0.2, 0.1, -1})}};
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 share;
    for (int k = 0; k < 3; ++k) share[k] = static_cast<double>(random() >> 11) * 0x1p-53;
    set.positions_world_m.push_back(box.min() + share.cwiseProduct(box.sizes()));
  }
  return set;
}

constexpr std::array kAll = {&CandidateSkips::other_air, &CandidateSkips::behind, &CandidateSkips::blockers,
                             &CandidateSkips::reach, &CandidateSkips::unlit};

TEST(CandidateSkips, InFurnishedRoomsDirectLightIsTheSameBytesWithoutAnyOfThem) {
  for (const LitRoom& room : {make_box_room(), make_eight_room_flat(), make_atrium()}) {
    const RayScene rays(room.scene);
    const CandidateSet set = places_in(rays, 400);
    CandidateOptions options;
    options.indirect = false;
    const auto all = candidate_transport(room.scene, rays, room.receivers, set, options);
    ASSERT_TRUE(all);
    EXPECT_GT(all->matrix.entries(), set.columns());
    for (const auto skip : kAll) {
      options.skips = {};
      options.skips.*skip = false;
      const auto got = candidate_transport(room.scene, rays, room.receivers, set, options);
      ASSERT_TRUE(got);
      EXPECT_EQ(got->matrix.begin, all->matrix.begin) << room.name;
      EXPECT_EQ(got->matrix.receiver, all->matrix.receiver) << room.name;
      EXPECT_EQ(got->matrix.total_lux, all->matrix.total_lux) << room.name;
    }
  }
}

TEST(CandidateSkips, ReachMovesNoEntryByMoreThanTheLeastLux) {
  const LitRoom room = make_eight_room_flat();
  const RayScene rays(room.scene);
  const CandidateSet set = places_in(rays, 400);
  CandidateOptions options;
  options.indirect = false;
  options.least_lux = 2;
  const auto with = candidate_transport(room.scene, rays, room.receivers, set, options);
  options.skips.reach = false;
  const auto without = candidate_transport(room.scene, rays, room.receivers, set, options);
  ASSERT_TRUE(with && without);
  EXPECT_LT(with->matrix.entries(), without->matrix.entries());
  EXPECT_LT(with->statistics.rays, without->statistics.rays);
  for (std::size_t c = 0; c < set.columns(); ++c) {
    const auto a = dense_column(without->matrix, c, without->matrix.total_lux, room.receivers.size());
    const auto b = dense_column(with->matrix, c, with->matrix.total_lux, room.receivers.size());
    for (std::size_t r = 0; r < room.receivers.size(); ++r)
      if (a[r] != b[r]) {
        EXPECT_EQ(b[r], 0) << c << ' ' << r;
        EXPECT_LT(a[r], 2) << c << ' ' << r;
      }
  }
}

// Without a skip other rays are cast, so that reflected light is estimated anew: of two estimates, 95 % should be
// within twice the errors of both.
TEST(CandidateSkips, InAFurnishedRoomReflectedLightStaysWithinItsErrorWithoutAnyOfThem) {
  const LitRoom room = make_box_room();
  const RayScene rays(room.scene);
  const CandidateSet set = places_in(rays, 60);
  CandidateOptions options;
  options.surface_cells = 700;
  options.most_rays_per_candidate = 256;
  options.least_lux = 0.05;
  const auto all = candidate_transport(room.scene, rays, room.receivers, set, options);
  ASSERT_TRUE(all);
  for (const auto skip : kAll) {
    options.skips = {};
    options.skips.*skip = false;
    const auto got = candidate_transport(room.scene, rays, room.receivers, set, options);
    ASSERT_TRUE(got);
    // The plan of how many rays each needs may differ a little.
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
