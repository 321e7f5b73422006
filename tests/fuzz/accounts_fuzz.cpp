// Any bytes as a file of accounts: never a throw, nothing is taken that luxrig would not write, and what is taken is
// written and read back the same.
#include <cstdint>
#include <string>

#include "core/check.h"
#include "tools/luxrigd/api/accounts.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto read = luxrig::accounts_from_json(text, "accounts.json");
  if (!read) {
    LUXRIG_CHECK(!read.error().empty(), "refused without a reason");
    for (const luxrig::Problem& one : read.error()) LUXRIG_CHECK(!one.what.empty() && !one.mend.empty(), "no words");
    return 0;
  }
  for (const luxrig::Account& one : read->people) {
    LUXRIG_CHECK(luxrig::is_account_name(one.name), "name {}", one.name);
    LUXRIG_CHECK(one.role >= luxrig::Role::look && one.role <= luxrig::Role::configure, "role of {}", one.name);
    LUXRIG_CHECK(one.password_hash.size() < 128, "hash of {}", one.name);  // its figures are those of "interactive"
  }
  for (const luxrig::ScriptToken& one : read->tokens) {
    LUXRIG_CHECK(luxrig::is_account_name(one.name) && one.hash.size() == 64, "token {}", one.name);
    (void)luxrig::has_not_ended(one, 1'800'000'000);
  }
  const std::string written = luxrig::to_json(*read);
  const auto again = luxrig::accounts_from_json(written, "accounts.json");
  LUXRIG_CHECK(again && again->people == read->people && again->tokens == read->tokens, "not the same: {}", written);
  return 0;
}
