#include "tools/luxrigd/api/access.h"

#include <algorithm>

namespace luxrig {
namespace {

constexpr std::size_t kMaxSessions = 64, kMaxSessionsOfOne = 16, kMaxCodes = 64;
constexpr std::chrono::minutes kCodeIsGood{10};
/// A shift. A tablet that was left somewhere is nobody's after it.
constexpr std::chrono::hours kIdleEnds{8};
constexpr const char* kOfDaemon = "token";
constexpr std::string_view kOfScript = "script ";

int rank_of(Role role) { return static_cast<int>(role); }

}  // namespace

Access::Access() : token_(random_secret()) {}

std::int64_t Access::unix_seconds() {
  return std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

void Access::use(std::shared_ptr<const Accounts> accounts) {
  const std::lock_guard lock(mutex_);
  accounts_ = std::move(accounts);
}

bool Access::has_accounts() const {
  const std::lock_guard lock(mutex_);
  return accounts_ != nullptr;
}

bool Access::lives(const Session& session, Clock::time_point now) const {
  if (!session.of) return true;
  if (now - session.used >= kIdleEnds || !accounts_) return false;
  const Account* present = accounts_->person(session.of->name);
  return present && *present == *session.of;
}

HttpSender Access::sender(const HttpRequest& request, Clock::time_point now, std::int64_t now_unix_s) {
  constexpr std::string_view kBearer = "Bearer ";
  if (const auto given = request.header("authorization")) {
    if (given->substr(0, kBearer.size()) != kBearer) return {};
    const std::string_view secret = given->substr(kBearer.size());
    if (same_secret(secret, token_)) return {kOfDaemon, kLocalUser, rank_of(Role::configure)};
    std::shared_ptr<const Accounts> accounts;
    {
      const std::lock_guard lock(mutex_);
      accounts = accounts_;
    }
    const auto script = accounts ? token_of(*accounts, secret, now_unix_s) : std::nullopt;
    if (!script) return {};
    return {std::string(kOfScript) + script->hash, "script " + script->name, rank_of(script->role)};
  }
  const std::lock_guard lock(mutex_);
  for (const auto& [name, value] : request.headers) {
    if (name != "cookie") continue;
    for (std::string_view rest = value; !rest.empty();) {
      std::string_view pair = rest.substr(0, rest.find(';'));
      rest.remove_prefix(std::min(rest.size(), pair.size() + 1));
      pair.remove_prefix(std::min(pair.size(), pair.find_first_not_of(' ')));
      const std::size_t equals = pair.find('=');
      if (equals == std::string_view::npos || pair.substr(0, equals) != cookie_name_) continue;
      for (Session& session : sessions_) {
        if (!same_secret(pair.substr(equals + 1), session.secret) || !lives(session, now)) continue;
        session.used = now;
        return session.of ? HttpSender{session.secret, session.of->name, rank_of(session.of->role)}
                          : HttpSender{session.secret, kLocalUser, rank_of(Role::configure)};
      }
    }
  }
  return {};
}

bool Access::still(const HttpSender& sender, Clock::time_point now, std::int64_t now_unix_s) const {
  if (sender.credential == kOfDaemon) return true;
  const std::lock_guard lock(mutex_);
  if (sender.credential.substr(0, kOfScript.size()) == kOfScript) {
    const std::string_view hash = std::string_view(sender.credential).substr(kOfScript.size());
    if (!accounts_) return false;
    return std::any_of(accounts_->tokens.begin(), accounts_->tokens.end(), [&](const ScriptToken& one) {
      return one.hash == hash && has_not_ended(one, now_unix_s) && rank_of(one.role) == sender.rank;
    });
  }
  return std::any_of(sessions_.begin(), sessions_.end(), [&](const Session& session) {
    return same_secret(session.secret, sender.credential) && lives(session, now);
  });
}

std::string Access::one_time_code(Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  if (codes_.size() >= kMaxCodes) codes_.pop_front();
  codes_.push_back({random_secret(), now + kCodeIsGood});
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
  return begin_session(std::nullopt, now);
}

std::string Access::begin_session(std::optional<Account> of, Clock::time_point now) {
  std::erase_if(sessions_, [&](const Session& one) { return !lives(one, now); });
  const auto is_same = [&](const Session& one) { return of && one.of && one.of->name == of->name; };
  // One who logs in again and again pushes nobody else out.
  const bool many = std::count_if(sessions_.begin(), sessions_.end(), is_same) >= static_cast<long>(kMaxSessionsOfOne);
  if (many)
    sessions_.erase(std::find_if(sessions_.begin(), sessions_.end(), is_same));
  else if (sessions_.size() >= kMaxSessions)
    sessions_.pop_front();
  sessions_.push_back({random_secret(), std::move(of), now});
  return sessions_.back().secret;
}

Access::LoggedIn Access::log_in(const std::string& name, const std::string& password, const std::string& from,
                                Clock::time_point now) {
  std::string hash;
  {
    const std::lock_guard lock(mutex_);
    if (!accounts_) return {};
    if (const int wait_s = limits_.attempt(name, from, now); wait_s > 0) return {"", Role::anybody, wait_s};
    if (const Account* account = accounts_->person(name)) hash = account->password_hash;
  }
  if (!password_fits(password, hash)) return {};
  const std::lock_guard lock(mutex_);
  limits_.right(name, from);
  const Account* account = accounts_ ? accounts_->person(name) : nullptr;
  if (!account || account->password_hash != hash) return {};  // changed meanwhile
  return {begin_session(*account, now), account->role, 0};
}

void Access::log_out(const HttpSender& sender) {
  const std::lock_guard lock(mutex_);
  std::erase_if(sessions_, [&](const Session& one) { return same_secret(one.secret, sender.credential); });
}

std::string Access::cookie(const std::string& session, bool secure) const {
  return cookie_name_ + "=" + session + "; HttpOnly; SameSite=Strict; Path=/" + (secure ? "; Secure" : "") +
         (session.empty() ? "; Max-Age=0" : "");
}

}  // namespace luxrig
