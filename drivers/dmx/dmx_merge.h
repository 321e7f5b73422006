#pragma once
/// Several senders of one universe -> the slots that count. sACN and Art-Net merge alike, but for priorities, which
/// Art-Net has not.

#include <array>
#include <bitset>
#include <cstdint>
#include <span>
#include <string>

#include "core/output/devices.h"
#include "drivers/dmx/dmx_patch.h"

namespace luxrig {

/// Among senders of equal priority, slot by slot: the highest value takes precedence, or the one that changed last.
enum class MergeRule { htp, ltp };

/// What one sender has said. A packet with fewer slots leaves the others as they were.
struct SentSlots {
  DmxSlots value{};
  std::array<std::uint64_t, kDmxSlots> changed{};  ///< `tick` of the last change; 0 = never said
  std::size_t count = 0;                           ///< slots said so far

  /// tick: grows from packet to packet, over all senders.
  void take(std::span<const std::uint8_t> slots, std::uint64_t tick);
};

/// One sender in a merge.
struct MergeInput {
  const SentSlots* slots = nullptr;
  int priority = 0;                         ///< of all its slots
  const DmxSlots* slot_priority = nullptr;  ///< if not null: per slot instead, 0 = no value there
};

struct Merged {
  DmxSlots slots{};
  std::bitset<kDmxSlots> given;  ///< somebody has a value there
};
[[nodiscard]] Merged merge(std::span<const MergeInput> senders, MergeRule rule);

/// One universe as a receiver knows it.
struct HeardUniverse {
  DeskPresence presence = DeskPresence::unknown;
  Merged levels;       ///< the newest, or the last before everybody went
  std::string source;  ///< name of who has the highest priority, with the number of others; empty: nobody yet
};

}  // namespace luxrig
