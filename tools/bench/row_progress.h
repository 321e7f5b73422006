#pragma once
/// Says on stderr what a suite has done so far, and keeps it, for suites take minutes and may be stopped.

#include <filesystem>
#include <string_view>

#include "tools/bench/bench_row.h"

namespace luxrig {

/// Rows go to this file as they are made, until end_row_progress(); empty: to none. What is there is replaced by the
/// first row.
void keep_rows_in(const std::filesystem::path& csv_file);
/// To be called for every row that is made: on a terminal one line that is written over, else one every ten seconds.
void say_row_made(const BenchRow& row);
/// Of work that gives no row by itself.
void say_row_made(std::string_view case_name, std::string_view method);
/// Before the table is printed: the line goes.
void end_row_progress();

}  // namespace luxrig
