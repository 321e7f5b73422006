#pragma once
/// The receiving side of an Art-Net node: ArtDmx with its sequence rule, merge of two senders, ArtSync, ArtAddress
/// about merging, and answers to ArtPoll, so that desks find it and send to it. `now` and datagrams in, levels and
/// answers out. Source: Art-Net 4 Protocol Release V1.4.
///
/// - Senders are identified by IPv4 address. A third one is ignored; one that is silent for 10 s is forgotten.
/// - After an ArtSync from the only sender of a port's data, data waits for the next ArtSync, until none has come for 4
///   s.
/// - Without senders the last levels stay. A desk may repeat unchanged data only every 4 s, so for that long after the
///   first call its absence is unknown.

#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "drivers/dmx/artnet/artnet_codec.h"
#include "drivers/dmx/dmx_merge.h"
#include "drivers/io/datagram.h"

namespace luxrig::artnet {

inline constexpr Duration kSenderLoss = std::chrono::seconds(10);
inline constexpr Duration kSyncLoss = std::chrono::seconds(4);
inline constexpr Duration kSlowestRefresh = std::chrono::seconds(4);

struct ReceiverSettings {
  std::vector<int> port_addresses;
  MergeRule rule = MergeRule::htp;  ///< until an ArtAddress changes it
  std::string short_name, long_name;
  std::array<std::uint8_t, 6> mac{};
  Duration reply_delay{};  ///< after a poll: nodes spread their answers over a second
};

class Receiver {
 public:
  explicit Receiver(ReceiverSettings settings);

  enum class Verdict { taken, not_for_us, out_of_order, third_sender };
  Verdict receive(Time now, const SocketAddress& from, std::span<const std::uint8_t> bytes);

  [[nodiscard]] HeardUniverse heard(Time now, int port_address);

  struct Answer {
    SocketAddress to;
    PollReply reply;
  };
  /// The answers to polls that are due now, each once.
  [[nodiscard]] std::vector<Answer> answers_due(Time now);

  void restart();

 private:
  struct Sender {
    std::uint32_t ipv4 = 0;
    Time last{};
    std::uint8_t sequence = 0;
    SentSlots slots;
  };
  struct Port {
    MergeRule rule = MergeRule::htp;
    std::optional<Time> started;
    std::vector<Sender> senders;  ///< at most two
    bool cancel_merge = false;    ///< the sender of the next ArtDmx becomes the only one
    std::optional<Merged> held;   ///< waits for ArtSync
    std::optional<Time> last_sync;
    HeardUniverse last;
  };
  struct PortPage {
    std::vector<int> port_addresses;  ///< at most four, of one net and sub-net; their index is the bind index − 1
  };

  Verdict take(Time now, std::uint32_t from, const Dmx& packet);
  void synchronise(Time now, std::uint32_t from);
  void obey(const Address& packet);
  void forget_lost(Time now, Port& port);
  void show(Time now, Port& port, bool hold);

  ReceiverSettings settings_;
  std::map<int, Port> ports_;
  std::vector<PortPage> pages_;
  std::map<SocketAddress, Time> polled_;  ///< pollers waiting for an answer, and when it is due
  std::uint64_t tick_ = 0, taken_ = 0;
};

}  // namespace luxrig::artnet
