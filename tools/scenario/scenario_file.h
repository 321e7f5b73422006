#pragma once
/// Reads a scenario for a rig. The keys: core/rig/schema/scenario_keys.cpp.

#include "core/result.h"
#include "tools/scenario/scenario.h"

namespace luxrig::scenario {

/// All problems, or a Scenario. Refuses a text of more than a megabyte. file: for problems and relative paths.
[[nodiscard]] Checked<Scenario> parse_scenario(std::string_view text, const std::filesystem::path& file,
                                               const Rig& rig);

/// "7", "1..20", "1, 5, 9..12": rising, each once, at most 100,000. Empty if it is none of these.
[[nodiscard]] std::vector<std::uint64_t> parse_seeds(std::string_view text);

}  // namespace luxrig::scenario
