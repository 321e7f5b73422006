#include "drivers/can/cia402/report_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <tuple>

#include "tests/drivers/test_rig.h"

namespace luxrig {
namespace {

using cia402::ReportCheck;

constexpr std::uint16_t kEnabledWord = 0x0237, kDisabledWord = 0x0250;

/// 45 000 counts/s, 90 000 counts/s², a report every 20 ms.
cia402::AxisSettings settings_of_check() {
  cia402::AxisSettings settings;
  settings.speed = 45000;
  settings.acceleration = 90000;
  return settings;
}

struct Drive {
  ReportCheck check{settings_of_check()};
  int ms = 0;

  bool says(std::uint16_t statusword, std::int32_t position, int mode = 1, int after_ms = 20, bool follow = true) {
    ms += after_ms;
    std::array<std::uint8_t, ReportCheck::kBytes> bytes{static_cast<std::uint8_t>(statusword),
                                                        static_cast<std::uint8_t>(statusword >> 8)};
    for (std::size_t i = 0; i < 4; ++i) bytes[2 + i] = static_cast<std::uint8_t>(position >> (8 * i));
    bytes[6] = static_cast<std::uint8_t>(mode);
    const auto report = check.take(at_ms(ms), bytes, follow);
    if (report) {
      EXPECT_EQ(report->statusword, statusword);
      EXPECT_EQ(report->position, position);
      EXPECT_EQ(report->mode, mode);
    }
    return report.has_value();
  }
  void stands(std::int32_t position, int times = 20) {
    for (int i = 0; i < times; ++i) (void)says(kEnabledWord, position);
  }
};

TEST(ReportCheck, ANewStateOrModeIsAcceptedTheSecondTime) {
  Drive drive;
  EXPECT_FALSE(drive.says(kDisabledWord, 0));
  EXPECT_TRUE(drive.says(kDisabledWord, 0));
  EXPECT_FALSE(drive.says(kEnabledWord, 0));
  EXPECT_TRUE(drive.says(kEnabledWord, 0));
  EXPECT_TRUE(drive.says(kEnabledWord | 0x1400, 0)) << "no other state: acknowledged, and there";
  EXPECT_FALSE(drive.says(kEnabledWord, 0, 6));
  EXPECT_TRUE(drive.says(kEnabledWord, 0, 6));
  EXPECT_FALSE(drive.check.doubted());
}

TEST(ReportCheck, AMoveAtFullSpeedIsAcceptedHoweverReportsArrive) {
  // A trapezoid over 180 000 counts from 0: 0.5 s of ramps.
  const auto at = [](double s) {
    if (s < 0.5) return 45000 * s * s;
    if (s < 4) return 11250 + 45000 * (s - 0.5);
    return 180000 - 11250 + 45000 * (s - 4) * (1 - (s - 4));
  };
  Drive each, late, doubled, bunched;
  for (Drive* drive : {&each, &late, &doubled, &bunched}) drive->stands(0);
  for (int i = 1; i <= 225; ++i) {
    const auto position = static_cast<std::int32_t>(at(0.02 * i));
    ASSERT_TRUE(each.says(kEnabledWord, position)) << i;
    ASSERT_TRUE(late.says(kEnabledWord, position, 1, i == 100 ? 320 : 20)) << "late by 0.3 s from here on: " << i;
    ASSERT_TRUE(doubled.says(kEnabledWord, position)) << i;
    ASSERT_TRUE(doubled.says(kEnabledWord, position, 1, 0)) << i;
    ASSERT_TRUE(bunched.says(kEnabledWord, position, 1, i % 3 == 0 ? 60 : 0)) << "three at once: " << i;
  }
}

TEST(ReportCheck, AStandingAxisCannotJumpFarAway) {
  Drive drive;
  drive.stands(1000);
  EXPECT_TRUE(drive.says(kEnabledWord, 1200)) << "0.4 degrees";
  EXPECT_FALSE(drive.says(kEnabledWord, 4200)) << "6 degrees in 20 ms";
  EXPECT_FALSE(drive.check.doubted());
  EXPECT_TRUE(drive.says(kEnabledWord, 1200)) << "one wrong word is let pass";
  EXPECT_FALSE(drive.says(kEnabledWord, INT32_MIN));
  EXPECT_FALSE(drive.says(kEnabledWord, INT32_MAX));
  EXPECT_TRUE(drive.check.doubted());
  EXPECT_EQ(drive.check.why(), "its position went from 1200 to 2147483647 counts at once");
}

TEST(ReportCheck, ContradictionsFarApartAreTolerated) {
  Drive drive;
  drive.stands(0);
  for (int i = 0; i < 20; ++i) {
    EXPECT_FALSE(drive.says(kEnabledWord, 500000));
    drive.stands(0, 15);
    EXPECT_FALSE(drive.check.doubted()) << i;
  }
}

TEST(ReportCheck, WrongLengthsAndUndefinedStatusWordsAreDoubted) {
  Drive drive;
  drive.stands(0);
  const std::array<std::uint8_t, 8> bytes{0x37, 0x02};
  for (const std::size_t size : {0u, 6u, 8u})
    EXPECT_FALSE(drive.check.take(at_ms(drive.ms), {bytes.data(), size}, true));
  EXPECT_EQ(drive.check.why(), "a status of 8 bytes in place of 7");
  Drive other;
  other.stands(0);
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(other.says(0x0274, 0));
  EXPECT_EQ(other.check.why(), "the statusword 0274 is of no state");
  Drive third;
  third.stands(0);
  for (const int word : {0x0250, 0x0231, 0x0233, 0x0208}) EXPECT_FALSE(third.says(static_cast<std::uint16_t>(word), 0));
  EXPECT_EQ(third.check.why(), "its state or mode is another with every word");
}

TEST(ReportCheck, ADoubtEndsAtAPlausiblePosition) {
  const auto doubted_at = [](std::int32_t speed) {
    Drive drive;
    drive.stands(0);
    std::int32_t position = 0;
    for (int i = 0; i < 60; ++i) EXPECT_TRUE(drive.says(kEnabledWord, position += std::min(speed, 1800 * i) / 50));
    for (int i = 0; i < 3; ++i) EXPECT_FALSE(drive.says(kEnabledWord, position + 1000000 * (i + 1)));
    EXPECT_TRUE(drive.check.doubted());
    return std::pair(drive, position);
  };
  for (const auto& [speed, shift, kept] : {std::tuple(0, 500, true), std::tuple(0, 5000, false),
                                           std::tuple(45000, 9000, true), std::tuple(45000, 30000, false)}) {
    auto [drive, position] = doubted_at(speed);
    for (int i = 0; i < 15; ++i) {
      EXPECT_FALSE(drive.check.settled());
      (void)drive.says(kEnabledWord, position + shift);
    }
    (void)drive.says(kEnabledWord, position + shift);
    EXPECT_TRUE(drive.check.settled());
    EXPECT_EQ(drive.check.kept_its_place(), kept) << speed << " " << shift;
    drive.check.believe();
    EXPECT_FALSE(drive.check.doubted());
    EXPECT_TRUE(drive.says(kEnabledWord, position + shift));
  }
}

TEST(ReportCheck, AnyPositionIsAcceptedWhileTheCountIsBeingSet) {
  Drive drive;
  drive.stands(0);
  for (const std::int32_t position : {50000, -50000, 0, 1000000})
    EXPECT_TRUE(drive.says(kEnabledWord, position, 1, 20, false));
  EXPECT_FALSE(drive.check.doubted());
}

}  // namespace
}  // namespace luxrig
