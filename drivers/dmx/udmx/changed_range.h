#pragma once
/// What a uDMX must be told. Pure.

#include <cstddef>
#include <optional>

#include "drivers/dmx/dmx_patch.h"

namespace luxrig::udmx {

/// Slots first … first + count − 1; first counts from 0.
struct SlotRange {
  std::size_t first = 0, count = 0;
  friend bool operator==(const SlotRange&, const SlotRange&) = default;
};

/// The shortest range that holds every difference, for one transfer: two would let the widget send a packet with half
/// of a 16-bit value. Nothing when they are the same.
[[nodiscard]] std::optional<SlotRange> changed_range(const DmxSlots& known, const DmxSlots& wanted);

/// A packet of the widget ends with the highest slot it was ever told, and short packets upset some fixtures: so the
/// first range is all of them.
inline constexpr SlotRange kAllSlots{0, kDmxSlots};

}  // namespace luxrig::udmx
