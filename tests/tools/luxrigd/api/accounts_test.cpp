#include "tools/luxrigd/api/accounts.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "tests/core/rig/listed_problems.h"

namespace luxrig {
namespace {

std::string refused_for(const std::string& text) {
  const auto read = accounts_from_json(text, "accounts.json");
  return read ? "" : test::listed(read.error());
}

constexpr std::int64_t kLastSecondOfJanuary2027 = 1801439999;

TEST(Accounts, AnAccountIsWrittenAndReadAgainAndHasNoPasswordInIt) {
  const auto hash = password_hash("correct horse");
  ASSERT_TRUE(hash);
  EXPECT_EQ(hash->rfind("$argon2id$v=19$m=65536,t=2,p=1$", 0), 0u) << *hash;
  const Accounts accounts{{{"anna", Role::operate, *hash}}, {{"ci", Role::look, token_hash("t"), "2027-01-31"}}};
  const std::string text = to_json(accounts);
  EXPECT_EQ(text.find("correct horse"), std::string::npos);
  const auto read = accounts_from_json(text, "accounts.json");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->people, accounts.people);
  EXPECT_EQ(read->tokens, accounts.tokens);
  ASSERT_NE(read->person("anna"), nullptr);
  EXPECT_EQ(read->person("otto"), nullptr);
}

TEST(Accounts, OnlyTheRightPasswordFitsAndNobodysHashFitsNone) {
  const auto hash = password_hash("correct horse");
  ASSERT_TRUE(hash);
  EXPECT_TRUE(password_fits("correct horse", *hash));
  for (const char* wrong : {"", "correct horsE", "correct horse "}) EXPECT_FALSE(password_fits(wrong, *hash)) << wrong;
  EXPECT_FALSE(password_fits("", ""));
  EXPECT_FALSE(password_fits("correct horse", ""));
  EXPECT_NE(*password_hash("correct horse"), *hash) << "no salt";
}

TEST(Accounts, ATokenIsKnownByItsHashUntilItsLastDayIsOver) {
  const std::string token = random_secret();
  EXPECT_EQ(token.size(), 64u);
  const Accounts accounts{{},
                          {{"ci", Role::operate, token_hash(token), "2027-01-31"}, {"x", Role::look, token_hash("x")}}};
  const auto found = token_of(accounts, token, kLastSecondOfJanuary2027);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->name, "ci");
  EXPECT_FALSE(token_of(accounts, token, kLastSecondOfJanuary2027 + 1)) << "its last day is over";
  EXPECT_TRUE(token_of(accounts, "x", kLastSecondOfJanuary2027 + 1)) << "it has no end";
  EXPECT_FALSE(token_of(accounts, token_hash(token), kLastSecondOfJanuary2027)) << "the hash is no token";
  EXPECT_FALSE(token_of(accounts, "", kLastSecondOfJanuary2027));
}

TEST(Accounts, WhatLuxrigDoesNotWriteIsRefusedInWords) {
  const std::string hash = *password_hash("correct horse");
  EXPECT_NE(refused_for("[]").find("is no JSON object"), std::string::npos);
  EXPECT_NE(refused_for("{").find("is no JSON object"), std::string::npos);
  EXPECT_NE(refused_for(R"({"users":[]})").find("unknown key"), std::string::npos);
  EXPECT_NE(refused_for(R"({"people":{}})").find("is no list"), std::string::npos);
  EXPECT_NE(refused_for(R"({"people":[7]})").find("people 1 is no object"), std::string::npos);
  const auto person = [&](const std::string& name, const std::string& role, const std::string& password) {
    return R"({"name":")" + name + R"(","role":")" + role + R"(","password":")" + password + "\"}";
  };
  const std::string anna = person("anna", "look", hash);
  EXPECT_EQ(refused_for("{\"people\":[" + anna + "]}"), "");
  EXPECT_NE(refused_for("{\"people\":[" + anna + "," + anna + "]}").find("has the name of another"), std::string::npos);
  EXPECT_NE(refused_for("{\"people\":[" + person("a b", "look", hash) + "]}").find("has no name"), std::string::npos);
  EXPECT_NE(refused_for("{\"people\":[" + person("a", "anybody", hash) + "]}").find("has no role"), std::string::npos);
  for (const char* bad :
       {"secret", "", "$argon2id$v=19$m=4194304,t=2,p=1$AAAA$AAAA", "$argon2i$v=19$m=65536,t=2,p=1$A$A"})
    EXPECT_NE(refused_for("{\"people\":[" + person("a", "look", bad) + "]}").find("no hash of a password"),
              std::string::npos)
        << bad;
  EXPECT_NE(refused_for(R"({"tokens":[{"name":"ci","role":"look","hash":"12"}]})").find("no hash of a token"),
            std::string::npos);
}

TEST(Accounts, ADayIsOneOfTheCalendar) {
  for (const char* day : {"2027-01-31", "2028-02-29", "2027-12-01"}) EXPECT_TRUE(is_day(day)) << day;
  for (const char* no :
       {"", "2027-1-31", "2027-02-29", "2027-13-01", "2027-00-01", "2027-01-00", "31.01.2027", "2027-01-31 "})
    EXPECT_FALSE(is_day(no)) << no;
}

TEST(Accounts, TheFileIsForItsOwnerAlone) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "luxrig_accounts";
  std::filesystem::create_directories(folder);
  const auto file = folder / "accounts.json";
  ASSERT_TRUE(write_accounts(file, {}));
  struct stat about {};
  ASSERT_EQ(::stat(file.c_str(), &about), 0);
  EXPECT_EQ(about.st_mode & 0777u, 0600u);
  EXPECT_TRUE(read_accounts(file));
  for (const mode_t mode : {0640u, 0604u, 0620u}) {
    ASSERT_EQ(::chmod(file.c_str(), mode), 0);
    const auto read = read_accounts(file);
    ASSERT_FALSE(read);
    EXPECT_NE(read.error().front().text().find("others may read or change it: chmod 600"), std::string::npos)
        << read.error().front().text();
  }
  std::filesystem::remove(file);
  std::filesystem::create_directory(file);
  EXPECT_FALSE(read_accounts(file)) << "a folder";
  std::filesystem::remove(file);
  ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);
  EXPECT_FALSE(read_accounts(file)) << "a pipe, which nobody writes to";
  std::filesystem::remove_all(folder);
  EXPECT_FALSE(read_accounts(file));
}

}  // namespace
}  // namespace luxrig
