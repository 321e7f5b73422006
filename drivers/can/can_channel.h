#pragma once
/// CAN frames in and out, never blocking: over a SocketCAN interface (can_socket.h), or as datagrams to a simulated bus
/// (can_datagrams.h). Error frames are received like others.

#include <optional>

#include "core/result.h"
#include "drivers/can/can_frame.h"

namespace luxrig::can {

enum class Sent {
  yes,
  queue_full  ///< not taken (ENOBUFS): no node acknowledges, or there is too much to send
};

class CanChannel {
 public:
  virtual ~CanChannel() = default;
  /// Idempotent. Fault network if there is no such interface or it is down, system if the kernel has no CAN.
  virtual Result<void> open() = 0;
  virtual void close() = 0;
  /// Also false after an error that only reopening may mend (the interface is down or gone).
  [[nodiscard]] virtual bool is_open() const = 0;
  /// requires is_open(). Success says nothing about arrival.
  virtual Result<Sent> send(const CanFrame& frame) = 0;
  virtual std::optional<CanFrame> receive() = 0;
  /// An error since the last call, once.
  virtual std::optional<Fault> take_error() = 0;
};

}  // namespace luxrig::can
