#pragma once
/// The way to a bus's units: open it, ask, be answered, each within a bound. Over TCP or a serial line.

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
  ///   timeout   no answer; the link stays, unless it cannot tell where the next answer begins
  ///   network   the way is gone; the link is closed here too
  ///   protocol  garbled; a TCP link is closed, since nobody knows where the next answer begins
  ///   refused   an exception, by name; the link stays. last_exception() has its code
  /// A late answer to an earlier request is never taken for this one's, as far as the protocol lets it be told.
  virtual Result<std::vector<std::uint16_t>> exchange(const Request& request, std::chrono::milliseconds timeout) = 0;

  /// True when the peer has closed an idle link (found without waiting); it is then closed here too.
  virtual bool found_closed() = 0;

  /// What frames of the largest size take on the wire, on top of a timeout.
  [[nodiscard]] virtual std::chrono::milliseconds longest_on_wire() const { return std::chrono::milliseconds(0); }
  /// An answer has no number that says which request it belongs to: a unit that has just let a request time out must
  /// be left alone until its answer can come no more.
  [[nodiscard]] virtual bool answers_are_numbered() const = 0;

  /// Code of the exception that the last exchange ended with; 0: it did not.
  [[nodiscard]] int last_exception() const { return last_exception_; }
  /// The last exchange was spoiled on the wire, and its answer has been and gone: it may be asked again at once.
  [[nodiscard]] bool may_repeat() const { return may_repeat_; }

 protected:
  int last_exception_ = 0;
  bool may_repeat_ = false;
};

}  // namespace luxrig::modbus
