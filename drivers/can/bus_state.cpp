#include "drivers/can/bus_state.h"

namespace luxrig::can {
namespace {

// Classes, in the identifier.
constexpr std::uint32_t kController = 0x004, kBusOff = 0x040, kRestarted = 0x100;
// Of kController, in data[1].
constexpr int kOverflow = 0x03, kWarning = 0x0C, kPassive = 0x30, kActiveAgain = 0x40;

}  // namespace

const char* name_of(ControllerState state) {
  switch (state) {
    case ControllerState::active:
      return "error-active";
    case ControllerState::warning:
      return "error-warning";
    case ControllerState::passive:
      return "error-passive";
    case ControllerState::off:
      return "bus-off";
  }
  return "";
}

void BusState::heard(const CanFrame& frame) {
  if (!frame.error) {
    if (state_ == ControllerState::off) state_ = ControllerState::active;  // it hears nothing while off the bus
    return;
  }
  if ((frame.id & kController) != 0) {
    const int what = frame.data[1];
    if ((what & kOverflow) != 0) ++overruns_;
    if ((what & kPassive) != 0) {
      state_ = ControllerState::passive;
    } else if ((what & kWarning) != 0) {
      state_ = ControllerState::warning;
    } else if ((what & kActiveAgain) != 0) {
      state_ = ControllerState::active;
    }
  }
  if ((frame.id & kRestarted) != 0) state_ = ControllerState::active;
  if ((frame.id & kBusOff) != 0) state_ = ControllerState::off;
}

}  // namespace luxrig::can
