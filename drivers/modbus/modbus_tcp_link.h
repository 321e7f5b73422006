#pragma once
/// One TCP connection to a Modbus server, over libmodbus.

#include <deque>
#include <string>

#include "drivers/modbus/modbus_link.h"

struct _modbus;

namespace luxrig::modbus {

class TcpLink final : public Link {
 public:
  TcpLink(std::string host, int port) : host_(std::move(host)), port_(port) {}
  ~TcpLink() override { shut(); }

  [[nodiscard]] bool connected() const override { return context_ != nullptr; }
  Result<void> connect(std::chrono::milliseconds timeout) override;
  void close() override { shut(); }
  /// Recognises a late answer by its transaction number and skips it.
  Result<std::vector<std::uint16_t>> exchange(const Request& request, std::chrono::milliseconds timeout) override;
  bool found_closed() override;
  [[nodiscard]] bool answers_are_numbered() const override { return true; }

 private:
  void shut();
  Result<void> drop_unasked();
  Result<std::vector<std::uint8_t>> receive(std::chrono::milliseconds timeout);
  [[nodiscard]] Fault lost(Cause cause, std::string detail);

  std::string host_;
  int port_ = 0;
  ::_modbus* context_ = nullptr;
  int fd_ = -1;
  std::uint16_t transaction_ = 0;
  std::deque<std::uint16_t> unanswered_;  ///< requests of this connection that timed out, newest last
};

}  // namespace luxrig::modbus
