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
