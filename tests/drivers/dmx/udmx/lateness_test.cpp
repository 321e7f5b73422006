#include "drivers/dmx/udmx/lateness.h"

#include <gtest/gtest.h>

namespace luxrig::udmx {
namespace {

using std::chrono::milliseconds;

/// Cycles of 20 ms, each with a new request.
struct Fade {
  Lateness lateness;
  Time now = Time{} + std::chrono::seconds(3);
  /// One transfer per cycle, ended by the next.
  void cycles(int count, bool good) {
    for (int i = 0; i < count; ++i) {
      lateness.step(now, false);
      lateness.sent();
      if (good)
        lateness.arrived();
      else
        lateness.went_wrong();
      now += milliseconds(20);
    }
  }
};

TEST(Lateness, OfADeviceThatKeepsUpIsZero) {
  Fade fade;
  fade.cycles(1000, true);
  EXPECT_EQ(fade.lateness.late_for(), Duration{});
  EXPECT_FALSE(fade.lateness.should_be_known());
  EXPECT_EQ(fade.lateness.transfers(), 250u) << "of 5 s";
}

TEST(Lateness, OfRefusalsRepairedByTheNextTransferIsZero) {
  Fade fade;
  for (int i = 0; i < 300; ++i) {
    fade.cycles(1, true);
    fade.cycles(3, false);
  }
  EXPECT_FALSE(fade.lateness.should_be_known());
  EXPECT_NEAR(fade.lateness.failures(), 187, 3);
}

TEST(Lateness, IsKnownThreeQuartersOfASecondAfterTheLastArrived) {
  Fade fade;
  fade.cycles(50, true);
  fade.cycles(37, false);  // 0.74 s, 0.15 s of them allowed
  EXPECT_FALSE(fade.lateness.should_be_known());
  fade.cycles(2, false);
  EXPECT_TRUE(fade.lateness.should_be_known());
  fade.cycles(50, true);
  EXPECT_TRUE(fade.lateness.should_be_known()) << "not in time for long enough";
  fade.cycles(2, true);
  EXPECT_FALSE(fade.lateness.should_be_known());
}

TEST(Lateness, AddsUpOverTheWindow) {
  Fade fade;
  fade.cycles(50, true);
  fade.cycles(20, false);  // late for 0.25 s
  fade.cycles(60, true);
  fade.cycles(20, false);
  EXPECT_FALSE(fade.lateness.should_be_known());
  fade.cycles(60, true);
  fade.cycles(20, false);
  EXPECT_TRUE(fade.lateness.should_be_known());
  fade.cycles(255, true);
  EXPECT_EQ(fade.lateness.late_for(), Duration{});
  fade.cycles(20, false);
  fade.cycles(200, true);
  fade.cycles(20, false);
  fade.cycles(200, true);
  fade.cycles(20, false);
  EXPECT_FALSE(fade.lateness.should_be_known()) << "now and then";
}

TEST(Lateness, IgnoresDelaysOfTheCaller) {
  Fade fade;
  for (int i = 0; i < 20; ++i) {
    fade.cycles(5, true);
    fade.now += milliseconds(900);  // no calls
  }
  EXPECT_EQ(fade.lateness.late_for(), Duration{});
  EXPECT_FALSE(fade.lateness.should_be_known());
}

TEST(Lateness, IsZeroWithoutNewLevels) {
  Lateness lateness;
  Time now{};
  for (int i = 0; i < 1000; ++i) lateness.step(now += milliseconds(20), true);
  EXPECT_FALSE(lateness.should_be_known());
  for (int i = 0; i < 40; ++i) lateness.step(now += milliseconds(20), false);
  EXPECT_TRUE(lateness.should_be_known());
}

}  // namespace
}  // namespace luxrig::udmx
