#pragma once
/// The capabilities of an Open Fixture Library channel, as functions. Private to core/rig/personality.

#include "core/rig/personality/ofl/ofl_json.h"
#include "core/rig/personality/personality.h"
#include "core/rig/problem_list.h"

namespace luxrig {

struct OflFixture {
  const OflJson& json;
  bool adds_colours = true;  ///< false = its cyan, magenta and yellow are filters before a white lamp
};

struct OflFunctions {
  std::vector<ChannelFunction> functions;
  std::uint32_t default_dmx = 0;
  std::optional<std::uint32_t> highlight_dmx;
};

/// `channel`, called `key`, in a mode that uses `bytes` bytes of it.
[[nodiscard]] OflFunctions read_ofl_functions(const OflFixture& fixture, const std::string& key, const OflJson& channel,
                                              int bytes, ProblemList& problems);

/// Number of bytes of the channel: one plus its fine channels.
[[nodiscard]] int ofl_resolution(const OflJson& channel);

/// All capabilities of a channel, one or several.
[[nodiscard]] std::vector<const OflJson*> ofl_capabilities(const OflJson& channel);

}  // namespace luxrig
