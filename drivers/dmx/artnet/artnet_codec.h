#pragma once
/// Art-Net 4 packets that a controller and a node send and receive: ArtDmx, ArtPoll, ArtPollReply, ArtSync, ArtAddress.
/// Pure.
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
  std::uint8_t sequence = 0;  ///< 1…255; 0 = not used
  std::uint8_t physical = 0;
  int port_address = 0;
  std::vector<std::uint8_t> slots;  ///< an even number, 2…512
};
[[nodiscard]] std::vector<std::uint8_t> encode(const Dmx& packet);
/// Bytes after the slots are ignored.
[[nodiscard]] std::optional<Dmx> decode_dmx(std::span<const std::uint8_t> bytes);

/// Asks every node that receives it for an ArtPollReply, now and on each change of its state.
[[nodiscard]] std::vector<std::uint8_t> encode_poll();
/// Both the short polls of older controllers (14 bytes) and those with a range of ports.
struct Poll {
  bool reply_on_change = false;
  /// Only nodes with a port in this range should answer; an untargeted poll covers the whole range.
  int lowest_port_address = 0, highest_port_address = kHighestPortAddress;
};
[[nodiscard]] std::optional<Poll> decode_poll(std::span<const std::uint8_t> bytes);

/// After the ArtDmx packets of a frame: show their data now.
[[nodiscard]] std::vector<std::uint8_t> encode_sync();
[[nodiscard]] bool is_sync(std::span<const std::uint8_t> bytes);

/// A port that outputs network data as DMX.
struct PortOutput {
  int port_address = 0;
  bool sending = false;  ///< GoodOutputA bit 7
  bool merging = false;  ///< bit 3: from more than one sender
  bool ltp = false;      ///< bit 1: merge by latest takes precedence
};

/// A node's status, as far as a sender of DMX needs it. A node with more than four ports sends several replies with
/// different bind_index.
struct PollReply {
  std::string short_name, long_name, report;
  int bind_index = 0;
  std::array<std::uint8_t, 6> mac{};
  std::vector<PortOutput> outputs;
};
/// Also accepts the short replies of older nodes (207 bytes and more; missing fields count as zero).
[[nodiscard]] std::optional<PollReply> decode_poll_reply(std::span<const std::uint8_t> bytes);

/// requires 1…4 outputs of the same net and sub-net, bind_index 1…255. `ipv4`: the node's own, 0 = unknown.
[[nodiscard]] std::vector<std::uint8_t> encode(const PollReply& reply, std::uint32_t ipv4);

/// Remote programming of a node; only the commands about merging.
enum class AddressCommand : std::uint8_t { none = 0, cancel_merge = 0x01, merge_ltp = 0x10, merge_htp = 0x50 };
struct Address {
  int bind_index = 1;
  AddressCommand command = AddressCommand::none;
  int port = 0;  ///< 0…3, for a command about one port
};
/// Changes only what the command states: names are empty, switches 0x7f.
[[nodiscard]] std::vector<std::uint8_t> encode(const Address& packet);
/// Empty unless it is an ArtAddress; an unknown command is `none`.
[[nodiscard]] std::optional<Address> decode_address(std::span<const std::uint8_t> bytes);

}  // namespace luxrig::artnet
