#include "tools/luxrigd/api/accounts.h"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <nlohmann/json.hpp>
#include <set>

#include "core/check.h"
#include "tools/process/secret_file.h"

namespace luxrig {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxFileBytes = 1u << 20, kMaxEntries = 1000, kSecretBytes = 32;
/// libsodium's "interactive": 2 passes over 64 MiB. A hash with other figures might take all memory, or nothing.
constexpr unsigned long long kPasses = crypto_pwhash_argon2id_OPSLIMIT_INTERACTIVE;
constexpr std::size_t kMemory = crypto_pwhash_argon2id_MEMLIMIT_INTERACTIVE;
constexpr std::string_view kHashBegins = "$argon2id$v=19$m=65536,t=2,p=1$";
/// Of no password that anybody knows.
constexpr const char* kNobody =
    "$argon2id$v=19$m=65536,t=2,p=1$AAAAAAAAAAAAAAAAAAAAAA$AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA";

void begin_sodium() {
  static const bool begun = ::sodium_init() >= 0;
  LUXRIG_CHECK(begun, "no random bytes");
}

std::string hex_of(const unsigned char* bytes, std::size_t count) {
  std::string hex(2 * count + 1, '\0');
  ::sodium_bin2hex(hex.data(), hex.size(), bytes, count);
  hex.pop_back();
  return hex;
}

bool is_hex_of_hash(std::string_view text) {
  return text.size() == 2 * kSecretBytes && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

bool is_password_hash(std::string_view text) {
  return text.substr(0, kHashBegins.size()) == kHashBegins && text.size() < crypto_pwhash_STRBYTES &&
         std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c < 127; });
}

std::optional<std::string> text_at(const json& entry, const char* key) {
  const auto it = entry.find(key);
  if (it == entry.end() || !it->is_string()) return std::nullopt;
  return it->get<std::string>();
}

/// Entries of one list, each with these keys.
class Reading {
 public:
  Reading(const json& whole, const std::string& file) : whole_(whole), file_(file) {}

  template <class Entry>
  std::vector<Entry> list(const char* key, const std::set<std::string>& keys, Entry (Reading::*read)(const json&)) {
    std::vector<Entry> out;
    const auto it = whole_.find(key);
    if (it == whole_.end()) return out;
    if (!it->is_array() || it->size() > kMaxEntries) {
      refuse(fmt::format("`{}` is no list of at most {}", key, kMaxEntries), "write one");
      return out;
    }
    std::set<std::string> names;
    for (const json& entry : *it) {
      at_ = fmt::format("{} {}", key, out.size() + 1);
      if (!entry.is_object()) {
        refuse("is no object", "write {…}");
        break;
      }
      for (const auto& [name, value] : entry.items())
        if (!keys.contains(name)) refuse("has an unknown key", "remove it; it has " + text_of_keys(keys));
      out.push_back((this->*read)(entry));
      if (!is_account_name(out.back().name))
        refuse("has no name", "give it one: 1 to 64 letters, digits and . _ - @");
      else if (!names.insert(out.back().name).second)
        refuse("has the name of another", "remove one of them");
    }
    return out;
  }
  Account person(const json& entry) {
    Account out{text_at(entry, "name").value_or(""), role_in(entry), text_at(entry, "password").value_or("")};
    if (!is_password_hash(out.password_hash))
      refuse("has no hash of a password as luxrig writes it", "luxrig accounts RIG add NAME sets a new one");
    return out;
  }
  ScriptToken token(const json& entry) {
    ScriptToken out{text_at(entry, "name").value_or(""), role_in(entry), text_at(entry, "hash").value_or(""),
                    text_at(entry, "last_day").value_or("")};
    if (!is_hex_of_hash(out.hash)) refuse("has no hash of a token", "luxrig accounts RIG token NAME makes a new one");
    if (entry.contains("last_day") && !is_day(out.last_day)) refuse("`last_day` is no day", "write 2027-01-31");
    return out;
  }
  void refuse(const std::string& what, std::string mend) {
    problems.push_back({file_, 0, 0, at_.empty() ? what : at_ + " " + what, std::move(mend)});
  }

  std::vector<Problem> problems;

 private:
  Role role_in(const json& entry) {
    const auto role = role_called(text_at(entry, "role").value_or(""));
    if (!role) refuse("has no role", "write look, operate or configure");
    return role.value_or(Role::look);
  }
  static std::string text_of_keys(const std::set<std::string>& keys) {
    std::string text;
    for (const std::string& key : keys) text += (text.empty() ? "" : ", ") + key;
    return text;
  }

  const json& whole_;
  const std::string& file_;
  std::string at_;
};

}  // namespace

const char* name_of(Role role) {
  constexpr const char* kNames[] = {"anybody", "look", "operate", "configure"};
  return kNames[static_cast<std::size_t>(role)];
}

std::optional<Role> role_called(std::string_view name) {
  for (const Role role : {Role::look, Role::operate, Role::configure})
    if (name == name_of(role)) return role;
  return std::nullopt;
}

const Account* Accounts::person(std::string_view name) const {
  const auto found = std::find_if(people.begin(), people.end(), [&](const Account& one) { return one.name == name; });
  return found == people.end() ? nullptr : &*found;
}

bool is_account_name(std::string_view name) {
  return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' ||
           c == '-' || c == '@';
  });
}

