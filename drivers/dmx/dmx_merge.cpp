#include "drivers/dmx/dmx_merge.h"

#include <algorithm>

namespace luxrig {

void SentSlots::take(std::span<const std::uint8_t> slots, std::uint64_t tick) {
  const std::size_t given = std::min(slots.size(), kDmxSlots);
  for (std::size_t i = 0; i < given; ++i) {
    if (changed[i] == 0 || value[i] != slots[i]) changed[i] = tick;
    value[i] = slots[i];
  }
  count = std::max(count, given);
}

Merged merge(std::span<const MergeInput> senders, MergeRule rule) {
  Merged out;
  for (std::size_t i = 0; i < kDmxSlots; ++i) {
    int highest = -1;
    std::uint64_t latest = 0;
    for (const MergeInput& sender : senders) {
      if (i >= sender.slots->count) continue;
      int priority = sender.priority;
      if (sender.slot_priority != nullptr) {
        if ((*sender.slot_priority)[i] == 0) continue;
        priority = (*sender.slot_priority)[i];
      }
      const std::uint8_t value = sender.slots->value[i];
      const std::uint64_t changed = sender.slots->changed[i];
      const bool wins = priority > highest ||
                        (priority == highest && (rule == MergeRule::htp ? value > out.slots[i] : changed > latest));
      if (!wins) continue;
      highest = priority;
      latest = changed;
      out.slots[i] = value;
    }
    out.given[i] = highest >= 0;
  }
  return out;
}

}  // namespace luxrig
