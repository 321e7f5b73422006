#pragma once
/// Says on stderr what a suite has done so far, for suites take minutes.

#include <string_view>

namespace luxrig {

/// To be called for every row that is made: on a terminal one line that is written over, else one every ten seconds.
void say_row_made(std::string_view case_name, std::string_view method);
/// Before the table is printed: the line goes.
void end_row_progress();

}  // namespace luxrig
