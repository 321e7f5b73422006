#include "tools/luxrigd/journal.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/tools/programs/process.h"

namespace luxrig {
namespace {

using luxrig::testing::Folder;

TEST(Journal, KeepsWhatWasSavedLast) {
  const Folder folder;
  const Journal journal(folder / "new/state");
  ASSERT_TRUE(journal.load());
  EXPECT_FALSE(journal.load()->has_value()) << "none was saved yet";
  ASSERT_TRUE(journal.save({"{\"a\":1}", false, {}}));
  ASSERT_TRUE(journal.save({"{\"b\":\"ü\\n\"}", true, {"head", "yoke"}}));
  const auto state = journal.load();
  ASSERT_TRUE(state && *state);
  EXPECT_EQ((*state)->plan_json, "{\"b\":\"ü\\n\"}");
  EXPECT_TRUE((*state)->blackout);
  EXPECT_EQ((*state)->parked, (std::vector<std::string>{"head", "yoke"}));
}

TEST(Journal, KeepsWhatIsSetByHandAndLeavesOutWhatIsDamaged) {
  const Folder folder;
  const Journal journal(folder / "");
  JournalState state{"p", false, {}};
  state.plan_of_rig = true;
  state.by_hand = {{false, "spot-1", 0.05, 1.75e9, std::nullopt}, {true, "desk", 150, 1.75e9, 1.75e9 + 600}};
  ASSERT_TRUE(journal.save(state));
  const auto loaded = journal.load();
  ASSERT_TRUE(loaded && *loaded);
  EXPECT_TRUE((*loaded)->plan_of_rig);
  ASSERT_EQ((*loaded)->by_hand.size(), 2u);
  EXPECT_EQ((*loaded)->by_hand[0].name, "spot-1");
  EXPECT_EQ((*loaded)->by_hand[0].value, 0.05);
  EXPECT_FALSE((*loaded)->by_hand[0].until_unix_s);
  EXPECT_TRUE((*loaded)->by_hand[1].goal);
  EXPECT_EQ((*loaded)->by_hand[1].until_unix_s, 1.75e9 + 600);
  std::ofstream(folder / "state.json") << R"({"luxrig_state":1,"plan":"p","blackout":true,"by_hand":[7,{"name":"x"},
            {"goal":false,"name":"y","value":"z","since_unix_s":0},{"goal":false,"name":"y","value":1,"since_unix_s":0}]})";
  const auto damaged = journal.load();
  ASSERT_TRUE(damaged && *damaged);
  ASSERT_EQ((*damaged)->by_hand.size(), 1u);
  EXPECT_EQ((*damaged)->by_hand[0].value, 1);
}

TEST(Journal, ReadsWhatAnOlderVersionWrote) {
  const Folder folder;
  std::ofstream(folder / "state.json") << R"({"luxrig_state":1,"plan":"p","blackout":true})";
  const auto state = Journal(folder / "").load();
  ASSERT_TRUE(state && *state);
  EXPECT_TRUE((*state)->parked.empty());
}

TEST(Journal, RefusesADamagedFileAndLeavesItAsItIs) {
  const Folder folder;
  for (const char* text :
       {"", "{", "[]", "{\"luxrig_state\":1}", "{\"luxrig_state\":1,\"plan\":7,\"blackout\":false}"}) {
    std::ofstream(folder / "state.json") << text;
    const auto state = Journal(folder / "").load();
    ASSERT_FALSE(state) << text;
    EXPECT_FALSE(state.error().front().mend.empty());
    EXPECT_EQ(luxrig::testing::text_of(folder / "state.json"), text);
  }
}

TEST(Journal, HalfWrittenStateNeverReplacesTheOldOne) {
  const Folder folder;
  const Journal journal(folder / "");
  ASSERT_TRUE(journal.save({"old", false, {}}));
  // What a power cut in the middle of a save leaves behind.
  std::ofstream(folder / "state.json.new") << "{\"luxrig_state\":1,\"pl";
  const auto state = journal.load();
  ASSERT_TRUE(state && *state);
  EXPECT_EQ((*state)->plan_json, "old");
  ASSERT_TRUE(journal.save({"new", false, {}}));
  EXPECT_EQ((*journal.load())->plan_json, "new");
}

}  // namespace
}  // namespace luxrig
