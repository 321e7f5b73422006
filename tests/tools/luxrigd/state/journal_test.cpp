#include "tools/luxrigd/state/journal.h"

#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <thread>

#include "tests/tools/programs/process.h"

namespace luxrig {
namespace {

using luxrig::testing::Folder;

Result<void> save(Journal& journal, JournalState wanted) {
  return journal.save_first([&](JournalState& state) { state = std::move(wanted); });
}

TEST(Journal, KeepsTheLatestSave) {
  const Folder folder;
  Journal journal(folder / "new/state");
  EXPECT_FALSE(journal.load().state) << "none was saved yet";
  ASSERT_TRUE(save(journal, {"{\"a\":1}", false, {}}));
  ASSERT_TRUE(save(journal, {"{\"b\":\"ü\\n\"}", true, {"head", "yoke"}}));
  const auto left = journal.load();
  ASSERT_TRUE(left.state);
  EXPECT_TRUE(left.complaints.empty());
  EXPECT_EQ(left.state->plan_json, "{\"b\":\"ü\\n\"}");
  EXPECT_TRUE(left.state->blackout);
  EXPECT_EQ(left.state->parked, (std::vector<std::string>{"head", "yoke"}));
}

TEST(Journal, WithoutAFolderKeepsItsStateInMemory) {
  Journal journal;
  ASSERT_TRUE(journal.keep([](JournalState& state) { state.blackout = true; }));
  EXPECT_TRUE(journal.state().blackout);
  EXPECT_FALSE(journal.load().state);
}

TEST(Journal, KeepsSettingsByHandAndOmitsDamagedEntries) {
  const Folder folder;
  Journal journal(folder / "");
  JournalState state{"p", false, {}};
  state.plan_of_rig = true;
  state.bypassed = {"meter-3", "spot-1"};
  state.by_hand = {{false, "spot-1", 0.05, 1.75e9, std::nullopt}, {true, "desk", 150, 1.75e9, 1.75e9 + 600}};
  ASSERT_TRUE(save(journal, state));
  const auto loaded = journal.load().state;
  ASSERT_TRUE(loaded);
  EXPECT_TRUE(loaded->plan_of_rig);
  EXPECT_EQ(loaded->bypassed, (std::vector<std::string>{"meter-3", "spot-1"}));
  ASSERT_EQ(loaded->by_hand.size(), 2u);
  EXPECT_EQ(loaded->by_hand[0].name, "spot-1");
  EXPECT_EQ(loaded->by_hand[0].value, 0.05);
  EXPECT_FALSE(loaded->by_hand[0].until_unix_s);
  EXPECT_TRUE(loaded->by_hand[1].goal);
  EXPECT_EQ(loaded->by_hand[1].until_unix_s, 1.75e9 + 600);
  std::ofstream(folder / "state.json") << R"({"luxrig_state":1,"plan":"p","blackout":true,"by_hand":[7,{"name":"x"},
            {"goal":false,"name":"y","value":"z","since_unix_s":0},{"goal":false,"name":"y","value":1,"since_unix_s":0}]})";
  const auto damaged = journal.load().state;
  ASSERT_TRUE(damaged);
  ASSERT_EQ(damaged->by_hand.size(), 1u);
  EXPECT_EQ(damaged->by_hand[0].value, 1);
}

TEST(Journal, ReadsFilesOfOlderVersions) {
  const Folder folder;
  std::ofstream(folder / "state.json") << R"({"luxrig_state":1,"plan":"p","blackout":true})";
  const auto left = Journal(folder / "").load();
  ASSERT_TRUE(left.state);
  EXPECT_TRUE(left.state->parked.empty());
  EXPECT_TRUE(left.complaints.empty());
}

