#pragma once
/// Which channel of a mode uses which slot. Private to core/rig/personality.

#include <string>

#include "core/rig/personality/personality.h"
#include "core/rig/problem_list.h"

namespace luxrig {

/// Sets the footprints of the mode from its channels. Problems, at `places[i]` for channel i: a slot outside 1…512, a
/// slot shared by two channels.
void lay_out_slots(PersonalityMode& mode, const std::vector<FilePosition>& places, ProblemList& problems);

}  // namespace luxrig
