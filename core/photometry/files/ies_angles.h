#pragma once
/// Ranges of angles that an IES file may have, by photometric type. For the parser only.

#include <string>
#include <vector>

#include "core/photometry/files/file_text.h"
#include "core/photometry/files/ies.h"

namespace luxrig {

/// Checks the ranges of ascending angles against the symmetries of the file's type (LM-63-2002 §5.13, 5.14; planes
/// 90…270 from LM-63-1995). False with a problem. A range that omits directions gives a warning.
bool check_ies_angles(const IesFile& file, file_text::At vertical_at, file_text::At horizontal_at,
                      file_text::ProblemLog& problems, std::vector<std::string>& warnings);

}  // namespace luxrig
