#pragma once
/// The slots of a DMX fixture, as named in the rig file. Private to core/rig.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/rig/patch.h"
#include "core/rig/reading/section.h"

namespace luxrig {

/// The luminaire that the slots belong to.
struct SlotOwner {
  std::string luminaire;
  std::vector<std::string> emitters;  ///< names used by slots; none = it has one dimmer
};

struct NamedSlot {
  DmxSlot slot;                        ///< a dimmer if it belongs to an emitter
  std::optional<std::size_t> emitter;  ///< in SlotOwner::emitters
  FilePosition in_file;
};

/// Reads the key `slots`, or its default. False and problems if it is wrong; `slots` then holds the good ones. Without
/// an owner (the luminaire is unknown, which is reported elsewhere), checks that need it are skipped.
[[nodiscard]] bool read_slots(Section& section, const std::optional<SlotOwner>& owner, std::vector<NamedSlot>& slots);

/// The slots as seen by one emitter of the owner, or (nullopt) by a fixture with one dimmer. Slots of no emitter are
/// sent for the first one and obeyed by all.
[[nodiscard]] std::vector<DmxSlot> slots_of(std::span<const NamedSlot> slots, std::optional<std::size_t> emitter);

}  // namespace luxrig
