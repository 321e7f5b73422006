#include <gtest/gtest.h>

#include <cmath>

#include "tools/bench/transport/candidates.h"

namespace luxrig {
namespace {

std::vector<BenchRow> rows_of(void (*add)(const BenchOptions&, std::vector<BenchRow>&), const std::string& only) {
  BenchOptions options;
  options.quick = true;
  options.only = only;
  std::vector<BenchRow> rows;
  add(options, rows);
  return rows;
}

const BenchRow* row_named(const std::vector<BenchRow>& rows, const std::string& name, const std::string& method = "") {
  for (const BenchRow& row : rows)
    if (row.case_name == name && (method.empty() || row.method == method)) return &row;
  return nullptr;
}

TEST(MedianOf, IsTheMiddleAndNothingOfNothing) {
  EXPECT_EQ(median_of(std::vector<double>{3, 1, 2}), 2);
  EXPECT_EQ(median_of(std::vector<double>{4, 1}), 4);
  EXPECT_TRUE(std::isnan(median_of(std::vector<double>{})));
  const std::vector<CallSeconds> calls = {{1, 30}, {3, 10}, {2, 20}};
  EXPECT_EQ(median_of(calls).wall, 2);
  EXPECT_EQ(median_of(calls).cpu, 20);
}

TEST(Timed, CountsProcessorTimeOfWorkAndNotOfWaiting) {
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

TEST(EntryMoves, AreOfEveryEntryThatEitherHas) {
  const auto a = columns_of({{100, 10, 0}, {0, 0, 4}}, 0.3f), b = columns_of({{101, 10, 0}, {0, 0, 0}}, 0.4f);
  const EntryMoves moves = moves_between(a, b, 3, 0);
  EXPECT_NEAR(moves.largest, 4.0 / 101, 1e-6);
  // Three entries; 1 lx is twice hypot(0.3, 0.4), 4 lx more than twice 0.3.
  EXPECT_NEAR(moves.beyond_two_errors, 1.0 / 3, 1e-12);
  EXPECT_NEAR(moves.sum, 3.0 / 114, 1e-6);
  const EntryMoves allowed = moves_between(a, b, 3, 4);
  EXPECT_EQ(allowed.largest, 0);
  EXPECT_EQ(allowed.beyond_two_errors, 0);
  EXPECT_EQ(moves_between(a, a, 3, 0).largest, 0);
  EXPECT_EQ(moves_between({}, {}, 3, 0).sum, 0);
}

TEST(ThisManyReceivers, AreSomeOfTheRoomsOrAllAndOthersThatHangInTheSameAir) {
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

TEST(TransportRows, SkipsOfACandidateMatrixMoveDirectLightByNothing) {
  const auto rows = rows_of(add_candidate_skip_rows, "skip-box-direct");
  ASSERT_EQ(rows.size(), 5u);  // other-air, behind, blockers, reach, all
  for (const BenchRow& row : rows) EXPECT_EQ(row.met(), std::optional(true)) << row.case_name << ' ' << row.error;
  ASSERT_TRUE(row_named(rows, "skip-box-direct-other-air"));
  EXPECT_NE(row_named(rows, "skip-box-direct-other-air")->further.back().second.find("skips "), std::string::npos);
}

TEST(TransportRows, SkipsOfEvaluatorsMoveLightWithinItsError) {
  const auto rows = rows_of(add_evaluator_skip_rows, "skip-box");
  ASSERT_EQ(rows.size(), 3u);
  for (const BenchRow& row : rows) EXPECT_EQ(row.met(), std::optional(true)) << row.case_name << ' ' << row.error;
}

TEST(TransportRows, AChangedLampHasARowPerMethodAndTheirComparison) {
  const auto rows = rows_of(add_changed_lamp_rows, "changed-lamp");
  ASSERT_EQ(rows.size(), 5u);
  for (const char* method : {"cache", "incremental", "path", "gather"}) {
    const BenchRow* row = row_named(rows, "changed-lamp-box-1", method);
    ASSERT_TRUE(row) << method;
    EXPECT_LT(row->error, 0.1) << method;
    EXPECT_GT(row->seconds, 0) << method;
  }
  const BenchRow* compared = row_named(rows, "changed-lamp-box-to-0.03");
  ASSERT_TRUE(compared);
  EXPECT_EQ(compared->error, row_named(rows, "changed-lamp-box-1", "cache")->error);
  EXPECT_NEAR(*compared->target_seconds, row_named(rows, "changed-lamp-box-1", "path")->seconds / 5, 1e-12);
}

TEST(TransportRows, GrowthIsToldWithCandidatesAndPoints) {
  const auto rows = rows_of(add_growth_rows, "matrix-growth-direct");
  for (const char* name :
       {"matrix-growth-direct-300x1000", "matrix-growth-direct-150x10000", "matrix-growth-direct-300x10000"}) {
    ASSERT_TRUE(row_named(rows, name)) << name;
    EXPECT_LT(row_named(rows, name)->error, 1e-6) << "direct light against the direct evaluator";
  }
  ASSERT_TRUE(row_named(rows, "matrix-growth-direct-with-candidates"));
  ASSERT_TRUE(row_named(rows, "matrix-growth-direct-with-points"));
}

TEST(TransportRows, AMillionIsAskedForByNameOnly) {
  EXPECT_TRUE(rows_of(add_growth_rows, "matrix-million").size() == 1);
  EXPECT_TRUE(rows_of(add_growth_rows, "moved").empty());
  for (const BenchRow& row : rows_of(add_growth_rows, "matrix"))
    EXPECT_EQ(row.case_name.find("million"), std::string::npos);
}

TEST(TransportRows, AMovedObjectIsAskedAboutOnlyWhereItMatters) {
  const auto rows = rows_of(add_moved_rows, "moved-object-direct");
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].met(), std::optional(true)) << rows[0].error;
  EXPECT_EQ(rows[0].method, "incremental");
  EXPECT_GT(std::stoi(rows[0].further.back().second), 0) << "the note begins with how many entries change";
}

}  // namespace
}  // namespace luxrig
