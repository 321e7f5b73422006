#pragma once
/// Who else may use the daemon: people with a password, and scripts with a token. A JSON file beside the rig file, which
/// `luxrig accounts` writes. It has no password and no token, only hashes of them.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "tools/luxrigd/api/role.h"

namespace luxrig {

inline constexpr std::size_t kMinPasswordLetters = 8, kMaxPasswordLetters = 256;

struct Account {
  std::string name;
  Role role = Role::look;
  std::string password_hash;  ///< Argon2id, as libsodium writes it: "$argon2id$v=19$m=65536,t=2,p=1$…"
  bool operator==(const Account&) const = default;
};

struct ScriptToken {
  std::string name;
  Role role = Role::look;
  std::string hash;        ///< BLAKE2b of the token, in hex: it is random, so that a slow hash would add nothing
  std::string last_day{};  ///< "2027-01-31", UTC; empty: no end
  bool operator==(const ScriptToken&) const = default;
};

struct Accounts {
  std::vector<Account> people;
  std::vector<ScriptToken> tokens;

  /// Null if there is none of this name.
  [[nodiscard]] const Account* person(std::string_view name) const;
};

/// 1 to 64 letters, digits and . _ - @, in ASCII.
[[nodiscard]] bool is_account_name(std::string_view name);
/// A day of the calendar, "2027-01-31".
[[nodiscard]] bool is_day(std::string_view text);

/// Refused with all that is wrong: unknown keys, names twice, hashes that luxrig does not write.
[[nodiscard]] Checked<Accounts> accounts_from_json(const std::string& text, const std::string& file);
[[nodiscard]] std::string to_json(const Accounts& accounts);

/// The file with these, mode 600: read_secret().
[[nodiscard]] Checked<Accounts> read_accounts(const std::filesystem::path& file);
[[nodiscard]] Result<void> write_accounts(const std::filesystem::path& file, const Accounts& accounts);

/// Takes some 0.1 s and 64 MiB; a fault if the memory is not there.
[[nodiscard]] Result<std::string> password_hash(std::string_view password);
/// In the same time whatever is wrong. An empty hash is nobody's.
[[nodiscard]] bool password_fits(std::string_view password, const std::string& hash);

/// A new token, 32 random bytes in hex.
[[nodiscard]] std::string random_secret();
[[nodiscard]] std::string token_hash(std::string_view token);
/// The token's entry, if it is one and has not ended. Takes the same time whichever it is.
[[nodiscard]] std::optional<ScriptToken> token_of(const Accounts& accounts, std::string_view token,
                                                  std::int64_t now_unix_s);
[[nodiscard]] bool has_not_ended(const ScriptToken& token, std::int64_t now_unix_s);
/// Compares in constant time, wherever they differ.
[[nodiscard]] bool same_secret(std::string_view a, std::string_view b);

}  // namespace luxrig
