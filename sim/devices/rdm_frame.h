#pragma once
/// RDM requests and answers as a responder sees them on the line. Source: ANSI E1.20-2010, chapters 5 to 7.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace luxrig::sim {

inline constexpr std::uint64_t kRdmEverybody = 0xFFFFFFFFFFFF;
inline constexpr std::size_t kMaxRdmData = 231;

/// A request, or an answer valid for a controller: everything between start code and checksum.
struct RdmFrame {
  std::uint64_t to = 0, from = 0;  ///< 48 bits: manufacturer, device
  std::uint8_t transaction = 0;
  std::uint8_t port_or_type = 0;  ///< of an answer: 0 ACK, 1 ACK_TIMER, 2 NACK, 3 ACK_OVERFLOW
  std::uint8_t messages = 0;
  int sub_device = 0;
  int command_class = 0;  ///< 0x10, 0x20, 0x30; one more in the answer
  int pid = 0;
  std::vector<std::uint8_t> data;
};

/// From the start code on. Empty if lengths or checksum are wrong.
[[nodiscard]] std::optional<RdmFrame> read_rdm(std::span<const std::uint8_t> bytes);
/// requires at most kMaxRdmData of data.
[[nodiscard]] std::vector<std::uint8_t> write_rdm(const RdmFrame& frame);
/// A responder's answer to DISC_UNIQUE_BRANCH: no break, no start code.
[[nodiscard]] std::vector<std::uint8_t> write_branch_answer(std::uint64_t uid);

}  // namespace luxrig::sim
