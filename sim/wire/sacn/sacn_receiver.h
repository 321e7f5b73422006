#pragma once
/// The receiving end of streaming ACN, like a DMX gateway. Pure: bytes and the time in, levels out.
/// Source: ANSI E1.31-2018; clause numbers in the .cpp.
///
/// Implemented: sequence rule, preview, stream terminated, priority, merge of equal priorities (highest takes
/// precedence, slot by slot), synchronisation with force-sync, network data loss after 2.5 s. Without sources it holds
/// the last look for ever: the declared choice of this gateway.
/// Not implemented: per-address priority (start code 0xDD; ignored) and the 1.5 s sampling period of a new receiver.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "core/time.h"
#include "sim/devices/dmx_fixture.h"

namespace luxrig::sim {

struct SacnData {
  std::array<std::uint8_t, 16> cid{};
  std::string source_name;
  int priority = 0;       ///< 0…200
  int sync_universe = 0;  ///< 0 = not synchronised
  std::uint8_t sequence = 0;
  bool preview = false, terminated = false, force_sync = false;
  int universe = 0;  ///< 1…63999
  std::uint8_t start_code = 0;
  std::span<const std::uint8_t> slots;  ///< view into the packet
};

struct SacnSync {
  std::array<std::uint8_t, 16> cid{};
  std::uint8_t sequence = 0;
  int sync_universe = 0;
};

/// Empty unless the bytes are a valid packet of that kind.
[[nodiscard]] std::optional<SacnData> decode_sacn_data(std::span<const std::uint8_t> packet);
[[nodiscard]] std::optional<SacnSync> decode_sacn_sync(std::span<const std::uint8_t> packet);

class SacnReceiver {
 public:
  static constexpr Duration kLossTimeout = std::chrono::milliseconds(2500);

  enum class Verdict { accepted, not_sacn, preview, out_of_order, terminated, ignored };
  Verdict receive(Time now, std::span<const std::uint8_t> packet);

  /// Present levels of a universe, address 1 first; empty before its first data. Forgets lost sources.
  [[nodiscard]] std::optional<std::array<std::uint8_t, kDmxSlots>> levels(int universe, Time now);
  /// Sources present now.
  [[nodiscard]] std::size_t sources(int universe, Time now);

 private:
  using Levels = std::array<std::uint8_t, kDmxSlots>;
  struct Source {
    Time last_seen{};
    std::uint8_t sequence = 0;
    int priority = 0;
    bool live = false;  ///< `slots` holds levels to show
    Levels slots{};
    int sync_universe = 0;
    bool force_sync = false, waiting = false;
    Levels held{};  ///< waits for the synchronisation packet
  };
  struct Universe {
    std::map<std::array<std::uint8_t, 16>, Source> sources;
    std::optional<Levels> look;
  };

  void forget_lost(Universe& universe, Time now);
  static void merge(Universe& universe);

  std::map<int, Universe> universes_;
  std::map<int, Time> last_sync_;  ///< by synchronisation universe
};

}  // namespace luxrig::sim
