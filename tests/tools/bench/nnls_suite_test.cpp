#include <gtest/gtest.h>

#include "tools/bench/nnls/problems.h"
#include "tools/bench/suites.h"

namespace luxrig {
namespace {

TEST(NnlsSuite, QuickRowsAreOptimal) {
  BenchOptions options;
  options.quick = true;
  options.only = "random-300x2000";
  options.export_folder = std::filesystem::path(testing::TempDir()) / "nnls_suite";
  std::filesystem::remove_all(options.export_folder);
  const std::vector<BenchRow> rows = bench_nnls(options);
  EXPECT_EQ(rows.size(), 8u);  // random-300x2000 and random-300x20000
  for (const BenchRow& row : rows) EXPECT_LT(row.error, 1e-9) << row.case_name << ", " << row.method;
  const NnlsBenchProblem problem = random_nnls(300, 2'000, 0.6);
  EXPECT_EQ(std::filesystem::file_size(options.export_folder / "random-300x2000.nnls"),
            24 + 8 * problem.begin.size() + 8 * problem.row.size() + 8 * 300);
}

TEST(NnlsSuite, ProblemsAreReproducibleWithTheirStatedDensity) {
  for (const auto make : {random_nnls, lamps_nnls}) {
    const NnlsBenchProblem one = make(200, 500, 0.1), other = make(200, 500, 0.1);
    EXPECT_EQ(one.row, other.row);
    EXPECT_EQ(one.value, other.value);
    EXPECT_EQ(one.goal, other.goal);
    EXPECT_NEAR(static_cast<double>(one.row.size()) / (200 * 500), 0.1, 0.03);
    EXPECT_EQ(one.problem().complaint(), "");
  }
}

}  // namespace
}  // namespace luxrig
