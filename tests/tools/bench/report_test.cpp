#include "tools/bench/report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

const Provenance kFirst{"1.0 (aaaa)", "2 × A", "2026-01-02"}, kLater{"1.1 (bbbb)", "4 × B", "2026-03-04"};
const std::vector<BenchRow> kRows = {{"flat", "path", 0.01, 1.5, 0.02, 2.0, {}},
                                     {"flat", "gather", 0.03, 0.5, 0.02, {}, {}}};

std::size_t lines_in(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(Report, ANewSuiteGetsItsTableAtTheEnd) {
  EXPECT_EQ(
      with_rows("# Benchmarks\n", "transport", "luxrig bench transport", kRows, kFirst),
      "# Benchmarks\n\n### transport\n\n"
      "| case | method | error | seconds | target | verdict | measured | command |\n"
      "|---|---|---|---|---|---|---|---|\n"
      "| flat | path | 0.01 | 1.5 | 0.02 in 2 s | good | 1.0 (aaaa), 2026-01-02, 2 × A | `luxrig bench transport` |\n"
      "| flat | gather | 0.03 | 0.5 | 0.02 | short | 1.0 (aaaa), 2026-01-02, 2 × A | `luxrig bench transport` |\n");
}

TEST(Report, ARowReplacesItsEarlierOneAndOthersStay) {
  std::string text = with_rows("# Benchmarks\n", "transport", "c", kRows, kFirst);
  text = with_rows(text, "nnls", "n", {{"lamps", "cold", 1e-15, 0.1, {}, {}, {}}}, kFirst);
  const std::string before = text;
  const std::vector<BenchRow> again = {{"flat", "gather", std::nan(""), 0.25, {}, {}, {}},
                                       {"box", "path", 0.5, 1, {}, {}, {}}};
  text = with_rows(text, "transport", "d", again, kLater);
  EXPECT_EQ(lines_in(text), lines_in(before) + 1);
  EXPECT_NE(text.find("| flat | path | 0.01 | 1.5 | 0.02 in 2 s | good | 1.0 (aaaa)"), std::string::npos);
  EXPECT_NE(text.find("| flat | gather | – | 0.25 | none | no target | 1.1 (bbbb), 2026-03-04, 4 × B | `d` |\n"
                      "| box | path |"),
            std::string::npos)
      << text;
  EXPECT_LT(text.find("| box | path |"), text.find("### nnls")) << "in its own table";
  EXPECT_EQ(with_rows(text, "transport", "d", again, kLater), text) << "measured the same again";
}

TEST(Report, CasesWithACommonPrefixAreDistinct) {
  std::string text = with_rows("", "s", "c", {{"flat", "path", 1, 1, {}, {}, {}}}, kFirst);
  text =
      with_rows(text, "s", "c", {{"flat", "path-2", 2, 2, {}, {}, {}}, {"flat-2", "path", 3, 3, {}, {}, {}}}, kFirst);
  EXPECT_NE(text.find("| flat | path | 1 |"), std::string::npos);
  EXPECT_NE(text.find("| flat | path-2 | 2 |"), std::string::npos);
  EXPECT_NE(text.find("| flat-2 | path | 3 |"), std::string::npos);
}

TEST(Report, ABarInANameStaysInItsCell) {
  const std::vector<BenchRow> rows = {{"a|b", "m", 1, 1, {}, {}, {}}};
  const std::string text = with_rows("", "s", "c | d", rows, kFirst);
  EXPECT_NE(text.find("| a\\|b | m |"), std::string::npos);
  EXPECT_EQ(with_rows(text, "s", "c | d", rows, kFirst), text);
}

TEST(Report, StatesProgramMachineAndDate) {
  const Provenance here = provenance();
  EXPECT_FALSE(here.version.empty());
  EXPECT_NE(here.machine.find("×"), std::string::npos);
  EXPECT_EQ(here.date.size(), 10u);
}

}  // namespace
}  // namespace luxrig
