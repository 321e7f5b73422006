#pragma once
/// Fixtures that hang in one housing: those of a luminaire with emitters, set one by one but aimed together.

#include <string>
#include <vector>

#include "core/rig/rig.h"

namespace luxrig {

/// The fixtures that hang in the housing of this one, itself among them, rising.
[[nodiscard]] std::vector<std::size_t> housing_of(const Rig& rig, std::size_t fixture);

/// What the rig file calls that housing: of a fixture without emitters, its name.
[[nodiscard]] std::string housing_name(const Rig& rig, std::size_t fixture);

/// The luminaire of the whole housing: all its emitters together.
[[nodiscard]] const Luminaire& housing_luminaire(const Rig& rig, std::size_t fixture);

}  // namespace luxrig
