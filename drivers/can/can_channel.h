#pragma once
/// CAN frames in and out without ever blocking: over a SocketCAN interface (can_socket.h), or in datagrams to a
/// simulated bus (can_datagrams.h). Error frames are received like others.

#include <optional>

#include "core/result.h"
#include "drivers/can/can_frame.h"

namespace luxrig::can {

enum class Sent {
  yes,
  queue_full  ///< not taken (ENOBUFS): nobody acknowledges, or there is too much to send
};

class CanChannel {
 public:
  virtual ~CanChannel() = default;
  /// Idempotent. Fault network when there is no such interface or it is down, system when the kernel has no CAN.
  virtual Result<void> open() = 0;
  virtual void close() = 0;
  /// False also after an error that only opening again may mend (the interface went down or away).
  [[nodiscard]] virtual bool is_open() const = 0;
  /// requires is_open(). Success says nothing about arrival.
  virtual Result<Sent> send(const CanFrame& frame) = 0;
  virtual std::optional<CanFrame> receive() = 0;
  /// What went wrong since the last call, once.
  virtual std::optional<Fault> take_error() = 0;
};

}  // namespace luxrig::can
