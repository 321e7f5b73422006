#pragma once
/// Measured rows in a Markdown file, each with the program, the machine and the day.

#include <string>
#include <string_view>
#include <vector>

#include "tools/bench/bench_row.h"

namespace luxrig {

struct Provenance {
  std::string version;  ///< with the commit
  std::string machine;  ///< processor and number of cores
  std::string date;     ///< YYYY-MM-DD, UTC
};
/// Of this program, here and now.
[[nodiscard]] Provenance provenance();

/// The text with these rows in the table of the suite. A row takes the place of an earlier one of its case and method;
/// others stay, each as it was measured. A suite without a table gets one at the end, under "### suite".
/// command   that prints the rows again
[[nodiscard]] std::string with_rows(std::string_view text, std::string_view suite, std::string_view command,
                                    const std::vector<BenchRow>& rows, const Provenance& by);

}  // namespace luxrig
