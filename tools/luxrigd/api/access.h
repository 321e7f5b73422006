#pragma once
/// Access to the daemon's port: for holders of its token, and for browsers opened with a one-time address.

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

  /// Identity of the caller, from `Authorization: Bearer` or the cookie; empty if unknown. Any thread, like the others.
  [[nodiscard]] std::string credential(const HttpRequest& request) const;

  /// A code that opens one browser, once, within ten minutes.
  [[nodiscard]] std::string one_time_code(Clock::time_point now = Clock::now());
  /// Consumes such a code and returns the session for the browser's cookie. nullopt if the code is used, too old or
  /// unknown.
  [[nodiscard]] std::optional<std::string> open(const std::string& code, Clock::time_point now = Clock::now());

  /// Puts the port into the cookie's name: a browser sends a host's cookies to all its ports.
  void set_port(int port) { cookie_name_ = "luxrig_session_" + std::to_string(port); }
  /// Value of Set-Cookie.
  [[nodiscard]] std::string cookie(const std::string& session) const;

 private:
  struct Code {
    std::string code;
    Clock::time_point until;
  };
  std::string token_, cookie_name_ = "luxrig_session";
  mutable std::mutex mutex_;  // guards the two below
  std::deque<Code> codes_;
  std::deque<std::string> sessions_;
};

}  // namespace luxrig
