#pragma once
/// A <DMXMode> of a GDTF description. Private to core/rig/personality.

#include "core/rig/personality/personality.h"
#include "core/rig/personality/xml_file.h"

namespace luxrig {

/// Functions and sets of all modes together, those of referenced geometries counted for each reference: references
/// could make a small file endless.
inline constexpr std::size_t kMostGdtfParts = 500'000;

/// `type`: the <FixtureType> it belongs to. `personality` has its profiles already, and takes notes. `room`: how many
/// functions and sets may still come.
[[nodiscard]] PersonalityMode read_gdtf_mode(const XmlFile& xml, const pugi::xml_node& type, const pugi::xml_node& mode,
                                             Personality& personality, std::size_t& room, ProblemList& problems);

}  // namespace luxrig
