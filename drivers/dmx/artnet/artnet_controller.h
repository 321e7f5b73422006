#pragma once
/// Schedule of an Art-Net controller's packets, and the nodes it knows. `now`, slots and replies in, packets out.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "drivers/dmx/artnet/artnet_codec.h"
#include "drivers/dmx/send_rate.h"
#include "drivers/io/datagram.h"

namespace luxrig::artnet {

/// A controller polls every 2.5…3 s. A node may take 1 s to answer. After three unanswered polls it is gone.
inline constexpr Duration kPollPeriod = std::chrono::milliseconds(2500);
inline constexpr Duration kNodeGone = 3 * kPollPeriod + std::chrono::milliseconds(1000);
/// Unchanged data is repeated this often. The specification says 4 s; nodes in the field black out earlier.
inline constexpr Duration kKeepAlive = std::chrono::milliseconds(1000);

struct Node {
  std::string name;
  std::map<int, std::vector<PortOutput>> outputs;  ///< by bind index
  Time last_seen{};
  Time since{};  ///< last change of `gone`
  bool gone = false;
  std::uint64_t replies = 0;

  [[nodiscard]] bool puts_out(int port_address) const;
  [[nodiscard]] bool merges(int port_address) const;
};

struct ControllerSettings {
  bool continuous = false;  ///< send every cycle; false: on change and every kKeepAlive
  bool sequence = true;     ///< false: sequence number 0, "no order"
  bool sync = false;        ///< ArtSync after each frame
};

class Controller {
 public:
  explicit Controller(ControllerSettings settings) : settings_(settings) {}

  /// True if an ArtPoll is due; it then counts as sent. Also detects lost nodes.
  [[nodiscard]] bool poll_due(Time now);

  /// Takes a received datagram; false if it is no ArtPollReply. A new or returned node gets data at once.
  bool hear(Time now, const Datagram& datagram);

  /// The ArtDmx of this universe that is due at `now`, if any.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> due(Time now, int port_address, const DmxSlots& slots);

  /// Whether these levels have been sent.
  [[nodiscard]] bool is_sent(int port_address, const DmxSlots& slots) const;

  /// After all universes of a frame: the ArtSync that makes nodes act. Empty if no ArtDmx was due since the last one,
  /// or if sync is off.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> sync_due();

  [[nodiscard]] const std::map<SocketAddress, Node>& nodes() const { return nodes_; }
  /// Addresses of the nodes that output this universe.
  [[nodiscard]] std::vector<SocketAddress> subscribers(int port_address) const;

  /// Forgets all nodes. Every universe is sent again in full; sequence numbers continue.
  void rest();

 private:
  struct Stream {
    DmxSlots slots{};
    std::uint8_t sequence = 1;  ///< of the next packet
    std::uint64_t packets = 0;
    bool wanted = true;  ///< regardless of the keep-alive
    bool sent = false;   ///< these slots, to all known nodes
    Time last{};
    SendRate rate;
  };
  void send_afresh();

  ControllerSettings settings_;
  bool owes_sync_ = false;
  std::map<int, Stream> streams_;
  std::map<SocketAddress, Node> nodes_;
  std::optional<Time> last_poll_;
};

}  // namespace luxrig::artnet
