#pragma once
/// A <DMXMode> of a GDTF description. Private to core/rig/personality.

#include "core/rig/personality/personality.h"
#include "core/rig/personality/xml_file.h"

namespace luxrig {

/// Most functions and sets of all modes together, where a referenced geometry counts once per reference. Without a
/// limit, references could make a small file endless.
inline constexpr std::size_t kMaxGdtfParts = 500'000;

/// `type`: the <FixtureType> around it. `personality` already has its profiles, and collects notes. `room`: how many
/// more functions and sets are allowed.
[[nodiscard]] PersonalityMode read_gdtf_mode(const XmlFile& xml, const pugi::xml_node& type, const pugi::xml_node& mode,
                                             Personality& personality, std::size_t& room, ProblemList& problems);

}  // namespace luxrig
