#pragma once
/// Who asks: holders of the daemon's token, browsers opened with a one-time address, people who logged in, and scripts
/// with a token of their own. All functions may be called from any thread.

#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "tools/http/message.h"
#include "tools/luxrigd/api/accounts.h"
#include "tools/luxrigd/api/login_limits.h"

namespace luxrig {

/// What a person of this computer is called: the daemon's user, who may do all.
inline constexpr const char* kLocalUser = "this computer's user";

class Access {
 public:
  using Clock = std::chrono::steady_clock;

  Access();

  /// The token, 32 random bytes in hex.
  [[nodiscard]] const std::string& token() const { return token_; }

  /// Null: there are none, and nobody can log in. A session ends when its account has another password or role, or is
  /// gone.
  void use(std::shared_ptr<const Accounts> accounts);
  [[nodiscard]] bool has_accounts() const;

  /// The sender, from `Authorization: Bearer` or the cookie. A request keeps its session alive.
  [[nodiscard]] HttpSender sender(const HttpRequest& request, Clock::time_point now = Clock::now(),
                                  std::int64_t now_unix_s = unix_seconds());
  /// A sender still has the access that it had: an open stream of events is asked so, and keeps no session alive.
  [[nodiscard]] bool still(const HttpSender& sender, Clock::time_point now = Clock::now(),
                           std::int64_t now_unix_s = unix_seconds()) const;

  /// A code that opens one browser, once, within ten minutes.
  [[nodiscard]] std::string one_time_code(Clock::time_point now = Clock::now());
  /// Consumes such a code and returns the session for the browser's cookie. nullopt if the code is used, too old or
  /// unknown.
  [[nodiscard]] std::optional<std::string> open(const std::string& code, Clock::time_point now = Clock::now());

  struct LoggedIn {
    std::string session;  ///< empty: refused
    Role role = Role::anybody;
    int wait_s = 0;  ///< above 0: too many attempts, the next in so many seconds
  };
  /// Takes as long as password_fits().
  [[nodiscard]] LoggedIn log_in(const std::string& name, const std::string& password, const std::string& from,
                                Clock::time_point now = Clock::now());
  /// Ends the session of that sender, if it has one.
  void log_out(const HttpSender& sender);

  /// Puts the port into the cookie's name: a browser sends a host's cookies to all its ports.
  void set_port(int port) { cookie_name_ = "luxrig_session_" + std::to_string(port); }
  /// Value of Set-Cookie. secure: the browser sends it by https alone. An empty session takes the cookie away.
  [[nodiscard]] std::string cookie(const std::string& session, bool secure) const;

 private:
  struct Code {
    std::string code;
    Clock::time_point until;
  };
  struct Session {
    std::string secret;
    std::optional<Account> of;  ///< as it was at the login; none: this computer's user, until the daemon ends
    Clock::time_point used{};
  };
  static std::int64_t unix_seconds();
  [[nodiscard]] bool lives(const Session& session, Clock::time_point now) const;
  [[nodiscard]] std::string begin_session(std::optional<Account> of, Clock::time_point now);

  std::string token_, cookie_name_ = "luxrig_session";
  mutable std::mutex mutex_;  // guards the members below
  std::shared_ptr<const Accounts> accounts_;
  LoginLimits limits_;
  std::deque<Code> codes_;
  std::deque<Session> sessions_;
};

}  // namespace luxrig
