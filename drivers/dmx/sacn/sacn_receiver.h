#pragma once
/// The receiving side of sACN: sequence rule, priorities, merge, synchronisation, loss of sources. `now` and datagrams
/// in, levels out. Source: ANSI E1.31-2018; clauses in the .cpp.
///
/// - For 1.5 s after the first call a universe is `unknown`, as the highest priority is not known yet. It becomes
///   `absent` after 2.5 s, the longest silence of a live source. A source heard by then still gets its 1.5 s first, so
///   it takes 4 s at most.
/// - A new source does not count until it has sent its slot priorities (start code 0xDD), or for 1.5 s.
/// - A source is lost after 2.5 s without levels. While others may have been lost with it (a cable pulled), no source
///   of lower priority gets control: the loss counts once each of them was heard after it or is lost too.
/// - Without sources the last levels stay, and the universe is `absent`.

#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "drivers/dmx/dmx_merge.h"
#include "drivers/dmx/sacn/sacn_codec.h"

namespace luxrig::sacn {

inline constexpr Duration kSourceLoss = std::chrono::milliseconds(2500);      ///< E131_NETWORK_DATA_LOSS_TIMEOUT
inline constexpr Duration kSamplingPeriod = std::chrono::milliseconds(1500);  ///< of a new receiver or source

struct ReceiverSettings {
  std::vector<int> universes;
  std::optional<Cid> own;  ///< packets of this source are ignored: Luxrig's own
  MergeRule rule = MergeRule::htp;
  int lowest_priority = 0;  ///< sources with a lower priority are ignored
};

class Receiver {
 public:
  explicit Receiver(ReceiverSettings settings);

  enum class Verdict { taken, not_sacn, preview, out_of_order, terminated, ignored };
  Verdict receive(Time now, std::span<const std::uint8_t> bytes);

  /// State of a universe of the settings at `now`; time must not go back.
  [[nodiscard]] HeardUniverse heard(Time now, int universe);
  /// Number of tracked sources without lost ones.
  [[nodiscard]] std::size_t sources(Time now, int universe);

  /// Universes whose groups to join: its own, and those used for synchronisation.
  [[nodiscard]] const std::set<int>& groups() const { return groups_; }
  /// Forgets everything received.
  void restart();

 private:
  struct Source {
    std::string name;
    Time first{}, last{};
    std::optional<Time> lost;  ///< when its loss was due; other sources may delay its effect
    std::optional<std::uint8_t> levels_sequence, priorities_sequence;
    int priority = 0;
    bool shown = false;  ///< `slots` holds levels to act on
    SentSlots slots;
    std::optional<SentSlots> held;  ///< waits for its synchronisation packet
    int sync_universe = 0;
    bool force_sync = false;
    DmxSlots slot_priority{};
    std::optional<Time> slot_priority_at;
  };
  struct Universe {
    std::optional<Time> started;
    std::map<Cid, Source> sources;
    HeardUniverse last;
  };
  struct Sync {
    Time last{};
    std::map<Cid, std::uint8_t> sequence;
  };

  Verdict take_sync(Time now, const SyncPacket& packet);
  Verdict take_data(Time now, const DataPacket& packet);
  void take_levels(Time now, Source& source, const DataPacket& packet);
  [[nodiscard]] bool synchronised(Time now, const Source& source) const;
  void forget_lost(Time now, Universe& universe);

  ReceiverSettings settings_;
  std::map<int, Universe> universes_;
  std::map<int, Sync> syncs_;
  std::set<int> groups_;
  std::uint64_t tick_ = 0;
};

}  // namespace luxrig::sacn