// "luxrig_state":"1" used to end every start of the daemon; a truncated file lost a blackout.
TEST(Journal, KeepsTheLegiblePartsOfADamagedFileAndItsBlackout) {
  struct Case {
    const char* text;
    bool blackout;
    const char* plan;
  };
  for (const Case& one :
       {Case{"", false, ""}, Case{"{", false, ""}, Case{"[]", false, ""}, Case{"{\"luxrig_state\":1}", false, ""},
        Case{"{\"luxrig_state\":\"1\",\"plan\":\"p\",\"blackout\":true}", true, "p"},
        Case{"{\"luxrig_state\":1,\"plan\":7,\"blackout\":true}", true, ""},
        Case{"{\"luxrig_state\":1,\"plan\":\"p\",\"blackout\":\"yes\"}", false, "p"},
        Case{"{\n \"blackout\": true,\n \"by_hand\": [], \"pla", true, ""},
        Case{"\x80\xff\"blackout\" : true", true, ""}, Case{"{\"plan\":\"blackout\"blackout\":true", true, ""}}) {
    const Folder folder;
    std::ofstream(folder / "state.json") << one.text;
    const auto left = Journal(folder / "").load();
    ASSERT_TRUE(left.state) << one.text;
    EXPECT_EQ(left.state->blackout, one.blackout) << one.text;
    EXPECT_EQ(left.state->plan_json, one.plan) << one.text;
    ASSERT_EQ(left.complaints.size(), 1u) << one.text;
    EXPECT_NE(left.complaints[0].find("damaged"), std::string::npos) << left.complaints[0];
    EXPECT_EQ(luxrig::testing::text_of(folder / "state.json.damaged"), one.text) << "kept for a person";
    // The daemon may be killed before it has saved the legible part.
    EXPECT_EQ(Journal(folder / "").load().state->blackout, one.blackout) << one.text;
  }
}

TEST(Journal, AHalfWrittenStateNeverReplacesTheOldOne) {
  const Folder folder;
  Journal journal(folder / "");
  ASSERT_TRUE(save(journal, {"old", false, {}}));
  // A power cut in the middle of a save leaves this.
  std::ofstream(folder / "state.json.new") << "{\"luxrig_state\":1,\"pl";
  ASSERT_TRUE(journal.load().state);
  EXPECT_EQ(journal.load().state->plan_json, "old");
  ASSERT_TRUE(save(journal, {"new", false, {}}));
  EXPECT_EQ(journal.load().state->plan_json, "new");
}

// A plan that was refused because of a full disk used to be on disk after the next save.
TEST(Journal, NeverSavesARefusedChangeAndSavesADoneOneNextTime) {
  const Folder folder;
  std::ofstream(folder / "state") << "a file stands in the way";
  Journal journal(folder / "state");
  EXPECT_FALSE(save(journal, {"refused", false, {}}));
  EXPECT_TRUE(journal.state().plan_json.empty());
  EXPECT_FALSE(journal.unsaved()) << "nothing that holds is missing on disk";
  EXPECT_FALSE(journal.keep([](JournalState& state) { state.blackout = true; }));
  EXPECT_TRUE(journal.state().blackout);
  EXPECT_TRUE(journal.unsaved());
  std::filesystem::remove(folder / "state");
  ASSERT_TRUE(journal.keep([](JournalState& state) { state.parked = {"yoke"}; }));
  EXPECT_FALSE(journal.unsaved());
  const auto left = journal.load();
  ASSERT_TRUE(left.state);
  EXPECT_TRUE(left.state->blackout);
  EXPECT_TRUE(left.state->plan_json.empty());
}

// Saves of several threads used to share one temporary file: 149 of 240 failed, and disk and memory differed.
TEST(Journal, SerialisesSavesOfSeveralThreads) {
  const Folder folder;
  Journal journal(folder / "");
  std::atomic<bool> reading{true};
  std::atomic<int> damaged{0};
  std::thread reader([&] {
    while (reading)
      if (!journal.load().complaints.empty()) ++damaged;
  });
  std::vector<std::thread> writers;
  std::atomic<int> failed{0};
  for (int t = 0; t < 4; ++t)
    writers.emplace_back([&, t] {
      for (int i = 0; i < 25; ++i) {
        const auto add = [&](JournalState& state) { state.parked.push_back(std::to_string(100 * t + i)); };
        if (!(i % 2 == 0 ? journal.keep(add) : journal.save_first(add))) ++failed;
      }
    });
  for (std::thread& writer : writers) writer.join();
  reading = false;
  reader.join();
  EXPECT_EQ(failed, 0);
  EXPECT_EQ(damaged, 0);
  ASSERT_TRUE(journal.load().state);
  EXPECT_EQ(journal.load().state->parked, journal.state().parked);
  EXPECT_EQ(journal.state().parked.size(), 100u);
}

}  // namespace
}  // namespace luxrig
