#pragma once
/// The functions of a <DMXChannel> of a GDTF description. Private to core/rig/personality.

#include "core/rig/personality/personality.h"
#include "core/rig/personality/xml_file.h"

namespace luxrig {

/// As written. Can be resolved once all channels of the mode are known.
struct GdtfCondition {
  std::string master, from, to;  ///< empty master = the function always exists
};

struct GdtfFunctions {
  std::vector<ChannelFunction> functions;
  std::vector<GdtfCondition> conditions;  ///< one per function
  std::uint32_t default_dmx = 0;          ///< of the channel
};

/// `bytes`: resolution of the channel. A function ends before the next higher one with the same condition.
[[nodiscard]] GdtfFunctions read_gdtf_functions(const XmlFile& xml, const pugi::xml_node& channel, int bytes,
                                                Personality& personality, ProblemList& problems);

}  // namespace luxrig
