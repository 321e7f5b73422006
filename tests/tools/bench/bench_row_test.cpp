#include "tools/bench/bench_row.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "tools/bench/bench.h"
#include "tools/bench/row_progress.h"

namespace luxrig {
namespace {

TEST(BenchRow, CsvStartsWithTheContractsColumns) {
  const std::vector<BenchRow> rows = {{"cube", "path", 0.004, 1.5, 0.005, 2.0, {{"rays", "12"}}},
                                      {"cube", "slow", 0.004, 2.5, 0.005, 2.0, {{"rays", "13"}}},
                                      {"free", "path", 0.5, 0.25, {}, {}, {{"rays", "14"}}}};
  EXPECT_EQ(csv_of(rows),
            "case,method,error,seconds,target_error,target_seconds,met,rays\n"
            "cube,path,0.004,1.5,0.005,2,1,12\n"
            "cube,slow,0.004,2.5,0.005,2,0,13\n"
            "free,path,0.5,0.25,,,,14\n");
}

TEST(BenchRow, ARefusedCaseHasNoErrorAndNoVerdict) {
  const std::vector<BenchRow> rows = {{"sky", "direct", std::nan(""), 0, {}, {}, {{"note", "refused"}}}};
  EXPECT_EQ(csv_of(rows),
            "case,method,error,seconds,target_error,target_seconds,met,note\n"
            "sky,direct,,0,,,,refused\n");
  EXPECT_NE(write_plot(rows, "test", testing::TempDir() + "/bench_nothing.png"), "");
}

TEST(BenchRow, CsvWithoutRowsIsTheHeader) {
  EXPECT_EQ(csv_of({}), "case,method,error,seconds,target_error,target_seconds,met\n");
}

TEST(BenchRow, PlotIsAPngAndAMissingFolderIsReported) {
  const std::vector<BenchRow> rows = {{"cube", "path", 0.1, 0.1, {}, {}, {}}, {"cube", "path", 0, 1, {}, {}, {}}};
  const std::string file = testing::TempDir() + "/bench_plot.png";
  EXPECT_EQ(write_plot(rows, "test", file), "");
  std::ifstream in(file, std::ios::binary);
  char magic[4] = {};
  in.read(magic, 4);
  EXPECT_EQ(std::string(magic, 4), "\x89PNG");
  EXPECT_NE(write_plot(rows, "test", testing::TempDir() + "/no/such/folder/plot.png"), "");
  EXPECT_NE(write_plot({}, "test", file), "");
}

TEST(BenchRow, RowsAreSavedAsTheyAreMade) {
  const std::string file = testing::TempDir() + "/bench_kept.csv";
  const std::vector<BenchRow> rows = {{"cube", "path", 0.5, 0.25, {}, {}, {{"rays", "14"}}},
                                      {"cube", "slow", 0.25, 0.5, {}, {}, {{"rays", "15"}}}};
  keep_rows_in(file);
  for (const BenchRow& row : rows) say_row_made(row);
  std::ostringstream kept;
  kept << std::ifstream(file, std::ios::binary).rdbuf();
  EXPECT_EQ(kept.str(), csv_of(rows));
  end_row_progress();
  say_row_made(rows[0]);  // there is no list to keep it in
  std::ostringstream still;
  still << std::ifstream(file, std::ios::binary).rdbuf();
  EXPECT_EQ(still.str(), csv_of(rows));
  end_row_progress();
}

TEST(Bench, AnUnknownSuiteIsBadInput) { EXPECT_EQ(run_bench("no-such-suite", {}), 2); }

}  // namespace
}  // namespace luxrig
