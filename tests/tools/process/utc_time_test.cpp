#include "tools/process/utc_time.h"

#include <gtest/gtest.h>

#include <limits>

namespace luxrig {
namespace {

constexpr std::int64_t kNow_s = 1796105520;  // 2026-12-01T06:12:00Z
constexpr double kNever_h = std::numeric_limits<double>::infinity();

TEST(UtcTime, IsWrittenInUtc) {
  EXPECT_EQ(utc_text(0), "1970-01-01T00:00:00Z");
  EXPECT_EQ(utc_text(951782400), "2000-02-29T00:00:00Z");
  EXPECT_EQ(utc_text(kNow_s), "2026-12-01T06:12:00Z");
}

TEST(UtcTime, HoursAreCountedFromAnInstant) {
  EXPECT_EQ(hours_since(utc_text(kNow_s), kNow_s), 0);
  EXPECT_NEAR(hours_since(utc_text(kNow_s - 5400), kNow_s), 1.5, 1e-12);
  EXPECT_NEAR(hours_since("1970-01-01T00:00:00Z", kNow_s), kNow_s / 3600.0, 1e-6);
}

TEST(UtcTime, WhatIsNoInstantOrYetToComeIsInfinitelyLongAgo) {
  for (const char* text :
       {"", "yesterday", "2026-11-30", "2026-02-31T00:00:00Z", "2026-11-30T06:12:00", "2026-11-30T06:12:00Zulu",
        "2026-13-01T00:00:00Z", "2026-11-30T25:00:00Z", "99999999999999999999-01-01T00:00:00Z"})
    EXPECT_EQ(hours_since(text, kNow_s), kNever_h) << text;
  EXPECT_EQ(hours_since(utc_text(kNow_s + 1), kNow_s), kNever_h);
}

}  // namespace
}  // namespace luxrig
