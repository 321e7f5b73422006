#pragma once
/// What error frames (linux/can/error.h) and good frames say of the CAN controller. A write may still succeed while it
/// is off the bus, so that only this tells.

#include <cstdint>

#include "drivers/can/can_frame.h"

namespace luxrig::can {

/// Fault confinement of ISO 11898-1. warning: an error counter is above 96; passive: above 127; off: above 255.
enum class ControllerState { active, warning, passive, off };
[[nodiscard]] const char* name_of(ControllerState state);

class BusState {
 public:
  /// A frame of either kind.
  void heard(const CanFrame& frame);
  [[nodiscard]] ControllerState state() const { return state_; }
  [[nodiscard]] std::uint64_t overruns() const { return overruns_; }  ///< frames that the controller lost
  void reset() { *this = BusState(); }

 private:
  ControllerState state_ = ControllerState::active;
  std::uint64_t overruns_ = 0;
};

}  // namespace luxrig::can
