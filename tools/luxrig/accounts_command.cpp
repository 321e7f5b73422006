// accounts: who else may use a rig's daemon, and in which role.
#include <fmt/format.h>
#include <termios.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <iostream>
#include <memory>

#include "core/rig/rig_file.h"
#include "core/text/plain_text.h"
#include "tools/command_line/choice.h"
#include "tools/command_line/installed.h"
#include "tools/luxrig/commands.h"
#include "tools/luxrigd/api/accounts.h"
#include "tools/terminal/command.h"

namespace luxrig {
namespace {

struct AccountArguments {
  std::filesystem::path rig;
  std::string name, last_day;
  Role role = Role::look;
};
using Asked = std::shared_ptr<AccountArguments>;

int refuse_account(const std::string& what) {
  fmt::print(stderr, "luxrig: {}\n", what);
  return kExitBadInput;
}

/// Without echo at a terminal; else the first line of standard input.
std::optional<std::string> typed_password(const std::string& prompt) {
  termios before{};
  const bool terminal = ::isatty(STDIN_FILENO) == 1 && ::tcgetattr(STDIN_FILENO, &before) == 0;
  if (terminal) {
    fmt::print(stderr, "{}: ", prompt);
    termios quiet = before;
    quiet.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &quiet);
  }
  std::string line;
  const bool got = static_cast<bool>(std::getline(std::cin, line));
  if (terminal) {
    ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &before);
    fmt::print(stderr, "\n");
  }
  return got ? std::optional(line) : std::nullopt;
}

/// Why it is no password; empty if it is one.
std::string wrong_password(const std::string& password) {
  const std::size_t letters = length_in_characters(password);
  if (letters < kMinPasswordLetters) return fmt::format("a password has {} letters at least", kMinPasswordLetters);
  if (letters > kMaxPasswordLetters) return fmt::format("a password has {} letters at most", kMaxPasswordLetters);
  return is_plain_text(password) ? "" : "a password is UTF-8, without control characters: a browser sends no other";
}

/// The file that the rig names. One that does not exist yet has nobody.
struct AccountsOfRig {
  std::filesystem::path file;
  Accounts accounts;
};
Checked<AccountsOfRig> accounts_of(const std::filesystem::path& rig_file) {
  const auto rig = load_rig(rig_file, PaintedPoints::left_out);
  if (!rig) return tl::unexpected(rig.error());
  const std::filesystem::path& file = rig->daemon.accounts_file;
  if (file.empty()) {
    return tl::unexpected(std::vector<Problem>{{rig->file.string(), rig->daemon.in_file.line,
                                                rig->daemon.in_file.column, "[daemon] names no file for accounts",
                                                "write accounts = \"accounts.json\" below [daemon]"}});
  }
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return AccountsOfRig{file, {}};
  auto accounts = read_accounts(file);
  if (!accounts) return tl::unexpected(std::move(accounts.error()));
  return AccountsOfRig{file, std::move(*accounts)};
}

/// Writes what `change` makes of the accounts, unless it returns an exit code.
int changed(const AccountArguments& asked, const std::function<std::optional<int>(Accounts&)>& change) {
  if (!asked.name.empty() && !is_account_name(asked.name))
    return refuse_account(fmt::format("\"{}\" is no name here: 1 to 64 letters, digits and . _ - @", asked.name));
  auto of = accounts_of(asked.rig);
  if (!of) return report(of.error());
  if (const auto code = change(of->accounts)) return *code;
  if (const auto written = write_accounts(of->file, of->accounts); !written) return report(written.error());
  return kExitOk;
}

/// Takes the place of the one of that name.
template <class Entry>
void put(std::vector<Entry>& entries, Entry entry) {
  const auto same =
      std::find_if(entries.begin(), entries.end(), [&](const Entry& one) { return one.name == entry.name; });
  if (same != entries.end())
    *same = std::move(entry);
  else
    entries.push_back(std::move(entry));
}

