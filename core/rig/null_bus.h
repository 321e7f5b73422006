#pragma once
/// A bus that is not chosen yet. Its fixtures are planned but never driven.

#include <string_view>
#include <vector>

#include "core/rig/rig.h"

namespace luxrig {

inline constexpr std::string_view kNullDriver = "null";

[[nodiscard]] inline bool is_null_bus(const Bus& bus) { return bus.driver == kNullDriver; }

/// Reasons why a rig cannot run, simulated or not: one for each null bus with a fixture or meter on it.
[[nodiscard]] std::vector<Problem> null_buses_in_use(const Rig& rig);

}  // namespace luxrig
