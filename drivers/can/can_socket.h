#pragma once
/// A CAN interface of Linux (SocketCAN, PF_CAN raw). Bit rate, restart-ms (recovery from bus-off) and txqueuelen are
/// set at the interface: `ip link set can0 type can bitrate 500000 restart-ms 100`, `ip link set can0 txqueuelen 100
/// up`.

#include <memory>
#include <string>
#include <vector>

#include "drivers/can/can_channel.h"

namespace luxrig::can {

struct CanSocketSettings {
  std::string interface_name;      ///< "can0"
  std::vector<std::uint32_t> ids;  ///< 11-bit data frames to receive, besides error frames of the controller's state
};

[[nodiscard]] std::unique_ptr<CanChannel> make_can_socket(CanSocketSettings settings);

}  // namespace luxrig::can
