#pragma once
/// One TCP connection to a Modbus server: connect, ask, be answered, each within a bound. Over libmodbus.

#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "core/result.h"
#include "drivers/modbus/modbus_codec.h"

struct _modbus;

namespace luxrig::modbus {

class Link {
 public:
  Link(std::string host, int port) : host_(std::move(host)), port_(port) {}
  ~Link() { close(); }
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  [[nodiscard]] bool connected() const { return context_ != nullptr; }
  Result<void> connect(std::chrono::milliseconds timeout);
  void close();

  /// requires connected(). Returns within `timeout`, whatever the peer does. Faults:
  ///   timeout   no answer; the connection stays unless an answer had begun
  ///   network   closed or reset; the connection is closed here too
  ///   protocol  garbled; the connection is closed, since nobody knows where the next answer begins
  ///   refused   an exception, by name; the connection stays. last_exception() has its code
  /// A late answer to an earlier request that timed out is recognised by its transaction number and skipped.
  Result<std::vector<std::uint16_t>> exchange(const Request& request, std::chrono::milliseconds timeout);

  /// True when the peer has closed an idle connection (found without waiting); it is then closed here too.
  bool found_closed();

  [[nodiscard]] int last_exception() const { return last_exception_; }

 private:
  Result<void> drop_unasked();
  Result<std::vector<std::uint8_t>> receive(std::chrono::milliseconds timeout);
  [[nodiscard]] Fault lost(Cause cause, std::string detail);

  std::string host_;
  int port_ = 0;
  ::_modbus* context_ = nullptr;
  int fd_ = -1;
  std::uint16_t transaction_ = 0;
  std::deque<std::uint16_t> unanswered_;  ///< requests of this connection that timed out, newest last
  int last_exception_ = 0;
};

}  // namespace luxrig::modbus