int add_person(const AccountArguments& asked) {
  return changed(asked, [&](Accounts& accounts) -> std::optional<int> {
    const auto password = typed_password("password of " + asked.name);
    if (!password) return refuse_account("there is no password: type one, or send it to standard input");
    if (const std::string why = wrong_password(*password); !why.empty()) return refuse_account(why);
    if (::isatty(STDIN_FILENO) == 1 && typed_password("again") != password)
      return refuse_account("that was another one: nothing is changed");
    const auto hash = password_hash(*password);
    if (!hash) return report(hash.error());
    const bool was_there = accounts.person(asked.name) != nullptr;
    put(accounts.people, Account{asked.name, asked.role, *hash});
    fmt::print("{} may {} from now on{}\n", asked.name, name_of(asked.role),
               was_there ? "; whoever was logged in so is logged out" : "");
    return std::nullopt;
  });
}

int add_token(const AccountArguments& asked) {
  if (!asked.last_day.empty() && !is_day(asked.last_day))
    return refuse_account(fmt::format("--last-day {}: write a day such as 2027-01-31", asked.last_day));
  return changed(asked, [&](Accounts& accounts) -> std::optional<int> {
    const std::string token = random_secret();
    put(accounts.tokens, ScriptToken{asked.name, asked.role, token_hash(token), asked.last_day});
    fmt::print("{}\n", token);
    fmt::print(
        stderr, "script {} may {} with it{}: Authorization: Bearer TOKEN. It is shown this once, and kept nowhere\n",
        asked.name, name_of(asked.role), asked.last_day.empty() ? "" : " until " + asked.last_day + " is over (UTC)");
    return std::nullopt;
  });
}

int remove_account(const AccountArguments& asked) {
  return changed(asked, [&](Accounts& accounts) -> std::optional<int> {
    const auto is_it = [&](const auto& one) { return one.name == asked.name; };
    const auto gone = std::erase_if(accounts.people, is_it) + std::erase_if(accounts.tokens, is_it);
    if (gone == 0) return refuse_account(fmt::format("there is no \"{}\": luxrig accounts RIG list", asked.name));
    fmt::print("{} has no access any more\n", asked.name);
    return std::nullopt;
  });
}

int list_accounts(const AccountArguments& asked) {
  const auto of = accounts_of(asked.rig);
  if (!of) return report(of.error());
  const auto now = static_cast<std::int64_t>(std::time(nullptr));
  for (const Account& one : of->accounts.people) fmt::print("{:<24} {}\n", one.name, name_of(one.role));
  for (const ScriptToken& one : of->accounts.tokens)
    fmt::print("{:<24} {:<10} token{}{}\n", one.name, name_of(one.role),
               one.last_day.empty() ? "" : " until " + one.last_day, has_not_ended(one, now) ? "" : ", ended");
  if (of->accounts.people.empty() && of->accounts.tokens.empty())
    fmt::print("nobody yet: luxrig accounts {} add NAME --role operate\n", asked.rig.string());
  return kExitOk;
}

Action declare_accounts(CLI::App& command) {
  const Asked asked = std::make_shared<AccountArguments>();
  add_rig_option(command, asked->rig);
  command.require_subcommand(1);
  const auto add_role = [&](CLI::App& to) {
    add_choice<Role, Role>(to, "--role", asked->role, "what it may do: read; change the light; change the rig",
                           {{"look", Role::look}, {"operate", Role::operate}, {"configure", Role::configure}});
  };
  auto* add = command.add_subcommand("add", "a person; again: another password or role");
  add->add_option("NAME", asked->name, "to log in with")->required();
  add_role(*add);
  auto* token = command.add_subcommand("token", "a token for a script, shown once");
  token->add_option("NAME", asked->name, "what the script is called")->required();
  add_role(*token);
  token->add_option("--last-day", asked->last_day, "its last day, as 2027-01-31 (else it has no end)");
  auto* remove = command.add_subcommand("remove", "take a person's or a script's access away");
  remove->add_option("NAME", asked->name, "who")->required();
  auto* list = command.add_subcommand("list", "who has access");
  command.footer(
      "Changes the file that `accounts` of [daemon] names; a running daemon follows\n"
      "within seconds. A password is typed, or sent to standard input.");
  return [asked, add, token, list] {
    return *add     ? add_person(*asked)
           : *token ? add_token(*asked)
           : *list  ? list_accounts(*asked)
                    : remove_account(*asked);
  };
}

}  // namespace

const Command kAccountsCommand{"accounts", command_group::kRun,
                               "who else may use the daemon's page, and what they may do", declare_accounts};

}  // namespace luxrig
