/// In furnished rooms no skip of the candidate matrix moves a result by more than its stated error. Exact skips move
/// nothing.

#include <gtest/gtest.h>

#include "core/transport/candidates/candidate_transport.h"
#include "tests/core/transport/candidates/box_rooms.h"
#include "tests/core/transport/candidates/candidate_skips_fixture.h"
#include "tools/bench/rooms/lit_room.h"

namespace luxrig {
namespace {

using namespace candidate_skips_fixture;

TEST(CandidateSkips, ChangeNoByteOfDirectLight) {
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
  options.min_lux = 2;
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

}  // namespace
}  // namespace luxrig
