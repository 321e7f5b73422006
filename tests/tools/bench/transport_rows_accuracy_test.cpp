/// transport_rows: accuracy over many samples.
#include <gtest/gtest.h>

#include "core/transport/candidates/candidate_transport.h"
#include "tools/bench/transport/case.h"

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

TEST(TransportRows, SkipsOfACandidateMatrixLeaveDirectLightUnchanged) {
  const auto rows = rows_of(add_candidate_skip_rows, "skip-box-direct");
  ASSERT_EQ(rows.size(), 5u);  // other-air, behind, blockers, reach, all
  for (const BenchRow& row : rows) EXPECT_EQ(row.met(), std::optional(true)) << row.case_name << ' ' << row.error;
  ASSERT_TRUE(row_named(rows, "skip-box-direct-other-air"));
  EXPECT_NE(row_named(rows, "skip-box-direct-other-air")->further.back().second.find("skips "), std::string::npos);
}

TEST(TransportRows, SkipsOfEvaluatorsShiftLightOnlyWithinItsError) {
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

TEST(TransportRows, ReportGrowthWithCandidatesAndPoints) {
  const auto rows = rows_of(add_growth_rows, "matrix-growth-direct");
  for (const char* name :
       {"matrix-growth-direct-300x1000", "matrix-growth-direct-150x10000", "matrix-growth-direct-300x10000"}) {
    ASSERT_TRUE(row_named(rows, name)) << name;
    EXPECT_LT(row_named(rows, name)->error, 1e-6) << "direct light against the direct evaluator";
  }
  ASSERT_TRUE(row_named(rows, "matrix-growth-direct-with-candidates"));
  ASSERT_TRUE(row_named(rows, "matrix-growth-direct-with-points"));
}

TEST(TransportRows, AMillionCandidatesRunOnlyWhenNamed) {
  EXPECT_TRUE(rows_of(add_growth_rows, "matrix-million").size() == 1);
  EXPECT_TRUE(rows_of(add_growth_rows, "moved").empty());
  for (const BenchRow& row : rows_of(add_growth_rows, "matrix"))
    EXPECT_EQ(row.case_name.find("million"), std::string::npos);
}

TEST(TransportRows, AMovedObjectCastsRaysOnlyWhereItMatters) {
  const auto rows = rows_of(add_moved_rows, "moved-object-direct");
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].met(), std::optional(true)) << rows[0].error;
  EXPECT_EQ(rows[0].method, "incremental");
  EXPECT_GT(std::stoi(rows[0].further.back().second), 0) << "the note begins with how many entries change";
}

}  // namespace
}  // namespace luxrig
