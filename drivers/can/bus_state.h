#pragma once
/// State of the CAN controller, from error frames (linux/can/error.h) and good frames. A write may succeed while the
/// controller is off the bus, so only this state shows it.

#include <cstdint>

#include "drivers/can/can_frame.h"

namespace luxrig::can {

/// Fault confinement of ISO 11898-1. warning: an error counter is above 96; passive: above 127; off: above 255.
enum class ControllerState { active, warning, passive, off };
[[nodiscard]] const char* name_of(ControllerState state);

class BusState {
 public:
  /// A data frame or an error frame.
  void heard(const CanFrame& frame);
  [[nodiscard]] ControllerState state() const { return state_; }
  [[nodiscard]] std::uint64_t overruns() const { return overruns_; }  ///< frames that the controller lost
  void reset() { *this = BusState(); }

 private:
  ControllerState state_ = ControllerState::active;
  std::uint64_t overruns_ = 0;
};

}  // namespace luxrig::can
