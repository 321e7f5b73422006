#include "tools/luxrigd/state/change_log.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

namespace luxrig {
namespace {

using nlohmann::json;

class ChangeLogTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }
  [[nodiscard]] std::vector<std::string> lines(const char* name = "changes.jsonl") const {
    std::ifstream in(folder / name);
    std::vector<std::string> out;
    for (std::string line; std::getline(in, line);) out.push_back(line);
    return out;
  }
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "luxrig_change_log";
};

TEST_F(ChangeLogTest, EachChangeIsALineAndTheNextDaemonKnowsThem) {
  {
    ChangeLog log(folder);
    log.add({{"who", "anna"}});
    log.add({{"who", "otto\n\xff"}});
    log.flush();
    EXPECT_EQ(lines().size(), 2u);
    log.add({{"who", "ida"}});
  }
  ASSERT_EQ(lines().size(), 3u) << "the last is written at the end";
  EXPECT_EQ(json::parse(lines()[0])["who"], "anna");
  EXPECT_EQ(json::parse(lines()[0])["at"].get<std::string>().size(), sizeof("2026-11-30T19:00:00Z") - 1);
  struct stat about {};
  ASSERT_EQ(::stat((folder / "changes.jsonl").c_str(), &about), 0);
  EXPECT_EQ(about.st_mode & 0777u, 0600u);
  std::ofstream(folder / "changes.jsonl", std::ios::app) << "{\"who\":\"cut sho";
  ChangeLog next(folder);
  next.add({{"who", "eve"}});
  next.flush();
  const json newest = json::parse(next.newest());
  ASSERT_EQ(newest.size(), 4u);
  EXPECT_EQ(newest[2]["who"], "ida");
  EXPECT_EQ(newest[3]["who"], "eve");
  EXPECT_EQ(json::parse(lines().back())["who"], "eve") << "on a line of its own";
}

TEST_F(ChangeLogTest, OldLinesGoToASecondFileAndThenAway) {
  {
    ChangeLog log(folder, 1000);
    for (int i = 0; i < 100; ++i) {
      log.add({{"n", i}});
      log.flush();
    }
  }
  EXPECT_LE(std::filesystem::file_size(folder / "changes.jsonl"), 1000u);
  EXPECT_LE(std::filesystem::file_size(folder / "changes.1.jsonl"), 1000u);
  const auto newer = lines(), older = lines("changes.1.jsonl");
  EXPECT_EQ(json::parse(newer.back())["n"], 99);
  EXPECT_EQ(json::parse(older.back())["n"].get<int>() + 1, json::parse(newer.front())["n"].get<int>());
}

TEST_F(ChangeLogTest, AFolderThatCannotBeWrittenHoldsNobodyUp) {
  std::filesystem::remove_all(folder);
  std::ofstream(folder) << "a file";
  ChangeLog log(folder);
  for (int i = 0; i < 2000; ++i) log.add({{"n", i}});
  log.flush();
  EXPECT_EQ(json::parse(log.newest()).size(), 200u);
  ChangeLog none(std::nullopt);
  none.add({{"n", 1}});
  EXPECT_EQ(json::parse(none.newest()).size(), 1u);
}

TEST(ChangesBetween, OldAndNewOfWhatDiffers) {
  JournalState before;
  before.by_hand = {{false, "spot-1", 0.5, 0, {}}, {true, "desk", 150, 0, {}}};
  before.plan_json = "{}";
  JournalState after = before;
  EXPECT_TRUE(changes_between(settings_of(before), settings_of(after)).empty());
  after.blackout = true;
  after.by_hand = {{false, "spot-1", 0.25, 0, {}}, {false, "spot-2", 1, 0, {}}};
  after.bypassed = {"meter-1"};
  after.plan_json = "{ }";
  const json changed = changes_between(settings_of(before), settings_of(after));
  EXPECT_EQ(changed["blackout"], json::parse("[false,true]"));
  EXPECT_EQ(changed["held spot-1"], json::parse("[0.5,0.25]"));
  EXPECT_EQ(changed["held spot-2"], json::parse("[null,1.0]"));
  EXPECT_EQ(changed["goals desk"], json::parse("[150.0,null]"));
  EXPECT_EQ(changed["bypassed"], json::parse(R"([[],["meter-1"]])"));
  EXPECT_NE(changed["plan"][0], changed["plan"][1]);
  EXPECT_EQ(changed.size(), 6u);
  EXPECT_TRUE(changes_between(json(), settings_of(after)).empty());
}

}  // namespace
}  // namespace luxrig
