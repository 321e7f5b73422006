#pragma once
/// Identifiers of the predefined connection set (CiA 301, 7.3.5). A node adds its number, 1…127.

#include <cstdint>

namespace luxrig::canopen {

inline constexpr std::uint32_t kNmt = 0x000, kSync = 0x080;
inline constexpr std::uint32_t kEmergency = 0x080;
/// Transmit: from the node; receive: to the node. PDOs are numbered from 1, 0x100 apart.
inline constexpr std::uint32_t kTransmitPdo1 = 0x180, kReceivePdo1 = 0x200, kNextPdo = 0x100;
inline constexpr std::uint32_t kSdoToClient = 0x580, kSdoToServer = 0x600;
inline constexpr std::uint32_t kHeartbeat = 0x700;

}  // namespace luxrig::canopen
