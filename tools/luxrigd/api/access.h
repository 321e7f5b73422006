#pragma once
/// Who may ask the daemon over its port: whoever has its token, and browsers that were opened with a one-time address.

#include <chrono>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include "tools/http/message.h"

namespace luxrig {

class Access {
 public:
  using Clock = std::chrono::steady_clock;

  Access();

  /// The token, 32 random bytes in hex.
  [[nodiscard]] const std::string& token() const { return token_; }

  /// Who asks, by `Authorization: Bearer` or the cookie; empty when nobody known. Any thread, like the others.
  [[nodiscard]] std::string credential(const HttpRequest& request) const;

  /// A code that opens one browser, once, within ten minutes.
  [[nodiscard]] std::string one_time_code(Clock::time_point now = Clock::now());
  /// Takes such a code and gives what a browser is to keep as its cookie; nothing when it is used, too old or none.
  [[nodiscard]] std::optional<std::string> open(const std::string& code, Clock::time_point now = Clock::now());

  /// A browser sends the cookies of all ports of a host to each of them, so the name has the port.
  void set_port(int port) { cookie_name_ = "luxrig_session_" + std::to_string(port); }
  /// Set-Cookie's value.
  [[nodiscard]] std::string cookie(const std::string& session) const;

 private:
  struct Code {
    std::string code;
    Clock::time_point until;
  };
  std::string token_, cookie_name_ = "luxrig_session";
  mutable std::mutex mutex_;  // guards what follows
  std::deque<Code> codes_;
  std::deque<std::string> sessions_;
};

}  // namespace luxrig
