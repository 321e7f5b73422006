#include <gtest/gtest.h>

#include <cmath>

#include "tools/bench/transport/candidates.h"

namespace luxrig {
namespace {

TEST(MedianOf, IsTheMiddleValueAndHandlesNoValues) {
  EXPECT_EQ(median_of(std::vector<double>{3, 1, 2}), 2);
  EXPECT_EQ(median_of(std::vector<double>{4, 1}), 4);
  EXPECT_TRUE(std::isnan(median_of(std::vector<double>{})));
  const std::vector<CallSeconds> calls = {{1, 30}, {3, 10}, {2, 20}};
  EXPECT_EQ(median_of(calls).wall, 2);
  EXPECT_EQ(median_of(calls).cpu, 20);
}

TEST(Timed, CountsProcessorTimeOfWorkNotOfWaiting) {
  volatile double sum = 0;
  const CallSeconds took = timed([&] {
    for (int i = 0; i < 20'000'000; ++i) sum = sum + 1;
  });
  EXPECT_GT(took.cpu, 0);
  EXPECT_GT(took.wall, 0);
  EXPECT_LE(took.cpu, took.wall + 0.05) << "one thread";
}

CandidateColumns columns_of(const std::vector<std::vector<float>>& lux, float error) {
  CandidateColumns columns;
  for (const auto& column : lux) {
    for (std::uint32_t r = 0; r < column.size(); ++r)
      if (column[r] > 0) {
        columns.receiver.push_back(r);
        columns.total_lux.push_back(column[r]);
        columns.direct_lux.push_back(column[r]);
        columns.standard_error_lux.push_back(error);
      }
    columns.begin.push_back(columns.receiver.size());
  }
  return columns;
}

TEST(EntryMoves, CoverEveryEntryOfEither) {
  const auto a = columns_of({{100, 10, 0}, {0, 0, 4}}, 0.3f), b = columns_of({{101, 10, 0}, {0, 0, 0}}, 0.4f);
  const EntryMoves moves = moves_between(a, b, 3, 0);
  EXPECT_NEAR(moves.largest, 4.0 / 101, 1e-6);
  // Three entries: 1 lx equals twice hypot(0.3, 0.4), 4 lx exceeds twice 0.3.
  EXPECT_NEAR(moves.beyond_two_errors, 1.0 / 3, 1e-12);
  EXPECT_NEAR(moves.sum, 3.0 / 114, 1e-6);
  const EntryMoves allowed = moves_between(a, b, 3, 4);
  EXPECT_EQ(allowed.largest, 0);
  EXPECT_EQ(allowed.beyond_two_errors, 0);
  EXPECT_EQ(moves_between(a, a, 3, 0).largest, 0);
  EXPECT_EQ(moves_between({}, {}, 3, 0).sum, 0);
}

TEST(ThisManyReceivers, AreASubsetOrAllOfTheRoomsAndMoreInItsAir) {
  const TransportCase one(make_box_room());
  const std::size_t all = one.room.receivers.size();
  const auto some = this_many_receivers(one, all / 4);
  EXPECT_EQ(some.size(), all / 4);
  const auto more = this_many_receivers(one, 3 * all);
  ASSERT_EQ(more.size(), 3 * all);
  for (std::size_t r = all; r < more.size(); ++r) {
    EXPECT_TRUE(more[r].position_world_m.allFinite());
    EXPECT_FALSE(one.rays.occluded(one.room.receivers[0].position_world_m, Vec3::Zero(), more[r].position_world_m) &&
                 !one.rays.bounds_world_m().contains(more[r].position_world_m));
  }
}

}  // namespace
}  // namespace luxrig
