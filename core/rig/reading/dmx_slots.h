#pragma once
/// The slots of a DMX fixture, as the rig file names them. Private to core/rig.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/rig/reading/section.h"
#include "core/rig/rig.h"

namespace luxrig {

/// Whose slots they are.
struct SlotOwner {
  std::string luminaire;
  std::vector<std::string> emitters;  ///< as slots call them; none: it has one dimmer
};

struct NamedSlot {
  DmxSlot slot;                        ///< a dimmer where it is an emitter's
  std::optional<std::size_t> emitter;  ///< in SlotOwner::emitters
  Place place;
};

/// The key `slots`, or its default; false, and problems, when it is wrong: then `slots` has those that are not. Without
/// an owner (its luminaire is not known, which is reported elsewhere) what depends on it goes unchecked.
[[nodiscard]] bool read_slots(Section& section, const std::optional<SlotOwner>& owner, std::vector<NamedSlot>& slots);

/// As one emitter of the owner sees them, or (nothing) a fixture with one dimmer. Slots of no emitter are sent for the
/// first and obeyed by all.
[[nodiscard]] std::vector<DmxSlot> slots_of(std::span<const NamedSlot> slots, std::optional<std::size_t> emitter);

}  // namespace luxrig
