#include "core/rig/personality/slot_overlap.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/text/plain_text.h"

namespace luxrig {

void lay_out_slots(PersonalityMode& mode, const std::vector<FilePosition>& places, ProblemList& problems) {
  std::map<int, int> footprints;  // by break
  std::map<std::pair<int, int>, std::size_t> taken;
  for (std::size_t c = 0; c < mode.channels.size(); ++c) {
    const PersonalityChannel& channel = mode.channels[c];
    for (const int offset : channel.offsets) {
      if (offset < 0 || offset >= 512) {
        problems.add(places[c],
                     fmt::format("mode {}: channel {} takes slot {}, and a universe has 1 to 512", in_quotes(mode.name),
                                 in_quotes(channel.name), offset + 1),
                     "correct the channel's offsets");
        break;
      }
      const auto [at, is_new] = taken.try_emplace({channel.dmx_break, offset}, c);
      if (!is_new) {
        problems.add(places[c],
                     fmt::format("mode {}: channel {} takes slot {}, which channel {} has", in_quotes(mode.name),
                                 in_quotes(channel.name), offset + 1, in_quotes(mode.channels[at->second].name)),
                     "give each channel its own slots");
        break;
      }
      footprints[channel.dmx_break] = std::max(footprints[channel.dmx_break], offset + 1);
    }
  }
  mode.break_footprints.clear();
  for (const auto& [number, footprint] : footprints) mode.break_footprints.push_back(footprint);
}

}  // namespace luxrig
