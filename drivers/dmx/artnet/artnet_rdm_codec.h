#pragma once
/// Art-Net packets that carry RDM: ArtTodRequest, ArtTodControl, ArtTodData, ArtRdm. Pure.
/// Source: Art-Net 4 Protocol Release V1.4, Artistic Licence. An RDM packet travels without its start code.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "drivers/dmx/rdm/rdm_packet.h"

namespace luxrig::artnet {

inline constexpr std::size_t kMaxTodUids = 200;  ///< in one ArtTodData

/// Asks the nodes that output these universes for their table of devices (TOD). requires 1…32 port addresses, all of
/// one net.
[[nodiscard]] std::vector<std::uint8_t> encode_tod_request(std::span<const int> port_addresses);
/// The port addresses it asks about; empty if it is no such packet.
[[nodiscard]] std::optional<std::vector<int>> decode_tod_request(std::span<const std::uint8_t> bytes);

enum class TodCommand : std::uint8_t { none = 0, flush = 1, end = 2, incremental_on = 3, incremental_off = 4 };
struct TodControl {
  int port_address = 0;
  TodCommand command = TodCommand::flush;  ///< flush: forget the table and search for devices again
};
[[nodiscard]] std::vector<std::uint8_t> encode(const TodControl& packet);
[[nodiscard]] std::optional<TodControl> decode_tod_control(std::span<const std::uint8_t> bytes);

/// One block of the table of a port.
struct TodData {
  int port_address = 0;
  int port = 1;  ///< physical, 1…4
  int bind_index = 1;
  bool full = true;  ///< false: the node has no table now
  int total = 0;     ///< UIDs of all blocks
  int block = 0;     ///< from 0
  std::vector<rdm::Uid> uids;
};
/// requires at most kMaxTodUids.
[[nodiscard]] std::vector<std::uint8_t> encode(const TodData& packet);
[[nodiscard]] std::optional<TodData> decode_tod_data(std::span<const std::uint8_t> bytes);

struct ArtRdm {
  int port_address = 0;
  std::vector<std::uint8_t> rdm;  ///< from start code to checksum, although the start code is not transmitted
};
/// requires an RDM packet of at most rdm::kMaxBytes.
[[nodiscard]] std::vector<std::uint8_t> encode(const ArtRdm& packet);
/// Does not check the RDM in it; rdm::decode does.
[[nodiscard]] std::optional<ArtRdm> decode_art_rdm(std::span<const std::uint8_t> bytes);

}  // namespace luxrig::artnet
