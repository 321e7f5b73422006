#pragma once
/// A bus that is yet to be chosen: what hangs on it is planned, and never driven.

#include <string_view>
#include <vector>

#include "core/rig/rig.h"

namespace luxrig {

inline constexpr std::string_view kNullDriver = "null";

[[nodiscard]] inline bool is_null_bus(const Bus& bus) { return bus.driver == kNullDriver; }

/// Why a rig cannot be run, simulated or not: each null bus that a fixture or meter hangs on.
[[nodiscard]] std::vector<Problem> null_buses_in_use(const Rig& rig);

}  // namespace luxrig
