#include "drivers/dmx/udmx/changed_range.h"

namespace luxrig::udmx {

std::optional<SlotRange> changed_range(const DmxSlots& known, const DmxSlots& wanted) {
  std::size_t first = 0, end = kDmxSlots;
  while (first < end && known[first] == wanted[first]) ++first;
  while (end > first && known[end - 1] == wanted[end - 1]) --end;
  if (first == end) return std::nullopt;
  return SlotRange{first, end - first};
}

}  // namespace luxrig::udmx
