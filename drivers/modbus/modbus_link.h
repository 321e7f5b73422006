#pragma once
/// The link to a bus's units over TCP or a serial line: connect and exchange, each within a bound.

#include <chrono>
#include <cstdint>
#include <vector>

#include "core/result.h"
#include "drivers/modbus/modbus_codec.h"

namespace luxrig::modbus {

class Link {
 public:
  Link() = default;
  virtual ~Link() = default;
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  [[nodiscard]] virtual bool connected() const = 0;
  virtual Result<void> connect(std::chrono::milliseconds timeout) = 0;
  virtual void close() = 0;

  /// requires connected(). Returns within `timeout` and longest_on_wire(), whatever the peer does. Faults:
  ///   timeout   no answer; the link stays, unless the start of the next answer is unknown
  ///   network   the connection is lost; the link is closed here too
  ///   protocol  garbled; a TCP link is closed, since the start of the next answer is unknown
  ///   refused   an exception, by name; the link stays. last_exception() has its code
  /// A late answer to an earlier request is never taken for this one's, as far as the protocol can tell them apart.
  virtual Result<std::vector<std::uint16_t>> exchange(const Request& request, std::chrono::milliseconds timeout) = 0;

  /// True if the peer has closed an idle link (found without waiting); the link is then closed here too.
  virtual bool found_closed() = 0;

  /// Time on the wire of the largest frames, on top of a timeout.
  [[nodiscard]] virtual std::chrono::milliseconds longest_on_wire() const { return std::chrono::milliseconds(0); }
  /// False if answers carry no request number. A unit that let a request time out must then be left alone until its
  /// answer can no longer come.
  [[nodiscard]] virtual bool answers_are_numbered() const = 0;

  /// Exception code of the last exchange; 0 = it had none.
  [[nodiscard]] int last_exception() const { return last_exception_; }
  /// The last exchange was garbled on the wire and its answer is over, so it may be repeated at once.
  [[nodiscard]] bool may_repeat() const { return may_repeat_; }

 protected:
  int last_exception_ = 0;
  bool may_repeat_ = false;
};

}  // namespace luxrig::modbus
