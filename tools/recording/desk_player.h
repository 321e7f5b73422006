#pragma once
/// Sends the DMX of a recording again, as the desks did: at the recorded times, with packet numbers that go on when it
/// repeats, and a goodbye where the protocol has one. `now` in, datagrams out; no socket.

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

#include "tools/recording/of_rig.h"

namespace luxrig::recording {

/// Where packets go.
struct Receiver {
  Protocol protocol = Protocol::sacn;
  std::optional<std::uint32_t> ipv4;  ///< none: sACN to the multicast group of each universe
  std::uint16_t port = sacn::kPort;
  std::optional<std::set<int>> universes;  ///< none: all
};

struct PlayerSettings {
  std::vector<bool> sources;  ///< of the recording: which to send
  std::vector<Receiver> receivers;
  double speed = 1;  ///< > 0
  bool repeats = false;
};

class DeskPlayer {
 public:
  /// The recording must outlive it. Sources of sACN get CIDs of their own: the recorded desk may be there as well.
  DeskPlayer(const Recording& recording, PlayerSettings settings);

  struct Outgoing {
    SocketAddress to;
    std::vector<std::uint8_t> bytes;
  };
  /// Everything due by `at` after the beginning, which must not go back.
  [[nodiscard]] std::vector<Outgoing> due(Duration at);
  /// When the next one is due; nullopt: all is sent.
  [[nodiscard]] std::optional<Duration> next() const;
  /// At the end: sACN's three packets that say so, for each universe of each source.
  [[nodiscard]] std::vector<Outgoing> goodbyes() const;

  /// Packets that it sends in one pass.
  [[nodiscard]] std::size_t packets() const { return chosen_.size(); }
  [[nodiscard]] bool repeats() const { return settings_.repeats; }

 private:
  struct Chosen {
    std::size_t packet = 0, receiver = 0;
  };
  struct Stream {
    int offset = 0;                    ///< to add to recorded numbers, in this pass
    std::optional<int> first, newest;  ///< recorded numbers of this pass
    SocketAddress to;
    std::vector<std::uint8_t> last;  ///< as sent
  };
  /// A source's packets to one receiver: of one universe, or that synchronise.
  using StreamKey = std::tuple<std::size_t, std::size_t, std::optional<int>>;
  [[nodiscard]] Duration scaled(Duration recorded) const;
  [[nodiscard]] Outgoing outgoing(const Chosen& one);
  void begin_pass();

  const Recording& recording_;
  PlayerSettings settings_;
  std::vector<Chosen> chosen_;
  std::map<StreamKey, Stream> streams_;
  std::size_t next_ = 0;
  Duration pass_begins_{};
};

}  // namespace luxrig::recording
