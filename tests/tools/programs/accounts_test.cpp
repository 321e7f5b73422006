// luxrig accounts: people and scripts of a rig's daemon.

#include <sys/stat.h>

#include "tests/tools/programs/process.h"

namespace luxrig::testing {
namespace {

class AccountsCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::copy(source("tests/rigs/room"), folder / "room", std::filesystem::copy_options::recursive);
    std::string text = text_of(rig_file);
    const std::size_t at = text.find("[daemon]\n");
    ASSERT_NE(at, std::string::npos);
    without = text;
    text.insert(at + 9, "accounts = \"accounts.json\"\n");
    std::ofstream(rig_file) << text;
  }
  /// Through a shell, which gives the password to standard input.
  Ran say(const std::string& words, const std::string& typed = "") {
    return luxrig::testing::run({"/bin/sh", "-c",
                                 "printf '%s' '" + typed + "' | '" + program("luxrig") + "' accounts '" +
                                     (folder / "room").string() + "' " + words});
  }
  const Folder folder;
  const std::filesystem::path rig_file = folder / "room" / "rig.toml", file = folder / "room" / "accounts.json";
  std::string without;
};

TEST_F(AccountsCommand, AddsListsAndRemovesAndKeepsNoSecret) {
  EXPECT_NE(say("list").output.find("nobody yet"), std::string::npos);
  const Ran added = say("add anna --role operate", "correct horse\n");
  ASSERT_EQ(added.code, 0) << added.output;
  EXPECT_NE(added.output.find("anna may operate"), std::string::npos) << added.output;
  const Ran token = say("token ci --role look --last-day 2027-01-31 2>/dev/null");
  ASSERT_EQ(token.code, 0) << token.output;
  ASSERT_EQ(token.output.size(), 65u) << token.output;
  const std::string text = text_of(file);
  EXPECT_NE(text.find("$argon2id$"), std::string::npos) << text;
  EXPECT_EQ(text.find("correct horse"), std::string::npos);
  EXPECT_EQ(text.find(token.output.substr(0, 64)), std::string::npos);
  struct stat about {};
  ASSERT_EQ(::stat(file.c_str(), &about), 0);
  EXPECT_EQ(about.st_mode & 0777u, 0600u);
  const std::string list = say("list").output;
  EXPECT_NE(list.find("anna                     operate"), std::string::npos) << list;
  EXPECT_NE(list.find("look       token until 2027-01-31"), std::string::npos) << list;
  EXPECT_EQ(say("remove anna").code, 0);
  EXPECT_EQ(say("list").output.find("anna"), std::string::npos);
  EXPECT_EQ(say("remove anna").code, 2);
}

TEST_F(AccountsCommand, RefusesInWordsAndChangesNothing) {
  const auto refuses = [&](const std::string& words, const std::string& typed, const std::string& with) {
    const Ran ran = say(words, typed);
    EXPECT_EQ(ran.code, 2) << words;
    EXPECT_NE(ran.output.find(with), std::string::npos) << ran.output;
    EXPECT_FALSE(std::filesystem::exists(file)) << words;
  };
  refuses("add anna", "short\n", "8 letters at least");
  refuses("add anna", "", "there is no password");
  refuses("add 'an na'", "correct horse\n", "is no name here");
  refuses("add anna --role boss", "correct horse\n", "there is no \"boss\"");
  refuses("token ci --last-day 2027-02-30", "", "write a day such as 2027-01-31");
  ASSERT_EQ(say("add anna", "correct horse\n").code, 0);
  ASSERT_EQ(::chmod(file.c_str(), 0644), 0);
  const Ran open = say("list");
  EXPECT_EQ(open.code, 2);
  EXPECT_NE(open.output.find("others may read or change it: chmod 600 it"), std::string::npos) << open.output;
  std::ofstream(rig_file) << without;
  EXPECT_NE(say("list").output.find("write accounts = \"accounts.json\" below [daemon]"), std::string::npos);
}

}  // namespace
}  // namespace luxrig::testing
