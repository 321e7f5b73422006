#pragma once
/// The placement methods of a rig file by name: luxrig's own and the thesis's.

#include <span>
#include <string_view>

#include "core/solve/placement/methods/placement_method.h"

namespace luxrig {

/// Luxrig's own first.
[[nodiscard]] std::span<const PlacementMethod> placement_methods();

/// nullptr if there is none of that name.
[[nodiscard]] const PlacementMethod* find_placement_method(std::string_view name);

}  // namespace luxrig
