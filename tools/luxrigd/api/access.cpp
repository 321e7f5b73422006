#include "tools/luxrigd/api/access.h"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cstdlib>

#include "core/check.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxSessions = 64, kMaxCodes = 64;
constexpr std::chrono::minutes kCodeIsGood{10};

std::string random_hex() {
  std::array<unsigned char, 32> bytes{};
  LUXRIG_CHECK(::getrandom(bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()), "no random bytes");
  constexpr char kDigits[] = "0123456789abcdef";
  std::string hex;
  for (const unsigned char byte : bytes) {
    hex += kDigits[byte >> 4];
    hex += kDigits[byte & 15];
  }
  return hex;
}

/// Compares in constant time, wherever they differ.
bool same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned char>(a[i] ^ b[i]);
  return difference == 0;
}

}  // namespace

Access::Access() : token_(random_hex()) {}

std::string Access::credential(const HttpRequest& request) const {
  constexpr std::string_view kBearer = "Bearer ";
  if (const auto given = request.header("authorization"))
    return given->substr(0, kBearer.size()) == kBearer && same_secret(given->substr(kBearer.size()), token_) ? "token"
                                                                                                             : "";
  const std::lock_guard lock(mutex_);
  for (const auto& [name, value] : request.headers) {
    if (name != "cookie") continue;
    for (std::string_view rest = value; !rest.empty();) {
      std::string_view pair = rest.substr(0, rest.find(';'));
      rest.remove_prefix(std::min(rest.size(), pair.size() + 1));
      pair.remove_prefix(std::min(pair.size(), pair.find_first_not_of(' ')));
      const std::size_t equals = pair.find('=');
      if (equals == std::string_view::npos || pair.substr(0, equals) != cookie_name_) continue;
      for (const std::string& session : sessions_)
        if (same_secret(pair.substr(equals + 1), session)) return session;
    }
  }
  return "";
}

std::string Access::one_time_code(Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  if (codes_.size() >= kMaxCodes) codes_.pop_front();
  codes_.push_back({random_hex(), now + kCodeIsGood});
  return codes_.back().code;
}

std::optional<std::string> Access::open(const std::string& code, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  const auto found =
      std::find_if(codes_.begin(), codes_.end(), [&](const Code& known) { return same_secret(known.code, code); });
  if (found == codes_.end()) return std::nullopt;
  const bool good = now < found->until;
  codes_.erase(found);
  if (!good) return std::nullopt;
  if (sessions_.size() >= kMaxSessions) sessions_.pop_front();
  sessions_.push_back(random_hex());
  return sessions_.back();
}

std::string Access::cookie(const std::string& session) const {
  return cookie_name_ + "=" + session + "; HttpOnly; SameSite=Strict; Path=/";
}

}  // namespace luxrig
