#pragma once
/// ANSI E1.31-2018 (sACN) packets (data, synchronisation, universe discovery): values -> bytes and back. Pure.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace luxrig::sacn {

inline constexpr std::uint16_t kPort = 5568;                         ///< appendix A, ACN_SDT_MULTICAST_PORT
inline constexpr int kLowestUniverse = 1, kHighestUniverse = 63999;  ///< clause 6.2.7
inline constexpr int kHighestPriority = 200;                         ///< clause 6.2.3
inline constexpr std::size_t kSourceNameBytes = 64;                  ///< clause 6.2.2, including its NUL

inline constexpr std::uint16_t kDiscoveryUniverse = 64214;  ///< appendix A, E131_DISCOVERY_UNIVERSE
inline constexpr std::size_t kUniversesPerPage = 512;       ///< clause 8.5
inline constexpr std::uint8_t kLevels = 0x00;               ///< start code of levels
/// Start code of per-address priority: gives receivers the priority of each slot; 0 = no value here.
inline constexpr std::uint8_t kSlotPriority = 0xDD;

using Cid = std::array<std::uint8_t, 16>;  ///< component identifier: a UUID, clause 5.6

struct DataPacket {
  Cid cid{};
  std::string source_name;  ///< UTF-8; encode() truncates it to 63 bytes at a character
  std::uint8_t priority = 100;
  std::uint16_t sync_universe = 0;
  std::uint8_t sequence = 0;
  bool preview = false;
  bool terminated = false;  ///< the source stops sending this universe
  bool force_sync = false;
  std::uint16_t universe = 1;
  std::uint8_t start_code = 0;
  std::vector<std::uint8_t> slots;  ///< 0…512
};

/// requires slots.size() <= 512. The result has 126 + slots bytes.
[[nodiscard]] std::vector<std::uint8_t> encode(const DataPacket& packet);

/// Empty unless the packet is a well-formed data packet: every fixed field as in the standard, all lengths consistent
/// with the datagram, universe and priority in range.
[[nodiscard]] std::optional<DataPacket> decode(std::span<const std::uint8_t> bytes);

/// Clause 6.3: data that waits for `sync_universe` takes effect now.
struct SyncPacket {
  Cid cid{};
  std::uint8_t sequence = 0;
  std::uint16_t sync_universe = 1;  ///< 1…63999
};
[[nodiscard]] std::vector<std::uint8_t> encode(const SyncPacket& packet);
[[nodiscard]] std::optional<SyncPacket> decode_sync(std::span<const std::uint8_t> bytes);

/// Clause 8: universes that a source sends, 512 to a page.
struct DiscoveryPacket {
  Cid cid{};
  std::string source_name;  ///< as in DataPacket
  std::uint8_t page = 0, last_page = 0;
  std::vector<std::uint16_t> universes;  ///< ascending, each once, at most 512
};
/// requires universes.size() <= 512.
[[nodiscard]] std::vector<std::uint8_t> encode(const DiscoveryPacket& packet);
[[nodiscard]] std::optional<DiscoveryPacket> decode_discovery(std::span<const std::uint8_t> bytes);

/// The group of a universe, clause 9.3.1: 239.255.<high>.<low>, host byte order.
[[nodiscard]] constexpr std::uint32_t multicast_group(std::uint16_t universe) { return 0xEFFF0000U | universe; }

}  // namespace luxrig::sacn
