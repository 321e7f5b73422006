#pragma once
/// Merges several senders of one universe. sACN and Art-Net merge alike, except that Art-Net has no priorities.

#include <array>
#include <bitset>
#include <cstdint>
#include <span>
#include <string>

#include "core/output/devices.h"
#include "drivers/dmx/dmx_patch.h"

namespace luxrig {

/// Among senders of equal priority, slot by slot: the highest value takes precedence, or the latest change.
enum class MergeRule { htp, ltp };

/// The slots of one sender. A packet with fewer slots leaves the others unchanged.
struct SentSlots {
  DmxSlots value{};
  std::array<std::uint64_t, kDmxSlots> changed{};  ///< `tick` of the last change; 0 = never sent
  std::size_t count = 0;                           ///< slots sent so far

  /// tick: grows with each packet, over all senders.
  void take(std::span<const std::uint8_t> slots, std::uint64_t tick);
};

/// One sender in a merge.
struct MergeInput {
  const SentSlots* slots = nullptr;
  int priority = 0;                         ///< of all its slots
  const DmxSlots* slot_priority = nullptr;  ///< if not null: priority per slot instead, 0 = no value there
};

struct Merged {
  DmxSlots slots{};
  std::bitset<kDmxSlots> given;  ///< slots for which a sender has a value
};
[[nodiscard]] Merged merge(std::span<const MergeInput> senders, MergeRule rule);

/// One universe as a receiver knows it.
struct HeardUniverse {
  DeskPresence presence = DeskPresence::unknown;
  Merged levels;       ///< the newest, or the last before all senders went
  std::string source;  ///< name of the source with the highest priority, with the number of others; empty = none yet
};

}  // namespace luxrig
