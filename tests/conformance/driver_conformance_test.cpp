/// What every driver must show. The suite walks the registry and the sources of cameras, so a new driver is tested
/// without a new test here. subject.h defines the questions and the peers.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>

#include "tests/conformance/subject.h"

namespace luxrig {
namespace {

using std::chrono::milliseconds;

/// How long a busy test machine may hold up a thread. No driver can state a bound for that.
constexpr Duration kBusyMachine = milliseconds(250);
/// Cycles in which heads on axes, the slowest devices, have homed and travelled.
constexpr int kMaxCycles = 600;

std::size_t entries_in(const char* folder) {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder)) ++count;
  return count;
}

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = [] {
    std::vector<Kind> kinds = bus_kinds();
    for (Kind& camera : camera_kinds()) kinds.push_back(std::move(camera));
    return kinds;
  }();
  return all;
}

/// Runs cycles until all is well. On a busy machine, a driver that waits in real time may give up once on the way.
bool reaches(Subject& subject, double drive) {
  subject.settle(drive);
  const auto there = [&] { return subject.at(drive) && subject.bus().life == Life::active; };
  for (int i = 0; i < kMaxCycles && !there(); ++i) subject.cycle(drive);
  return there();
}

class EveryDriver : public ::testing::TestWithParam<std::size_t> {
 protected:
  const Kind& kind() const { return kinds()[GetParam()]; }
  std::unique_ptr<Subject> activated() const {
    auto subject = kind().connected();
    EXPECT_TRUE(subject->driver->activate(subject->now));
    return subject;
  }
};

TEST_P(EveryDriver, ConstructsWithoutTouchingADeviceOrLeakingThreadsAndDescriptors) {
  const Time start = Time{} + std::chrono::seconds(1);
  const auto at = [&](int ms) { return start + milliseconds(ms); };
  const std::size_t descriptors = entries_in("/proc/self/fd"), threads = entries_in("/proc/self/task");
  {
    const auto driver = kind().alone();
    EXPECT_EQ(entries_in("/proc/self/fd"), descriptors);
    EXPECT_EQ(driver->health(start).at(0).life, Life::configured);
  }
  for (const bool destroy_while_active : {false, true}) {
    auto driver = kind().alone();
    driver->deactivate(at(0));
    EXPECT_TRUE(driver->activate(at(1)));
    EXPECT_TRUE(driver->activate(at(2)));
    driver->deactivate(at(3));
    driver->deactivate(at(4));
    EXPECT_EQ(driver->health(at(4)).at(0).life, Life::configured);
    EXPECT_EQ(entries_in("/proc/self/fd"), descriptors);
    EXPECT_TRUE(driver->activate(at(5)));
    EXPECT_NE(driver->health(at(5)).at(0).life, Life::configured);
    if (!destroy_while_active) driver->deactivate(at(6));
  }
  EXPECT_EQ(entries_in("/proc/self/fd"), descriptors);
  EXPECT_EQ(entries_in("/proc/self/task"), threads);
}

TEST_P(EveryDriver, StatesWorkableTimeBounds) {
  const auto driver = kind().alone();
  const DriverBounds bounds = driver->bounds();
  const bool is_written = driver->level_output() != nullptr || driver->mover() != nullptr;
  EXPECT_EQ(bounds.write > Duration{}, is_written);
  EXPECT_EQ(bounds.write_period > Duration{}, is_written);
  EXPECT_GT(bounds.fault_after, Duration{});
  EXPECT_EQ(bounds.read_period > Duration{}, driver->lux_reader() != nullptr);
  const bool is_read = driver->lux_reader() != nullptr || driver->picture_taker() != nullptr;
  EXPECT_EQ(bounds.read > Duration{}, is_read);
}

TEST_P(EveryDriver, MovesItsPeerToTheSetpointAndReadsItBack) {
  const auto subject = activated();
  const Time start = subject->now;
  for (const double drive : {0.0, 1.0, 0.37, 0.5, 0.001}) {
    subject->settle(drive);
    EXPECT_TRUE(subject->last) << (subject->last ? "" : subject->last.error().detail);
    EXPECT_TRUE(subject->at(drive)) << drive;
  }
  subject->try_other_capabilities();
  const Health health = subject->bus();
  EXPECT_EQ(health.life, Life::active);
  EXPECT_GT(health.sent, 0u);
  EXPECT_GT(health.last_ok, start);
  EXPECT_LE(health.errors, subject->answers_held_up()) << health.detail;
}

