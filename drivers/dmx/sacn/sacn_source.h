#pragma once
/// Schedule of an sACN source's packets: sequence numbers, rate, suppression, priority per slot, synchronisation,
/// universe discovery, goodbye. `now` and slots in, packets out.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/dmx/sacn/sacn_codec.h"
#include "drivers/dmx/send_rate.h"

namespace luxrig::sacn {

struct SourceSettings {
  Cid cid{};
  std::string source_name;
  int priority = 100;      ///< 0…200
  bool continuous = true;  ///< false: suppress packets while nothing changes (clause 6.6.2)
  bool preview = false;    ///< for visualisers only (clause 6.2.6)
  /// Data waits for a packet to this universe (clause 11); 0 = acts at once. Receivers go on without it if it is lost.
  int sync_universe = 0;
};

/// A component identifier that is the same after a restart and differs between hosts, rigs and buses: a UUID of version
/// 8 (RFC 9562) hashed from the three.
[[nodiscard]] Cid derive_cid(std::string_view host, std::string_view rig, std::string_view bus);

/// "6ba7b810-9dad-11d1-80b4-00c04fd430c8" -> its bytes.
[[nodiscard]] std::optional<Cid> parse_cid(std::string_view text);

class Source {
 public:
  explicit Source(SourceSettings settings) : settings_(std::move(settings)) {}

  /// From now on packets of start code 0xDD carry these priorities per slot (0 = this source does not count there).
  void set_slot_priorities(int universe, const DmxSlots& priorities) { streams_[universe].priorities = priorities; }

  /// The packet of this universe that is due at `now`, if any: levels or, in their place, slot priorities.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> due(Time now, int universe, const DmxSlots& slots);

  /// Whether these levels have been sent.
  [[nodiscard]] bool is_sent(int universe, const DmxSlots& slots) const;

  /// The goodbye of a universe that has sent before: one packet with the stream-terminated bit; clause 6.2.6 wants
  /// three. Empty for a universe that never sent or has said goodbye.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> goodbye(int universe);
  /// After all universes of a frame: the packet that makes them act together. Empty if none was sent since the last
  /// one, or without a sync_universe.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> sync_due();

  /// Every 10 s the pages that list the universes being sent; otherwise, and if none is sent, empty.
  [[nodiscard]] std::vector<std::vector<std::uint8_t>> discovery_due(Time now);

  /// The same for one universe that falls silent alone.
  void rest(int universe);
  /// After the goodbyes: each universe restarts with its next packet; sequence numbers continue.
  void rest();

 private:
  struct Stream {
    DmxSlots slots{};
    std::uint8_t sequence = 0;  ///< of the next packet
    std::uint64_t packets = 0;
    std::optional<DmxSlots> priorities;
    std::optional<Time> priorities_sent;
    bool sending = false;
    int repeats_left = 0;  ///< identical packets still owed after the last change
    Time last{};
    SendRate rate;
  };
  [[nodiscard]] std::vector<std::uint8_t> next_packet(int universe, Stream& stream, std::uint8_t start_code,
                                                      bool terminated);

  SourceSettings settings_;
  std::map<int, Stream> streams_;
  bool owes_sync_ = false;
  std::uint8_t sync_sequence_ = 0;
  std::uint64_t syncs_ = 0;
  std::optional<Time> listed_;  ///< when discovery was last due
};

}  // namespace luxrig::sacn
