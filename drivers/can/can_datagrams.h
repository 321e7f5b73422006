#pragma once
/// A simulated CAN bus behind a loopback port: each UDP datagram is one frame of 16 bytes (can_frame.h), either way.
/// Used where a bus is redirected (luxrig run --sim), so that no host needs CAN in its kernel.

#include <memory>

#include "drivers/can/can_channel.h"
#include "drivers/io/datagram.h"

namespace luxrig::can {

[[nodiscard]] std::unique_ptr<CanChannel> make_can_datagrams(SocketAddress bus, std::unique_ptr<DatagramChannel> udp);

}  // namespace luxrig::can
