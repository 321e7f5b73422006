#pragma once
/// Names that a person types: fixtures, housings and points to set by hand; fixtures, housings and luxmeters to bypass.
/// The wildcards * and ? match several.

#include <string>
#include <vector>

#include "core/rig/rig.h"
#include "core/show/by_hand.h"

namespace luxrig {

/// One entry per matching fixture, in the rig's order. Sets `what` and `index`, and whole_housing if the name is a
/// housing's. Refused if a name matches nothing.
[[nodiscard]] Result<std::vector<ByHand>> fixtures_called(const Rig& rig, const std::vector<std::string>& names);
/// The same for points.
[[nodiscard]] Result<std::vector<ByHand>> points_called(const Rig& rig, const std::vector<std::string>& names);
/// Fixtures and points; each name must match at least one of either. A housing stands for all its fixtures.
[[nodiscard]] Result<std::vector<ByHand>> anything_called(const Rig& rig, const std::vector<std::string>& names);

/// Devices that can be bypassed, in the rig's order. A housing stands for all its fixtures.
struct Devices {
  std::vector<std::size_t> fixtures, luxmeters;
};
/// Fixtures, housings and luxmeters. Refused if a name matches nothing.
[[nodiscard]] Result<Devices> devices_called(const Rig& rig, const std::vector<std::string>& names);

}  // namespace luxrig
