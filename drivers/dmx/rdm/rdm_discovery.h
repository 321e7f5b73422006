#pragma once
/// Finds the devices on a DMX line by RDM's binary search, through a small line interface. Pure.
/// Source: ANSI E1.20-2010, chapter 7.
///
/// All devices are un-muted. The search asks a range of UIDs. A single answer is muted and the range asked again; a
/// collision halves the range; silence ends it. Devices in the field answer although muted, do not confirm, answer for
/// ranges that are not theirs, or send noise. None of these may hide others or keep the search from ending. But where
/// the bits of several answers add up, a device that never stops answering hides those that add no bit to its answer.

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "core/result.h"
#include "drivers/dmx/rdm/rdm_packet.h"

namespace luxrig::rdm {

/// The encoded answer to DISC_UNIQUE_BRANCH as transmitted: seven times 0xFE, 0xAA, then UID and checksum with each
/// byte as b | 0xAA, b | 0x55.
[[nodiscard]] std::vector<std::uint8_t> encode_branch_answer(const Uid& uid);
/// 0…7 times 0xFE may be left of the preamble, and bytes may follow. Empty for garbage: a collision.
[[nodiscard]] std::optional<Uid> decode_branch_answer(std::span<const std::uint8_t> bytes);

// The requests of discovery. The range includes both `lowest` and `highest`.
[[nodiscard]] Packet unique_branch_request(const Uid& from, std::uint8_t transaction, const Uid& lowest,
                                           const Uid& highest);
[[nodiscard]] Packet mute_request(const Uid& from, std::uint8_t transaction, const Uid& who);
[[nodiscard]] Packet un_mute_request(const Uid& from, std::uint8_t transaction);

/// A line with responders, as discovery needs it. A fault ends the search: the line itself is lost.
class DiscoveryLine {
 public:
  virtual ~DiscoveryLine() = default;
  /// Broadcast DISC_UN_MUTE; no device answers.
  virtual Result<void> un_mute_everybody() = 0;
  /// DISC_UNIQUE_BRANCH: all bytes received, valid or not; empty = silence.
  virtual Result<std::vector<std::uint8_t>> ask_branch(const Uid& lowest, const Uid& highest) = 0;
  /// DISC_MUTE to one device; true if it confirmed.
  virtual Result<bool> mute(const Uid& who) = 0;
};

struct DiscoveryLimits {
  int retries = 3;       ///< of a mute that is not confirmed
  int rounds = 3;        ///< the search repeats until it finds no new device, at most this often
  int requests = 50000;  ///< some minutes on a real line
};

struct DiscoveryResult {
  std::vector<Uid> found;      ///< ascending
  std::vector<Uid> unmutable;  ///< of these, and others that never confirmed: they answer although muted
  int requests = 0;
  bool complete = true;  ///< false: DiscoveryLimits::requests was reached
};

[[nodiscard]] Result<DiscoveryResult> discover(DiscoveryLine& line, const DiscoveryLimits& limits = {});

}  // namespace luxrig::rdm
