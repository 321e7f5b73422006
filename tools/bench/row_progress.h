#pragma once
/// Reports a suite's progress on stderr and saves its rows, because suites take minutes and may be stopped.

#include <filesystem>
#include <string_view>

#include "tools/bench/bench_row.h"

namespace luxrig {

/// Rows go to this file as they are made, until end_row_progress(); empty = no file. The first row replaces the old
/// content.
void keep_rows_in(const std::filesystem::path& csv_file);
/// Call for every row: one line on a terminal, rewritten in place; elsewhere a line every ten seconds.
void say_row_made(const BenchRow& row);
/// The same for work that makes no row.
void say_row_made(std::string_view case_name, std::string_view method);
/// Clears the line. Call before the table is printed.
void end_row_progress();

}  // namespace luxrig
