#include "core/show/alarm_log.h"

#include <gtest/gtest.h>

#include "tests/core/output/at.h"

namespace luxrig {
namespace {

TEST(AlarmLog, AFailureWithAChangingCountIsOneLine) {
  AlarmLog log;
  std::size_t lines = 0;
  for (int step = 0; step < 1250; ++step) {
    const double now_s = 0.1 * step;
    const std::vector<Alarm> alarms = {
        {true, "meter", "luxmeter \"meter\" has not been heard for " + std::to_string(now_s) + " s", at(0)}};
    lines += log.to_say(alarms, at(now_s)).size();
  }
  EXPECT_EQ(lines, 1u);
}

TEST(AlarmLog, RepeatsALastingFailureEveryTenMinutes) {
  AlarmLog log;
  const std::vector<Alarm> alarms = {{true, "track", "bus \"track\" is gone", at(0)}};
  std::size_t lines = 0;
  for (int second = 0; second < 3600; ++second) lines += log.to_say(alarms, at(second)).size();
  EXPECT_EQ(lines, 6u);
}

TEST(AlarmLog, LogsTwoCausesAndANewFailureOfADeviceAMinuteLater) {
  AlarmLog log;
  const Alarm track{true, "track", "bus \"track\" is gone", at(0)}, meter{true, "meter", "not heard", at(0)};
  EXPECT_EQ(log.to_say(std::vector<Alarm>{track, meter}, at(0)).size(), 2u);
  const Alarm later{true, "track", "bus \"track\" is gone", at(70)};
  EXPECT_EQ(log.to_say(std::vector<Alarm>{later}, at(70)).size(), 1u);
}

TEST(AlarmLog, DistinguishesPointsWhoseNamesDifferOnlyInANumber) {
  AlarmLog log;
  const std::vector<Alarm> alarms = {{true, "", "point \"work-1\" may have 51.2 lx", at(0)},
                                     {true, "", "point \"work-2\" may have 51.2 lx", at(0)}};
  EXPECT_EQ(log.to_say(alarms, at(0)).size(), 2u);
  EXPECT_FALSE(is_same_alarm(alarms[0], alarms[1]));
}

TEST(AlarmLog, LogsAFlappingDeviceOnceAMinute) {
  AlarmLog log;
  std::size_t lines = 0;
  for (int half = 0; half < 240; ++half) {
    std::vector<Alarm> alarms;
    if (half % 2 == 0) alarms.push_back({true, "track", "bus \"track\" is gone", at(0.5 * half)});
    lines += log.to_say(alarms, at(0.5 * half)).size();
  }
  EXPECT_EQ(lines, 2u);
}

}  // namespace
}  // namespace luxrig
