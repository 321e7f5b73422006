#include "drivers/can/canopen/nmt.h"

#include "drivers/can/canopen/cob_id.h"

namespace luxrig::canopen {

const char* name_of(NmtState state) {
  switch (state) {
    case NmtState::boot_up:
      return "boot-up";
    case NmtState::stopped:
      return "stopped";
    case NmtState::operational:
      return "operational";
    case NmtState::pre_operational:
      return "pre-operational";
  }
  return "";
}

can::CanFrame nmt_frame(NmtCommand command, int node) {
  const std::uint8_t payload[] = {static_cast<std::uint8_t>(command), static_cast<std::uint8_t>(node)};
  return can::data_frame(kNmt, payload);
}

can::CanFrame heartbeat_frame(NmtState state, int node) {
  const std::uint8_t payload[] = {static_cast<std::uint8_t>(state)};
  return can::data_frame(kHeartbeat + static_cast<std::uint32_t>(node), payload);
}

std::optional<NmtState> decode_heartbeat(const can::CanFrame& frame) {
  if (frame.size != 1) return std::nullopt;
  for (const NmtState state :
       {NmtState::boot_up, NmtState::stopped, NmtState::operational, NmtState::pre_operational}) {
    if (frame.data[0] == static_cast<std::uint8_t>(state)) return state;
  }
  return std::nullopt;
}

}  // namespace luxrig::canopen
