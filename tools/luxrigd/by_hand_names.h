#pragma once
/// Names that a person gives: of fixtures, housings and points to set them by hand, of fixtures, housings and luxmeters
/// to bypass them; with * and ? for several.

#include <string>
#include <vector>

#include "core/rig/rig.h"
#include "core/show/by_hand.h"

namespace luxrig {

/// One for each fixture so called, in the rig's order: `what` and `index` are set, and whole_housing where the name is
/// that of a housing. Refused where a name is nobody's.
[[nodiscard]] Result<std::vector<ByHand>> fixtures_called(const Rig& rig, const std::vector<std::string>& names);
/// The same of points.
[[nodiscard]] Result<std::vector<ByHand>> points_called(const Rig& rig, const std::vector<std::string>& names);
/// Fixtures and points, each name at least one of the two; of a housing each of its fixtures.
[[nodiscard]] Result<std::vector<ByHand>> anything_called(const Rig& rig, const std::vector<std::string>& names);

/// What can be bypassed, in the rig's order: of a housing each of its fixtures.
struct Devices {
  std::vector<std::size_t> fixtures, luxmeters;
};
/// Fixtures, housings and luxmeters; refused where a name is nobody's.
[[nodiscard]] Result<Devices> devices_called(const Rig& rig, const std::vector<std::string>& names);

}  // namespace luxrig
