#pragma once
/// Network management and heartbeat (CiA 301, 7.2.8): commands to nodes and their states. Pure.

#include <optional>

#include "core/time.h"
#include "drivers/can/can_frame.h"

namespace luxrig::canopen {

enum class NmtCommand : std::uint8_t {
  start = 1,
  stop = 2,
  pre_operational = 0x80,
  reset_node = 0x81,
  reset_comm = 0x82
};
enum class NmtState : std::uint8_t { boot_up = 0, stopped = 4, operational = 5, pre_operational = 0x7F };
[[nodiscard]] const char* name_of(NmtState state);

/// node 0 = all
[[nodiscard]] can::CanFrame nmt_frame(NmtCommand command, int node);
[[nodiscard]] can::CanFrame heartbeat_frame(NmtState state, int node);
/// Empty if it is no heartbeat: not one byte, or an unknown state.
[[nodiscard]] std::optional<NmtState> decode_heartbeat(const can::CanFrame& frame);

/// Listens to one node's heartbeat.
class HeartbeatConsumer {
 public:
  explicit HeartbeatConsumer(Duration timeout) : timeout_(timeout) {}
  void heard(Time now, NmtState state) { last_ = now, state_ = state; }
  void forget() { last_.reset(); }
  /// Its newest state; empty after the timeout.
  [[nodiscard]] std::optional<NmtState> state(Time now) const {
    return last_ && now - *last_ <= timeout_ ? std::optional(state_) : std::nullopt;
  }

 private:
  Duration timeout_;
  std::optional<Time> last_;
  NmtState state_ = NmtState::boot_up;
};

}  // namespace luxrig::canopen
