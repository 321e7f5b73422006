#pragma once
/// The slots to send to a uDMX. Pure.

#include <cstddef>
#include <optional>

#include "drivers/dmx/dmx_patch.h"

namespace luxrig::udmx {

/// Slots first … first + count − 1; first counts from 0.
struct SlotRange {
  std::size_t first = 0, count = 0;
  friend bool operator==(const SlotRange&, const SlotRange&) = default;
};

/// The shortest range that holds every difference, for one transfer: with two, the widget could send a packet with half
/// of a 16-bit value. Empty if there is no difference.
[[nodiscard]] std::optional<SlotRange> changed_range(const DmxSlots& known, const DmxSlots& wanted);

/// The widget's packets end with the highest slot it ever received, and short packets upset some fixtures. So the first
/// range covers all slots.
inline constexpr SlotRange kAllSlots{0, kDmxSlots};

}  // namespace luxrig::udmx
