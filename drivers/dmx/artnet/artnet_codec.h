#pragma once
/// Art-Net 4 packets that a controller and a node send and hear: ArtDmx, ArtPoll, ArtPollReply, ArtSync, ArtAddress.
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
  std::uint8_t sequence = 0;  ///< 1…255; 0 = not in use
  std::uint8_t physical = 0;
  int port_address = 0;
  std::vector<std::uint8_t> slots;  ///< an even number, 2…512
};
[[nodiscard]] std::vector<std::uint8_t> encode(const Dmx& packet);
[[nodiscard]] std::optional<Dmx> decode_dmx(std::span<const std::uint8_t> bytes);

/// Asks every node that hears it for an ArtPollReply, now and whenever its state changes.
[[nodiscard]] std::vector<std::uint8_t> encode_poll();
/// The short polls of older controllers (14 bytes) as well as those that name the ports they ask about.
struct Poll {
  bool reply_on_change = false;
  /// Only nodes with a port in this range shall answer; the whole range when the poll is not targeted.
  int lowest_port_address = 0, highest_port_address = kHighestPortAddress;
};
[[nodiscard]] std::optional<Poll> decode_poll(std::span<const std::uint8_t> bytes);

/// After the ArtDmx of a frame: what they brought shall show now.
[[nodiscard]] std::vector<std::uint8_t> encode_sync();
[[nodiscard]] bool is_sync(std::span<const std::uint8_t> bytes);

/// A port that puts data from the network out as DMX.
struct PortOutput {
  int port_address = 0;
  bool sending = false;  ///< GoodOutputA bit 7
  bool merging = false;  ///< bit 3: from more than one sender
  bool ltp = false;      ///< bit 1: merge by latest takes precedence
};

/// What a node says about itself, as far as a sender of DMX cares. A node with more than four ports sends several,
/// told apart by bind_index.
struct PollReply {
  std::string short_name, long_name, report;
  int bind_index = 0;
  std::array<std::uint8_t, 6> mac{};
  std::vector<PortOutput> outputs;
};
/// Takes the short replies of older nodes as well (207 bytes and more; what is missing counts as zero).
[[nodiscard]] std::optional<PollReply> decode_poll_reply(std::span<const std::uint8_t> bytes);

/// requires 1…4 outputs of the same net and sub-net, bind_index 1…255. `ipv4`: the node's own, 0 when not known.
[[nodiscard]] std::vector<std::uint8_t> encode(const PollReply& reply, std::uint32_t ipv4);

/// Remote programming of a node; of its many commands those that concern merging.
enum class AddressCommand : std::uint8_t { none = 0, cancel_merge = 0x01, merge_ltp = 0x10, merge_htp = 0x50 };
struct Address {
  int bind_index = 1;
  AddressCommand command = AddressCommand::none;
  int port = 0;  ///< 0…3, of a command about one port
};
/// Changes nothing but what the command says: names are empty, switches 0x7f.
[[nodiscard]] std::vector<std::uint8_t> encode(const Address& packet);
/// Nothing unless it is an ArtAddress; a command that is not known here is `none`.
[[nodiscard]] std::optional<Address> decode_address(std::span<const std::uint8_t> bytes);

}  // namespace luxrig::artnet