TEST_P(EveryDriver, RefusesImpossibleSetpointsAndSendsNothing) {
  const auto subject = activated();
  const std::uint64_t sent = subject->bus().sent;
  EXPECT_EQ(subject->bad_requests_taken(), std::vector<std::string>{});
  EXPECT_EQ(subject->bus().sent, sent);
}

TEST_P(EveryDriver, ReturnsWithinItsBoundUnderEveryPeerFault) {
  for (const sim::FaultKind fault : {sim::FaultKind::silent, sim::FaultKind::slow, sim::FaultKind::garbled,
                                     sim::FaultKind::lost, sim::FaultKind::dead}) {
    // A driver that waits too long does so every time; a busy machine does so only for a moment.
    Duration min_over_bound = Duration::max();
    for (int attempt = 0; attempt < 3 && min_over_bound > kBusyMachine; ++attempt) {
      const auto subject = activated();
      subject->cycle(0.2);
      subject->set_fault(fault);
      for (int i = 0; i < 10; ++i) subject->cycle(0.2 + 0.01 * i);
      min_over_bound = std::min(min_over_bound, subject->worst_over_bound);
    }
    EXPECT_LE(min_over_bound, kBusyMachine) << name_of(fault);
  }
}

TEST_P(EveryDriver, FaultsInTimeWhenItsPeerGoesAndRecoversWithTheCurrentSetpoint) {
  const auto subject = activated();
  if (!subject->bounds.notices_loss) GTEST_SKIP() << "declares that it cannot notice";
  subject->settle(0.25, 10);
  ASSERT_TRUE(subject->at(0.25));

  subject->set_fault(sim::FaultKind::dead);
  const Time gone = subject->now;
  while (subject->bus().life == Life::active && subject->now < gone + std::chrono::minutes(1)) subject->cycle(0.25);
  EXPECT_LE(subject->now - gone, subject->bounds.fault_after + subject->period());
  EXPECT_EQ(subject->bus().life, Life::faulted);
  EXPECT_NE(subject->bus().detail, "");
  EXPECT_GE(subject->bus().since, gone);
  EXPECT_GT(subject->bus().errors, 0u);
  EXPECT_FALSE(subject->last);

  for (int i = 0; i < 20; ++i) subject->cycle(0.95);  // must never reach a device
  subject->clear_faults();
  const Time back = subject->now;
  while (subject->bus().life != Life::active && subject->now < back + std::chrono::minutes(1)) {
    subject->cycle(0.75);
    EXPECT_TRUE(subject->at_either(0.25, 0.75));
  }
  EXPECT_LE(subject->now - back, std::chrono::seconds(4));
  for (int i = 0; i < kMaxCycles && !subject->at(0.75); ++i) {
    subject->cycle(0.75);
    EXPECT_TRUE(subject->at_either(0.25, 0.75));
  }
  for (int i = 0; i < 3; ++i) subject->cycle(0.75);
  EXPECT_TRUE(subject->at(0.75)) << (subject->last ? "" : subject->last.error().detail);
  EXPECT_EQ(subject->bus().detail, "");
}

TEST_P(EveryDriver, StartsWithoutItsPeerAndFindsItByItself) {
  const auto subject = kind().connected();
  if (!subject->bounds.notices_loss) GTEST_SKIP() << "declares that it cannot notice";
  subject->set_fault(sim::FaultKind::dead);
  EXPECT_TRUE(subject->driver->activate(subject->now)) << "an absent peer is no error";
  for (int i = 0; i < 20 || (subject->bus().life == Life::active && i < 200); ++i) subject->cycle(0.25);
  EXPECT_EQ(subject->bus().life, Life::faulted);
  EXPECT_NE(subject->bus().detail, "");
  subject->clear_faults();
  EXPECT_TRUE(reaches(*subject, 0.5)) << subject->bus().detail;
}

TEST_P(EveryDriver, ResumesAfterGarbledAnswers) {
  const auto subject = activated();
  subject->settle(0.25, 1);
  subject->set_fault(sim::FaultKind::garbled);
  for (int i = 0; i < 60; ++i) subject->cycle(0.25);
  subject->clear_faults();
  EXPECT_TRUE(reaches(*subject, 0.5)) << subject->bus().detail;
}