bool is_day(std::string_view text) {
  if (text.size() != 10) return false;
  for (std::size_t i = 0; i < text.size(); ++i)
    if (i == 4 || i == 7 ? text[i] != '-' : text[i] < '0' || text[i] > '9') return false;
  const auto digits = [&](std::size_t at, std::size_t count) {
    int value = 0;
    for (const char c : text.substr(at, count)) value = 10 * value + (c - '0');
    return value;
  };
  std::tm day{};
  day.tm_year = digits(0, 4) - 1900;
  day.tm_mon = digits(5, 2) - 1;
  day.tm_mday = digits(8, 2);
  const std::tm written = day;
  // 31 February becomes a day of March.
  return ::timegm(&day) != -1 && day.tm_mon == written.tm_mon && day.tm_mday == written.tm_mday;
}

Checked<Accounts> accounts_from_json(const std::string& text, const std::string& file) {
  const json whole = text.size() > kMaxFileBytes
                         ? json(json::value_t::discarded)
                         : json::parse(
                               text, [](int depth, json::parse_event_t, json&) { return depth <= 8; }, false);
  if (!whole.is_object()) {
    return tl::unexpected(std::vector<Problem>{
        {file, 0, 0, "is no JSON object", "restore it from a copy, or remove it and luxrig accounts RIG add NAME"}});
  }
  Reading reading(whole, file);
  for (const auto& [key, value] : whole.items())
    if (key != "people" && key != "tokens") reading.refuse("has an unknown key", "it has people and tokens");
  Accounts out;
  out.people = reading.list("people", {"name", "role", "password"}, &Reading::person);
  out.tokens = reading.list("tokens", {"name", "role", "hash", "last_day"}, &Reading::token);
  if (!reading.problems.empty()) return tl::unexpected(std::move(reading.problems));
  return out;
}

std::string to_json(const Accounts& accounts) {
  nlohmann::ordered_json out = {{"people", json::array()}, {"tokens", json::array()}};
  for (const Account& one : accounts.people)
    out["people"].push_back(
        nlohmann::ordered_json{{"name", one.name}, {"role", name_of(one.role)}, {"password", one.password_hash}});
  for (const ScriptToken& one : accounts.tokens) {
    out["tokens"].push_back(
        nlohmann::ordered_json{{"name", one.name}, {"role", name_of(one.role)}, {"hash", one.hash}});
    if (!one.last_day.empty()) out["tokens"].back()["last_day"] = one.last_day;
  }
  return out.dump(1) + "\n";
}

Checked<Accounts> read_accounts(const std::filesystem::path& file) {
  auto text = read_secret(file, kMaxFileBytes);
  if (!text) return tl::unexpected(std::move(text.error()));
  return accounts_from_json(*text, file.string());
}

Result<void> write_accounts(const std::filesystem::path& file, const Accounts& accounts) {
  return write_secret(file, to_json(accounts));
}

Result<std::string> password_hash(std::string_view password) {
  begin_sodium();
  std::array<char, crypto_pwhash_STRBYTES> hash{};
  if (::crypto_pwhash_str_alg(hash.data(), password.data(), password.size(), kPasses, kMemory,
                              crypto_pwhash_ALG_ARGON2ID13) != 0)
    return tl::unexpected(Fault{Cause::system, {}, "64 MiB of memory for the password's hash are not free", {}});
  return std::string(hash.data());
}

bool password_fits(std::string_view password, const std::string& hash) {
  begin_sodium();
  std::array<char, crypto_pwhash_STRBYTES> padded{};
  const std::string_view of = is_password_hash(hash) ? std::string_view(hash) : kNobody;
  std::copy(of.begin(), of.end(), padded.begin());
  const bool fits = ::crypto_pwhash_str_verify(padded.data(), password.data(), password.size()) == 0;
  return fits && of != kNobody;
}

std::string random_secret() {
  begin_sodium();
  std::array<unsigned char, kSecretBytes> bytes{};
  ::randombytes_buf(bytes.data(), bytes.size());
  return hex_of(bytes.data(), bytes.size());
}

std::string token_hash(std::string_view token) {
  begin_sodium();
  std::array<unsigned char, kSecretBytes> bytes{};
  ::crypto_generichash(bytes.data(), bytes.size(), reinterpret_cast<const unsigned char*>(token.data()), token.size(),
                       nullptr, 0);
  return hex_of(bytes.data(), bytes.size());
}

bool has_not_ended(const ScriptToken& token, std::int64_t now_unix_s) {
  if (token.last_day.empty()) return true;
  const std::time_t now = static_cast<std::time_t>(now_unix_s);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  // Days of this form are in order as text.
  return fmt::format("{:04}-{:02}-{:02}", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday) <= token.last_day;
}

std::optional<ScriptToken> token_of(const Accounts& accounts, std::string_view token, std::int64_t now_unix_s) {
  const std::string hash = token_hash(token);
  const ScriptToken* found = nullptr;
  for (const ScriptToken& one : accounts.tokens)
    if (same_secret(one.hash, hash)) found = &one;
  return found && has_not_ended(*found, now_unix_s) ? std::optional(*found) : std::nullopt;
}

bool same_secret(std::string_view a, std::string_view b) {
  return a.size() == b.size() && ::sodium_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace luxrig
