#pragma once
/// Art-Net 4 packets that a controller sends and hears: ArtDmx, ArtPoll, ArtPollReply. Pure.
/// Source: Art-Net 4 Protocol Release V1.4, Artistic Licence.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace luxrig::artnet {

inline constexpr std::uint16_t kPort = 0x1936;  ///< 6454
inline constexpr int kHighestPortAddress = 32767;

/// "net:sub:uni", as nodes and consoles show a 15-bit port address.
[[nodiscard]] std::string text_of_port_address(int port_address);

struct Dmx {
  std::uint8_t sequence = 0;  ///< 1…255; 0 = not in use
  std::uint8_t physical = 0;
  int port_address = 0;
  std::vector<std::uint8_t> slots;  ///< an even number, 2…512
};
[[nodiscard]] std::vector<std::uint8_t> encode(const Dmx& packet);
[[nodiscard]] std::optional<Dmx> decode_dmx(std::span<const std::uint8_t> bytes);

/// Asks every node that hears it for an ArtPollReply, now and whenever its state changes.
[[nodiscard]] std::vector<std::uint8_t> encode_poll();

/// What a node says about itself, as far as a sender of DMX cares. A node with more than four ports sends several,
/// told apart by bind_index.
struct PollReply {
  std::string short_name, long_name, report;
  int bind_index = 0;
  std::vector<int> output_port_addresses;  ///< of its ports that put data from the network out as DMX
};
/// Takes the short replies of older nodes as well (207 bytes and more; what is missing counts as zero).
[[nodiscard]] std::optional<PollReply> decode_poll_reply(std::span<const std::uint8_t> bytes);

}  // namespace luxrig::artnet
