#include "core/show/health_watch.h"

#include <gtest/gtest.h>

#include "tests/core/output/at.h"

namespace luxrig {
namespace {

/// Two fixtures on "track", two meters on "field".
Rig small_rig() {
  Rig rig;
  rig.buses.resize(2);
  rig.buses[0].name = "track";
  rig.buses[1].name = "field";
  rig.fixtures.resize(2);
  rig.fixtures[0].name = "left";
  rig.fixtures[1].name = "right";
  rig.luxmeters.resize(2);
  rig.luxmeters[0].name = "meter-1";
  rig.luxmeters[1].name = "meter-2";
  for (Luxmeter& luxmeter : rig.luxmeters) luxmeter.bus = 1;
  return rig;
}

Health faulted(const std::string& device, double since_s) {
  Health health;
  health.device = device;
  health.life = Life::faulted;
  health.detail = "no answer for 512 ms, bound 500 ms";
  health.since = at(since_s);
  return health;
}

void hear_both(HealthWatch& watch, double at_s) {
  watch.heard(0, at(at_s));
  watch.heard(1, at(at_s));
}

/// Like the show, ten times a second.
void step_until(HealthWatch& watch, double from_s, double to_s) {
  const int steps = static_cast<int>((to_s - from_s) * 10 + 0.5);
  for (int i = 1; i <= steps; ++i) watch.step(at(from_s + 0.1 * i));
}

TEST(HealthWatch, RaisesNoAlarmWhileAllMetersAndDevicesAreHealthy) {
  HealthWatch watch(small_rig());
  for (double t = 0; t < 10; t += 0.1) {
    hear_both(watch, t);
    watch.step(at(t));
    EXPECT_FALSE(watch.light_lost());
    EXPECT_FALSE(watch.any_meter_lost());
    EXPECT_TRUE(watch.alarms().empty());
  }
}

TEST(HealthWatch, FollowsReportsWhoseDevicesComeGoAndChangePlaces) {
  HealthWatch watch(small_rig());
  Health well = faulted("left", 0), stranger = faulted("stranger", 0), silent = faulted("meter-2", 0);
  well.life = Life::active;
  well.detail.clear();
  const auto after = [&](std::vector<Health> report, double from_s) {
    watch.report(report);
    for (double t = from_s; t < from_s + 1; t += 0.1) {
      watch.heard(0, at(t));
      watch.heard(1, at(t));
      for (Health& health : report) health.received += health.life == Life::active;
      watch.report(report);
      watch.step(at(t));
    }
    std::vector<std::string> devices;
    for (const Alarm& alarm : watch.alarms()) devices.push_back(alarm.device);
    return devices;
  };
  using Devices = std::vector<std::string>;
  EXPECT_EQ(after({well}, 0), Devices{});
  EXPECT_EQ(after({well, stranger, silent}, 1), (Devices{"stranger", "meter-2"}));
  EXPECT_TRUE(watch.all_lost());
  EXPECT_TRUE(watch.meter_lost(1));
  stranger.life = Life::active;
  stranger.detail.clear();
  EXPECT_EQ(after({silent, well, stranger}, 20), Devices{"meter-2"});
  EXPECT_FALSE(watch.all_lost());
  EXPECT_EQ(after({silent}, 40), Devices{"meter-2"});
  EXPECT_EQ(after({}, 60), Devices{});
  EXPECT_FALSE(watch.meter_lost(1));
  EXPECT_EQ(after({stranger, faulted("left", 80)}, 80), Devices{"left"});
  EXPECT_TRUE(watch.lamp_lost(0));
  EXPECT_FALSE(watch.lamp_lost(1));
}

TEST(HealthWatch, NamesLostDevicesAsTheCauseNotOtherWarnings) {
  HealthWatch watch(small_rig());
  EXPECT_EQ(watch.cause(true), "");
  hear_both(watch, 0);
  Health warm;
  warm.device = "right";
  warm.life = Life::active;
  warm.detail = "reports too hot";
  const std::vector<Health> report = {warm, faulted("meter-1", 0), faulted("left", 0)};
  watch.report(report);
  step_until(watch, 0, 1);
  ASSERT_EQ(watch.alarms().size(), 3u);
  EXPECT_NE(watch.cause(true).find("\"left\""), std::string::npos) << watch.cause(true);
  EXPECT_NE(watch.cause(false).find("\"meter-1\""), std::string::npos) << watch.cause(false);
  watch.report(std::span(report).first(2));
  step_until(watch, 1, 2);
  EXPECT_NE(watch.cause(true).find("meter-1"), std::string::npos) << "a warning is no cause";
}

TEST(HealthWatch, WarnsOfAWorkingDimmerThatReportsAnErrorWithoutLosingLight) {
  HealthWatch watch(small_rig());
  Health failing;
  failing.device = "right";
  failing.life = Life::active;
  failing.detail = "reports lamp-failure2";
  failing.since = at(3);
  watch.report({&failing, 1});
  hear_both(watch, 5);
  watch.step(at(5));
  ASSERT_EQ(watch.alarms().size(), 1u);
  EXPECT_FALSE(watch.alarms()[0].severe);
  EXPECT_EQ(watch.alarms()[0].device, "right");
  EXPECT_NE(watch.alarms()[0].text.find("reports lamp-failure2"), std::string::npos);
  EXPECT_FALSE(watch.light_lost());
  EXPECT_FALSE(watch.lamp_lost(1));
  failing.detail.clear();
  watch.report({&failing, 1});
  watch.step(at(5.1));
  EXPECT_TRUE(watch.alarms().empty());
}

TEST(HealthWatch, CountsAMetersSilenceFromTheFirstStep) {
  HealthWatch watch(small_rig());
  watch.step(at(1000));
  EXPECT_FALSE(watch.any_meter_lost());
  step_until(watch, 1000, 1001.4);
  EXPECT_FALSE(watch.any_meter_lost());
  step_until(watch, 1001.4, 1001.6);
  EXPECT_TRUE(watch.meter_lost(0));
}

TEST(HealthWatch, LosesASilentMeterWithinTwoSecondsAndRecoversIt) {
  HealthWatch watch(small_rig());
  hear_both(watch, 10);
  watch.step(at(10));
  step_until(watch, 10, 11.4);
  watch.heard(1, at(11.6));
  watch.step(at(11.6));
  EXPECT_TRUE(watch.meter_lost(0));
  EXPECT_FALSE(watch.meter_lost(1));
  EXPECT_FALSE(watch.light_lost());
  ASSERT_EQ(watch.alarms().size(), 1u);
  EXPECT_EQ(watch.alarms()[0].device, "meter-1");
  EXPECT_EQ(watch.alarms()[0].since, at(11.6));
  const std::string text = watch.alarms()[0].text;
  watch.heard(1, at(11.9));
  watch.step(at(11.9));
  EXPECT_EQ(watch.alarms()[0].text, text) << "its text counts nothing";
  watch.heard(0, at(12));
  watch.step(at(12));
  EXPECT_FALSE(watch.any_meter_lost());
  EXPECT_TRUE(watch.alarms().empty());
}

TEST(HealthWatch, ReportsAMeterThatSendsNoNumbers) {
  HealthWatch watch(small_rig());
  hear_both(watch, 10);
  watch.step(at(10));
  step_until(watch, 10, 11.4);
  watch.garbled(0, at(11.5));
  watch.heard(1, at(11.6));
  watch.step(at(11.6));
  ASSERT_EQ(watch.alarms().size(), 1u);
  EXPECT_NE(watch.alarms()[0].text.find("no usable number"), std::string::npos);
}

TEST(HealthWatch, LosesAnImplausibleMeterUntilItIsPlausible) {
  HealthWatch watch(small_rig());
  hear_both(watch, 1);
  watch.judged(0, at(1), "shows 900 lx, the model allows 40 to 60 lx");
  watch.step(at(1));
  EXPECT_TRUE(watch.meter_lost(0));
  ASSERT_EQ(watch.alarms().size(), 1u);
  EXPECT_NE(watch.alarms()[0].text.find("40 to 60 lx"), std::string::npos);
  watch.judged(0, at(1.5), "");
  watch.step(at(1.5));
  EXPECT_FALSE(watch.meter_lost(0));
}

TEST(HealthWatch, OneLateAnswerIsNoLossButSeveralInARowAre) {
  HealthWatch watch(small_rig());
  const HealthWatch::Patience patience{std::chrono::milliseconds(1200), std::chrono::milliseconds(1200)};
  const auto step_with = [&](double from_s, double to_s, bool failing) {
    for (double t = from_s; t < to_s - 0.01; t += 0.1) {
      const Health report[] = {faulted("left", from_s), faulted("meter-2", from_s)};
      watch.report(failing ? std::span<const Health>(report) : std::span<const Health>());
      hear_both(watch, t);
      watch.step(at(t), patience);
    }
  };
  step_with(10, 11, false);
  step_with(11, 12, true);
  EXPECT_FALSE(watch.light_lost());
  EXPECT_FALSE(watch.any_meter_lost());
  EXPECT_TRUE(watch.lamp_silent(0)) << "what it does is not known meanwhile";
  EXPECT_EQ(watch.alarms().size(), 2u) << "said at once";
  step_with(12, 13, false);
  EXPECT_TRUE(watch.alarms().empty());
  step_with(13, 14.4, true);
  EXPECT_TRUE(watch.lamp_lost(0));
  EXPECT_TRUE(watch.meter_lost(1));
}

TEST(HealthWatch, ARepeatedlyFailingDeviceNeedsLongerAndLongerRecovery) {
  HealthWatch watch(small_rig());
  double t = 10, row_before_s = -1;
  for (int failure = 0; failure < 7; ++failure) {
    for (int i = 0; i < 3; ++i, t += 0.1) {
      const Health report[] = {faulted("left", t)};
      watch.report(report);
      hear_both(watch, t);
      watch.step(at(t));
    }
    ASSERT_TRUE(watch.lamp_lost(0));
    const double well_s = t;
    while (watch.lamp_lost(0) && t < well_s + 60) {
      watch.report({});
      hear_both(watch, t);
      watch.step(at(t));
      if (watch.lamp_lost(0)) {
        ASSERT_EQ(watch.alarms().size(), 1u);
        EXPECT_NE(watch.alarms()[0].text.find("answers again"), std::string::npos) << watch.alarms()[0].text;
      }
      t += 0.1;
    }
    const double row_s = t - well_s;
    EXPECT_GT(row_s, failure < 5 ? row_before_s * 1.4 : 9.0) << failure;
    EXPECT_LT(row_s, 11);
    if (failure == 0) {
      EXPECT_LT(row_s, 0.3) << "a clean failure is over with the first answer";
    }
    row_before_s = row_s;
  }
}

TEST(HealthWatch, DistinguishesLossOfLightFromLossOfMeters) {
  const struct {
    const char* device;
    bool light, meter;
    std::size_t alarms;
  } cases[] = {{"track", true, false, 1},
               {"left", true, false, 1},
               {"field", false, true, 1},
               {"meter-2", false, true, 1},
               {"stranger", true, false, 1}};
  for (const auto& expected : cases) {
    HealthWatch watch(small_rig());
    hear_both(watch, 1);
    const Health report[] = {faulted(expected.device, 0.5)};
    watch.report(report);
    watch.step(at(1));
    EXPECT_EQ(watch.light_lost(), expected.light) << expected.device;
    EXPECT_EQ(watch.any_meter_lost(), expected.meter) << expected.device;
    ASSERT_EQ(watch.alarms().size(), expected.alarms) << expected.device;
    const Alarm& alarm = watch.alarms()[0];
    EXPECT_TRUE(alarm.severe);
    EXPECT_EQ(alarm.device, expected.device);
    EXPECT_EQ(alarm.since, at(0.5));
    EXPECT_NE(alarm.text.find("512 ms"), std::string::npos) << "keeps the figures";
    EXPECT_NE(alarm.text.find("check"), std::string::npos) << "says what would mend it";
    watch.report({});
    watch.step(at(2));
    EXPECT_FALSE(watch.light_lost());
    EXPECT_FALSE(watch.any_meter_lost());
  }
}

TEST(HealthWatch, ALostNodeConcernsOnlyItsBus) {
  Rig rig = small_rig();
  rig.buses.push_back({});
  rig.buses[2].name = "line";
  rig.fixtures.push_back(rig.fixtures[0]);
  rig.fixtures[2].name = "far";
  rig.fixtures[2].bus = 2;
  HealthWatch watch(rig);
  hear_both(watch, 1);
  Health node = faulted("track: node 7 (10.0.0.7)", 1);
  watch.report({&node, 1});
  watch.step(at(1));
  EXPECT_TRUE(watch.light_lost());
  EXPECT_FALSE(watch.all_lost()) << "what hangs on another bus goes on";
  EXPECT_TRUE(watch.lamp_lost(0));
  EXPECT_FALSE(watch.lamp_lost(2));
  ASSERT_EQ(watch.alarms().size(), 1u);
  EXPECT_EQ(watch.alarms()[0].device, node.device);
  const Health both[] = {faulted("track", 1), node};
  watch.report(both);
  watch.step(at(1.1));
  ASSERT_EQ(watch.alarms().size(), 1u) << "the bus says it";
  EXPECT_EQ(watch.alarms()[0].device, "track");
}

TEST(HealthWatch, ABypassedDeviceLosesNoLightAndRaisesNoAlarm) {
  HealthWatch watch(small_rig());
  hear_both(watch, 1);
  const Health report[] = {faulted("left", 1), faulted("meter-2", 1)};
  watch.report(report);
  watch.step(at(1));
  EXPECT_TRUE(watch.light_lost());
  EXPECT_EQ(watch.alarms().size(), 2u);
  watch.set_bypassed({at(1), std::nullopt}, {std::nullopt, at(1)});
  watch.step(at(1.1));
  EXPECT_FALSE(watch.light_lost());
  EXPECT_FALSE(watch.any_meter_lost());
  EXPECT_TRUE(watch.meter_lost(1)) << "it is done without";
  EXPECT_TRUE(watch.lamp_lost(0)) << "what it gives is not known all the same";
  EXPECT_TRUE(watch.alarms().empty());
  const Health all[] = {faulted("left", 1), faulted("right", 1)};
  watch.report(all);
  watch.step(at(1.2));
  EXPECT_TRUE(watch.all_lost()) << "of those in use none is left";
}

TEST(HealthWatch, ReportsALostBusOnceNotForEachMeter) {
  HealthWatch watch(small_rig());
  watch.step(at(0));
  const Health report[] = {faulted("field", 1), faulted("meter-1", 1), faulted("meter-2", 1)};
  watch.report(report);
  watch.step(at(10));
  EXPECT_TRUE(watch.meter_lost(0));
  EXPECT_TRUE(watch.meter_lost(1));
  ASSERT_EQ(watch.alarms().size(), 1u);
  EXPECT_EQ(watch.alarms()[0].device, "field");
}

TEST(HealthWatch, OwnLatenessDoesNotCountAsMeterSilence) {
  HealthWatch watch(small_rig());
  hear_both(watch, 10);
  watch.step(at(10));
  watch.step(at(13));  // the machine was busy: no step for three seconds
  EXPECT_FALSE(watch.any_meter_lost());
  step_until(watch, 13, 14);
  watch.heard(0, at(14));
  step_until(watch, 14, 14.8);
  EXPECT_TRUE(watch.meter_lost(1)) << "one that is silent is found all the same";
  EXPECT_FALSE(watch.meter_lost(0));
}

TEST(HealthWatch, AnUnpolledMeterIsNotSilentForTenSeconds) {
  HealthWatch watch(small_rig());
  Health health;
  health.device = "meter-1";
  health.life = Life::active;
  health.sent = 7;
  watch.report({&health, 1});
  hear_both(watch, 10);
  watch.step(at(10));
  step_until(watch, 10, 15);
  EXPECT_FALSE(watch.meter_lost(0));
  EXPECT_TRUE(watch.meter_lost(1)) << "of this one nobody says whether it was asked";
  step_until(watch, 15, 21);
  EXPECT_TRUE(watch.meter_lost(0));
}

TEST(HealthWatch, ReportsALostUnitOnceNotForEachLampAndMeter) {
  Rig rig = small_rig();
  for (Fixture& fixture : rig.fixtures) {
    ModbusPatch patch;
    patch.unit = 3;
    fixture.patch = patch;
  }
  rig.luxmeters[0].bus = 0;
  rig.luxmeters[0].patch.unit = 3;
  HealthWatch watch(rig);
  hear_both(watch, 1);
  const Health report[] = {faulted("left", 1), faulted("right", 1), faulted("meter-1", 1)};
  watch.report(report);
  watch.step(at(1));
  EXPECT_TRUE(watch.lamp_lost(0));
  EXPECT_TRUE(watch.lamp_lost(1));
  EXPECT_TRUE(watch.meter_lost(0));
  ASSERT_EQ(watch.alarms().size(), 1u);
  EXPECT_EQ(watch.alarms()[0].text,
            "unit 3 of bus \"track\" does not answer (no answer for 512 ms, bound 500 ms): fixtures \"left\", "
            "\"right\" cannot be controlled, luxmeter \"meter-1\" is not heard; check its power and its address");
}

TEST(HealthWatch, AnAlarmKeepsItsFirstTextWhileItLasts) {
  HealthWatch watch(small_rig());
  hear_both(watch, 1);
  Health health = faulted("track", 1);
  watch.report({&health, 1});
  watch.step(at(1));
  const std::string text = watch.alarms()[0].text;
  health.detail = "no answer for 893 ms, bound 500 ms";
  watch.report({&health, 1});
  watch.step(at(1.1));
  EXPECT_EQ(watch.alarms()[0].text, text);
}

TEST(HealthWatch, LostAxesLoseLightAndAreReportedOncePerBus) {
  Rig rig = small_rig();
  rig.buses.push_back({});
  rig.buses[2].name = "can";
  rig.fixtures[1].moves = true;
  rig.fixtures[1].axes = AxesPatch{2, {}, {}};
  HealthWatch watch(rig);
  hear_both(watch, 5);
  const Health axis[] = {faulted("right (tilt axis)", 5)};
  watch.report(axis);
  watch.step(at(5));
  EXPECT_TRUE(watch.light_lost()) << "the beam may be anywhere";
  ASSERT_EQ(watch.alarms().size(), 1u);
  EXPECT_NE(watch.alarms()[0].text.find("right (tilt axis) cannot be turned (no answer for 512 ms"), std::string::npos)
      << watch.alarms()[0].text;
  const Health all[] = {faulted("can", 6), faulted("right (pan axis)", 6), faulted("right (tilt axis)", 6)};
  watch.report(all);
  watch.step(at(6));
  ASSERT_EQ(watch.alarms().size(), 1u);
  EXPECT_NE(watch.alarms()[0].text.find("bus \"can\" is gone"), std::string::npos);
  EXPECT_NE(watch.alarms()[0].text.find("its 1 heads cannot be turned"), std::string::npos) << watch.alarms()[0].text;
  watch.report({});
  hear_both(watch, 7);
  watch.step(at(7));
  EXPECT_FALSE(watch.light_lost());
}

}  // namespace
}  // namespace luxrig