TEST_P(EveryDriver, LeavesTheAgreedStateWhenItStopsAndRestarts) {
  const auto subject = activated();
  for (const double drive : {0.5, 0.25}) {
    ASSERT_TRUE(reaches(*subject, drive)) << subject->bus().detail;
    subject->driver->deactivate(subject->now);
    EXPECT_EQ(subject->bus().life, Life::configured);
    EXPECT_TRUE(subject->left_as_agreed(drive));
    const auto refused = subject->call(0.9);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().cause, Cause::inactive);
    EXPECT_TRUE(subject->driver->activate(subject->now));
  }
  EXPECT_TRUE(reaches(*subject, 0.75)) << subject->bus().detail;
}

TEST_P(EveryDriver, KeepsTwoInstancesIndependent) {
  const auto one = activated(), other = activated();
  for (int i = 0; i < kMaxCycles && !(i >= 8 && one->at(0.25) && other->at(0.75)); ++i) {
    one->cycle(0.25);
    other->cycle(0.75);
  }
  EXPECT_TRUE(one->at(0.25));
  EXPECT_TRUE(other->at(0.75));
  one->set_fault(sim::FaultKind::dead);
  for (int i = 0; i < 20; ++i) {
    one->cycle(0.25);
    other->cycle(0.75);
  }
  EXPECT_TRUE(reaches(*other, 0.75)) << other->bus().detail;
}

TEST_P(EveryDriver, KeepsToItsRateAndSendsKeepAlives) {
  if (!kind().sends_by_itself) GTEST_SKIP() << "is asked, and does nothing by itself";
  const auto subject = activated();
  subject->settle(0, 1);
  const std::uint64_t before = subject->bus().sent;
  const Time start = subject->now;
  const auto wall = std::chrono::steady_clock::now();  // the far end answers by this clock
  for (int step = 0; step < 1000; ++step) {
    subject->now = start + step * milliseconds(1);
    std::this_thread::sleep_until(wall + step * milliseconds(1));
    // If a busy machine holds up the far end for longer than a timeout, one request is missed. That is no failure.
    if (!subject->call(step / 1000.0)) {
      ASSERT_NE(subject->bus().life, Life::faulted) << subject->bus().detail;
    }
  }
  const double cycles = 1.0 / to_seconds(subject->bounds.write_period);
  EXPECT_LE(static_cast<double>(subject->bus().sent - before), 2 * cycles * subject->outputs() + 2);

  Time last = subject->now;
  std::uint64_t sent = subject->bus().sent;
  Duration longest{};
  const Time end = subject->now + std::chrono::seconds(5);
  while (subject->now < end) {
    subject->cycle(0.5);
    if (subject->bus().sent == sent) continue;
    longest = std::max(longest, subject->now - last);
    sent = subject->bus().sent;
    last = subject->now;
  }
  EXPECT_LE(std::max(longest, end - last), std::chrono::milliseconds(1050));
}

TEST_P(EveryDriver, SendsTheSameBytesForTheSameInputsUnderASteppedClock) {
  const auto first = kind().record(), second = kind().record();
  EXPECT_FALSE(first.empty());
  EXPECT_EQ(first, second);
}

TEST_P(EveryDriver, RefusesAnUnknownOptionAndNamesTheNearest) {
  std::string known;
  const auto problems = kind().problems_of_misspelt_option(known);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].line, 33);
  EXPECT_EQ(problems[0].column, kind().option_column);
  EXPECT_NE(problems[0].mend.find(known), std::string::npos) << problems[0].text();
}

TEST_P(EveryDriver, DoesNothingWhileInactive) {
  const auto subject = kind().connected();
  const auto refused = subject->call(1.0);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().cause, Cause::inactive);
  if (subject->driver->lux_reader() != nullptr) {
    EXPECT_EQ(subject->driver->lux_reader()->read(subject->now).error().cause, Cause::inactive);
  }
  EXPECT_EQ(subject->bus().sent, 0u);
  EXPECT_TRUE(subject->untouched());
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryDriver, ::testing::Range(std::size_t{0}, kinds().size()),
                         [](const auto& which) { return kinds()[which.param].name; });

}  // namespace
}  // namespace luxrig
