#pragma once
/// An Art-Net 4 node with DMX outputs. Pure: packets and the time in, levels and answers out.
/// Source: Art-Net 4 specification (Artistic Licence).
///
/// Implemented: ArtPoll -> one ArtPollReply per page of four ports of the same net and sub-net, ArtDmx with its
/// sequence rule, merge of at most two sources by address (HTP, 10 s), ArtSync (from the only controller of a port's
/// data) with its 4 s timeout. Without sources the last look is held, and the replies say so (failsafe: hold).
/// Answers at once instead of after a random 0…1 s, so that tests and tools need not wait.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/time.h"
#include "sim/devices/dmx_fixture.h"

namespace luxrig::sim {

struct ArtDmx {
  std::uint8_t sequence = 0;  ///< 0 = no ordering
  std::uint8_t physical = 0;
  int port_address = 0;  ///< 0…32767
  std::span<const std::uint8_t> slots;
};

/// Empty unless the bytes are a valid packet of that kind.
[[nodiscard]] std::optional<ArtDmx> decode_art_dmx(std::span<const std::uint8_t> packet);
[[nodiscard]] bool is_art_poll(std::span<const std::uint8_t> packet);
[[nodiscard]] bool is_art_sync(std::span<const std::uint8_t> packet);

class ArtnetNode {
 public:
  /// `port_addresses`: universes it outputs (0…32767).
  explicit ArtnetNode(std::vector<int> port_addresses);

  /// `from`: the sender's IPv4 address. `own`: the node's, which its replies name. Returns the packets to send back.
  std::vector<std::vector<std::uint8_t>> receive(Time now, std::uint32_t from, std::span<const std::uint8_t> packet,
                                                 std::uint32_t own = 0x7f000001);

  /// Levels of a universe, address 1 first; empty before its first data or if it lacks that universe.
  [[nodiscard]] std::optional<std::array<std::uint8_t, kDmxSlots>> levels(int port_address, Time now);

  [[nodiscard]] std::uint64_t accepted() const { return accepted_; }

 private:
  using Levels = std::array<std::uint8_t, kDmxSlots>;
  struct Source {
    std::uint32_t address = 0;
    Time last_seen{};
    std::uint8_t sequence = 0;
    Levels slots{};
  };
  struct Port {
    std::vector<Source> sources;       ///< at most two
    std::optional<Levels> look, held;  ///< `held` waits for ArtSync
    std::optional<Time> last_sync;     ///< from its source
  };

  void forget_lost(Time now);
  static Levels merged(const Port& port);
  void take(Time now, std::uint32_t from, const ArtDmx& dmx);
  [[nodiscard]] std::vector<std::vector<std::uint8_t>> poll_replies(std::uint32_t own) const;

  std::map<int, Port> ports_;
  std::uint64_t accepted_ = 0;
};

}  // namespace luxrig::sim
