#include "drivers/can/cia402/drive_state.h"

namespace luxrig::cia402 {

const char* name_of(DriveState state) {
  switch (state) {
    case DriveState::not_ready_to_switch_on:
      return "not ready to switch on";
    case DriveState::switch_on_disabled:
      return "switch on disabled";
    case DriveState::ready_to_switch_on:
      return "ready to switch on";
    case DriveState::switched_on:
      return "switched on";
    case DriveState::operation_enabled:
      return "operation enabled";
    case DriveState::quick_stop_active:
      return "quick stop active";
    case DriveState::fault_reaction_active:
      return "fault reaction active";
    case DriveState::fault:
      return "fault";
    case DriveState::unknown:
      return "unknown";
  }
  return "";
}

DriveState state_of(std::uint16_t statusword) {
  switch (statusword & 0x4F) {
    case 0x00:
      return DriveState::not_ready_to_switch_on;
    case 0x40:
      return DriveState::switch_on_disabled;
    case 0x0F:
      return DriveState::fault_reaction_active;
    case 0x08:
      return DriveState::fault;
    default:
      break;
  }
  switch (statusword & 0x6F) {
    case 0x21:
      return DriveState::ready_to_switch_on;
    case 0x23:
      return DriveState::switched_on;
    case 0x27:
      return DriveState::operation_enabled;
    case 0x07:
      return DriveState::quick_stop_active;
    default:
      return DriveState::unknown;
  }
}

std::uint16_t towards_operation(DriveState state, bool holds) {
  switch (state) {
    case DriveState::switch_on_disabled:
      return kShutdown;
    case DriveState::ready_to_switch_on:
      return kSwitchOn;
    case DriveState::switched_on:
    case DriveState::operation_enabled:
      return kEnableOperation;
    case DriveState::quick_stop_active:
      return holds ? kEnableOperation : kDisableVoltage;
    default:
      return kDisableVoltage;
  }
}

}  // namespace luxrig::cia402
