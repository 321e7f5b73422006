#pragma once
/// The light of a plan when the daemon first lets it out, with its margins for limits that no luxmeter has confirmed.

#include <string>

#include "core/tasks/solve_tasks.h"

namespace luxrig {

/// Sets opening_lux of each point that gets more than 1 % less than the plan states. Does nothing for a plan with
/// lights that do not hang yet. rig: as it hangs.
void add_opening_light(SolvedTasks& solved, const Rig& rig);

/// Text for a person, a line per point; empty if the plan goes out unchanged.
[[nodiscard]] std::string opening_light_text(const Plan& plan, const Rig& rig);

}  // namespace luxrig
