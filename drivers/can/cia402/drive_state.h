#pragma once
/// The state machine of a drive (CiA 402-2, 7.1): the state in its statusword (6041), and the controlword (6040) that
/// leads onward. Pure.

#include <cstdint>

namespace luxrig::cia402 {

enum class DriveState {
  not_ready_to_switch_on,
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,
  quick_stop_active,
  fault_reaction_active,
  fault,
  unknown  ///< bits that fit no state
};
[[nodiscard]] const char* name_of(DriveState state);
[[nodiscard]] DriveState state_of(std::uint16_t statusword);

// Bits of the statusword.
inline constexpr std::uint16_t kTargetReached = 1 << 10, kInternalLimit = 1 << 11;
inline constexpr std::uint16_t kSetPointAcknowledged = 1 << 12;  ///< in profile position
inline constexpr std::uint16_t kHomingAttained = 1 << 12;        ///< in homing
inline constexpr std::uint16_t kHomingError = 1 << 13;           ///< in homing; in profile position: following error

// Controlwords.
inline constexpr std::uint16_t kDisableVoltage = 0x0000, kQuickStop = 0x0002, kShutdown = 0x0006, kSwitchOn = 0x0007,
                               kEnableOperation = 0x000F, kFaultReset = 0x0080;
// Bits used together with kEnableOperation.
inline constexpr std::uint16_t kNewSetPoint = 1 << 4;        ///< in homing: start
inline constexpr std::uint16_t kChangeImmediately = 1 << 5;  ///< a new set-point replaces the old one; else it queues
inline constexpr std::uint16_t kHalt = 1 << 8;

/// The next controlword towards operation enabled. From quick stop active: `holds` = its option code (605A, 5 to 8)
/// allows the direct way back, else it must switch off first. A fault needs a reset first: kDisableVoltage here.
[[nodiscard]] std::uint16_t towards_operation(DriveState state, bool holds);

}  // namespace luxrig::cia402
