#pragma once
/// Who is on a DMX line: the binary search of RDM, over a line that is asked by a small interface. Pure.
/// Source: ANSI E1.20-2010, chapter 7.
///
/// Everybody is un-muted. A range of UIDs is asked; one answer is muted and the range asked again; a collision halves
/// the range; silence ends it. Devices in the field answer though muted, do not confirm, answer for ranges that are
/// not theirs, or send noise: none of these may hide others or keep the search from ending. But where bits of several
/// answers add up, one that talks for ever hides those that add no bit to what it says.

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "core/result.h"
#include "drivers/dmx/rdm/rdm_packet.h"

namespace luxrig::rdm {

/// The encoded answer to DISC_UNIQUE_BRANCH, as it travels: seven times 0xFE, 0xAA, UID and checksum with each byte as
/// b | 0xAA, b | 0x55.
[[nodiscard]] std::vector<std::uint8_t> encode_branch_answer(const Uid& uid);
/// 0…7 times 0xFE may be left of the preamble, and bytes may follow. Nothing when it is garbage: a collision.
[[nodiscard]] std::optional<Uid> decode_branch_answer(std::span<const std::uint8_t> bytes);

// The requests of discovery. `lowest`, `highest`: both ends belong to the range.
[[nodiscard]] Packet unique_branch_request(const Uid& from, std::uint8_t transaction, const Uid& lowest,
                                           const Uid& highest);
[[nodiscard]] Packet mute_request(const Uid& from, std::uint8_t transaction, const Uid& who);
[[nodiscard]] Packet un_mute_request(const Uid& from, std::uint8_t transaction);

/// A line with responders, as discovery asks it. A fault ends the search: the line itself is gone.
class DiscoveryLine {
 public:
  virtual ~DiscoveryLine() = default;
  /// Broadcast DISC_UN_MUTE; nobody answers.
  virtual Result<void> un_mute_everybody() = 0;
  /// DISC_UNIQUE_BRANCH: whatever bytes came, with or without sense; none: silence.
  virtual Result<std::vector<std::uint8_t>> ask_branch(const Uid& lowest, const Uid& highest) = 0;
  /// DISC_MUTE to one device: whether it confirmed.
  virtual Result<bool> mute(const Uid& who) = 0;
};

struct DiscoveryLimits {
  int retries = 3;       ///< of a mute that is not confirmed
  int rounds = 3;        ///< the search is repeated until nobody new is found, at most so often
  int requests = 50000;  ///< some minutes on a real line
};

struct DiscoveryResult {
  std::vector<Uid> found;      ///< ascending
  std::vector<Uid> unmutable;  ///< of these, and others that never confirmed: they answer though they were muted
  int requests = 0;
  bool complete = true;  ///< false: DiscoveryLimits::requests was reached
};

[[nodiscard]] Result<DiscoveryResult> discover(DiscoveryLine& line, const DiscoveryLimits& limits = {});

}  // namespace luxrig::rdm
