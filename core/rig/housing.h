#pragma once
/// Fixtures in one housing: the emitters of one luminaire, set one by one but aimed together.

#include <string>
#include <vector>

#include "core/rig/rig.h"

namespace luxrig {

/// All fixtures in the housing of `fixture`, itself included, rising.
[[nodiscard]] std::vector<std::size_t> housing_of(const Rig& rig, std::size_t fixture);

/// Name of that housing in the rig file. A fixture without emitters gives its own name.
[[nodiscard]] std::string housing_name(const Rig& rig, std::size_t fixture);

/// Luminaire of the whole housing: all its emitters together.
[[nodiscard]] const Luminaire& housing_luminaire(const Rig& rig, std::size_t fixture);

}  // namespace luxrig
