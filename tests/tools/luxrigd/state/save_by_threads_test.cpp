#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "tests/tools/luxrigd/state/saved_state.h"
#include "tests/tools/programs/process.h"

namespace luxrig {
namespace {

using testing::files_in;
using testing::Folder;
using testing::state_with;

TEST(SaveAtomicityOfThreads, ManyWritersNeverExposeAHalfWrittenState) {
  constexpr int kThreads = 8, kSaves = 200;
  const Folder folder;
  Journal journal(folder / "");
  ASSERT_TRUE(journal.save_first([](JournalState& state) { state = state_with("old plan"); }));
  std::atomic<bool> reading{true};
  std::atomic<int> damaged{0}, backwards{0}, reads{0}, failed{0};
  std::thread reader([&] {
    double last = 0;
    while (reading) {
      const auto left = Journal(folder / "").load();
      ++reads;
      if (!left.complaints.empty() || !left.state || left.state->by_hand.size() != 1) {
        ++damaged;
        continue;
      }
      if (left.state->by_hand[0].value < last) ++backwards;
      last = left.state->by_hand[0].value;
    }
  });
  std::vector<std::thread> writers;
  for (int t = 0; t < kThreads; ++t)
    writers.emplace_back([&, t] {
      for (int i = 0; i < kSaves; ++i) {
        const auto count = [&](JournalState& state) {
          state.by_hand[0].value += 1;
          state.plan_json = std::string(static_cast<std::size_t>(1 + (t * kSaves + i) % 5000), 'p');
        };
        if (!(i % 2 == 0 ? journal.keep(count) : journal.save_first(count))) ++failed;
      }
    });
  for (std::thread& writer : writers) writer.join();
  reading = false;
  reader.join();
  EXPECT_EQ(damaged, 0);
  EXPECT_EQ(backwards, 0) << "an older state came after a newer one";
  EXPECT_EQ(failed, 0);
  EXPECT_GT(reads, 0);
  const auto left = journal.load();
  ASSERT_TRUE(left.state);
  EXPECT_EQ(left.state->by_hand[0].value, 0.5 + kThreads * kSaves);
  EXPECT_EQ(left.state->by_hand[0].value, journal.state().by_hand[0].value);
  EXPECT_EQ(left.state->plan_json, journal.state().plan_json);
  EXPECT_EQ(files_in(folder / ""), std::set<std::string>{"state.json"});
}

}  // namespace
}  // namespace luxrig
