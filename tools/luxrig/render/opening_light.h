#pragma once
/// What a plan gives when the daemon lets it out first: its margins for what no luxmeter has confirmed included.

#include <string>

#include "core/tasks/solve_tasks.h"

namespace luxrig {

/// Sets opening_lux of each point that gets less than the plan says, by more than 1 %. Nothing for a plan whose lights
/// do not hang yet. rig: as it hangs.
void add_opening_light(SolvedTasks& solved, const Rig& rig);

/// For a person, a line per point; empty when the plan goes out as it is.
[[nodiscard]] std::string opening_light_text(const Plan& plan, const Rig& rig);

}  // namespace luxrig
