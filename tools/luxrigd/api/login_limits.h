#pragma once
/// Slows down whoever tries passwords: after some that were wrong, each next one has to wait twice as long, for the
/// address it comes from and for the account it is for.

#include <chrono>
#include <deque>
#include <string>

namespace luxrig {

class LoginLimits {
 public:
  using Clock = std::chrono::steady_clock;

  /// Counts an attempt as wrong, before its password is looked at, so that attempts at the same time cannot pass
  /// together; right() takes that back. Returns 0, or the seconds to wait: then it did not count.
  [[nodiscard]] int attempt(const std::string& account, const std::string& from, Clock::time_point now);
  void right(const std::string& account, const std::string& from);

 private:
  struct Count {
    std::string of;
    int wrong = 0;
    Clock::time_point last{};
  };
  struct Rule {
    int free;                   ///< wrong ones without a wait
    std::chrono::seconds most;  ///< longest wait
  };
  static std::chrono::seconds wait_of(const Count& count, const Rule& rule);
  static Count& count_of(std::deque<Count>& counts, const std::string& of, Clock::time_point now);

  std::deque<Count> accounts_, addresses_;  ///< the one used last is at the end
};

/// The part of an address that one neighbour can choose freely is left out: the last 64 bits of IPv6.
[[nodiscard]] std::string address_for_limits(const std::string& from);

}  // namespace luxrig
