// Jobs run one after the other, can be watched and cancelled, and leave their plans behind.
#include "tools/luxrigd/jobs.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <future>

namespace luxrig {
namespace {

constexpr std::chrono::seconds kLong(60);

/// Waits until the job is no longer waiting or running.
Job ended(const Jobs& jobs, const std::string& id) {
  const auto until = std::chrono::steady_clock::now() + kLong;
  while (std::chrono::steady_clock::now() < until) {
    const auto job = jobs.at(id);
    if (!job || (job->state != Job::State::waits && job->state != Job::State::runs)) return job.value_or(Job{});
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ADD_FAILURE() << "the job does not end";
  return {};
}

/// Says that it runs, then works until it is stopped.
Jobs::Work until_stopped(std::promise<void>& runs, const std::string& best = "") {
  return [&runs, best](const Watch& watch) -> Result<std::string> {
    watch.tell({"levels", "error 3 %", false, true});
    runs.set_value();
    while (!watch.stop.stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (best.empty()) return tl::unexpected(Fault{Cause::cancelled, {}, "stopped", {}});
    return best;
  };
}

Jobs::Work plan(const std::string& json) {
  return [json](const Watch&) -> Result<std::string> { return json; };
}

class JobsTest : public ::testing::Test {
 protected:
  JobsTest() { std::filesystem::create_directories(folder); }
  ~JobsTest() override { std::filesystem::remove_all(folder); }
  std::filesystem::path folder = std::filesystem::temp_directory_path() / ("luxrig-jobs-" + std::to_string(::getpid()));
};

TEST_F(JobsTest, OneAtATimeAndEachHasItsResult) {
  Jobs jobs(std::nullopt);
  std::promise<void> runs;
  const auto first = jobs.start("solve", until_stopped(runs));
  ASSERT_TRUE(first);
  ASSERT_EQ(runs.get_future().wait_for(kLong), std::future_status::ready);
  const auto second = jobs.start("solve", plan("{}"));
  const auto third =
      jobs.start("solve", [](const Watch&) -> Result<std::string> { return refusal("no lamp reaches it"); });
  ASSERT_TRUE(second && third);
  EXPECT_EQ(jobs.at(*first)->state, Job::State::runs);
  EXPECT_EQ(jobs.at(*first)->stage, "levels");
  EXPECT_EQ(jobs.at(*first)->doing, "error 3 %");
  EXPECT_TRUE(jobs.at(*first)->can_be_taken);
  EXPECT_EQ(jobs.at(*second)->state, Job::State::waits);
  ASSERT_EQ(jobs.all().size(), 3u);
  EXPECT_EQ(jobs.all()[2].id, *third);
  (void)jobs.cancel(*first);
  EXPECT_EQ(ended(jobs, *first).state, Job::State::cancelled);
  EXPECT_EQ(ended(jobs, *first).plan_json, "");
  EXPECT_EQ(ended(jobs, *second).plan_json, "{}");
  EXPECT_EQ(ended(jobs, *third).state, Job::State::failed);
  EXPECT_EQ(ended(jobs, *third).why, "no lamp reaches it");
  EXPECT_EQ(jobs.cancel(*second)->state, Job::State::done) << "it has ended: it stays as it is";
}

TEST_F(JobsTest, ACancelledJobKeepsItsBestSoFarAndAWaitingOneNeverRuns) {
  Jobs jobs(std::nullopt);
  std::promise<void> runs;
  const auto first = jobs.start("solve", until_stopped(runs, "{\"best\":1}"));
  ASSERT_EQ(runs.get_future().wait_for(kLong), std::future_status::ready);
  std::atomic<bool> ran = false;
  const auto second = jobs.start("solve", [&](const Watch&) -> Result<std::string> {
    ran = true;
    return std::string("{}");
  });
  EXPECT_EQ(jobs.cancel(*second)->state, Job::State::cancelled);
  (void)jobs.cancel(*first);
  EXPECT_EQ(ended(jobs, *first).plan_json, "{\"best\":1}");
  EXPECT_EQ(ended(jobs, *jobs.start("solve", plan("{}"))).state, Job::State::done) << "the queue goes on";
  EXPECT_FALSE(ran);
}

TEST_F(JobsTest, TooManyAreRefusedAndOldOnesForgotten) {
  Jobs jobs(folder);
  std::promise<void> runs;
  const auto first = jobs.start("solve", until_stopped(runs));
  ASSERT_EQ(runs.get_future().wait_for(kLong), std::future_status::ready);
  for (int i = 0; i < 7; ++i) ASSERT_TRUE(jobs.start("solve", plan("{}")));
  EXPECT_FALSE(jobs.start("solve", plan("{}")));
  (void)jobs.cancel(*first);
  (void)ended(jobs, *first);
  std::string last;
  for (int i = 0; i < 30; ++i) {
    const auto id = jobs.start("solve", plan("{}"));
    if (id) last = ended(jobs, *id).id;
  }
  EXPECT_LE(jobs.all().size(), 17u);
  EXPECT_FALSE(jobs.at(*first)) << "forgotten";
  EXPECT_TRUE(jobs.at(last));
  jobs.stop();
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files += entry.is_regular_file() ? 1 : 0;
  EXPECT_LE(files, 17u);
}

TEST_F(JobsTest, AfterARestartJobsAreLostAndPlansAreNot) {
  std::string done, lost;
  {
    Jobs jobs(folder);
    done = *jobs.start("solve", plan("{\"luxrig_plan\":1}"));
    EXPECT_EQ(ended(jobs, done).state, Job::State::done);
    std::promise<void> runs;
    lost = *jobs.start("solve", until_stopped(runs));
    ASSERT_EQ(runs.get_future().wait_for(kLong), std::future_status::ready);
  }  // cancels it, and waits for no more
  const Jobs next(folder);
  EXPECT_EQ(next.at(done)->state, Job::State::done);
  EXPECT_EQ(next.at(done)->plan_json, "{\"luxrig_plan\":1}");
  EXPECT_EQ(next.at(lost)->state, Job::State::lost);
  EXPECT_NE(next.at(lost)->why, "");
  EXPECT_EQ(Jobs(std::nullopt).at(done)->state, Job::State::lost) << "nothing is kept without a folder";
  for (const char* none : {"", "x", "../../etc/passwd", "00000000-00000", "00000000-0000000", "0000000--000000",
                           "00000000-../../", "00000000/000000"})
    EXPECT_FALSE(next.at(none)) << none;
}

TEST_F(JobsTest, StopEndsAllAndTakesNoMore) {
  Jobs jobs(std::nullopt);
  std::promise<void> runs;
  const auto first = jobs.start("solve", until_stopped(runs));
  ASSERT_EQ(runs.get_future().wait_for(kLong), std::future_status::ready);
  jobs.stop();
  EXPECT_EQ(jobs.at(*first)->state, Job::State::cancelled);
  EXPECT_FALSE(jobs.start("solve", plan("{}")));
}

}  // namespace
}  // namespace luxrig
