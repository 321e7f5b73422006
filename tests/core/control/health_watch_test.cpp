#include "core/control/health_watch.h"

#include <gtest/gtest.h>

#include "tests/core/control/at.h"

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

TEST(HealthWatch, IsContentWhileEveryMeterSpeaksAndNothingIsFaulted) {
  HealthWatch watch(small_rig());
  for (double t = 0; t < 10; t += 0.1) {
    hear_both(watch, t);
    watch.step(at(t));
    EXPECT_FALSE(watch.light_lost());
    EXPECT_FALSE(watch.any_meter_lost());
    EXPECT_TRUE(watch.alarms().empty());
  }
}

TEST(HealthWatch, WarnsOfADimmerThatObeysAndSaysThatSomethingIsWrongAndLeavesTheLightAlone) {
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

TEST(HealthWatch, GivesMetersTheirTimeOfSilenceFromTheFirstStep) {
  HealthWatch watch(small_rig());
  watch.step(at(1000));
  EXPECT_FALSE(watch.any_meter_lost());
  watch.step(at(1001.5));
  EXPECT_FALSE(watch.any_meter_lost());
  watch.step(at(1001.6));
  EXPECT_TRUE(watch.meter_lost(0));
}

TEST(HealthWatch, LosesAMeterThatFallsSilentWithinTwoSecondsAndTakesItBack) {
  HealthWatch watch(small_rig());
  hear_both(watch, 10);
  watch.step(at(10));
  watch.heard(1, at(11.6));
  watch.step(at(11.6));
  EXPECT_TRUE(watch.meter_lost(0));
  EXPECT_FALSE(watch.meter_lost(1));
  EXPECT_FALSE(watch.light_lost());
  ASSERT_EQ(watch.alarms().size(), 1u);
  EXPECT_EQ(watch.alarms()[0].device, "meter-1");
  EXPECT_EQ(watch.alarms()[0].since, at(11.6));
  EXPECT_NE(watch.alarms()[0].text.find("1.6 s"), std::string::npos);
  watch.heard(0, at(12));
  watch.step(at(12));
  EXPECT_FALSE(watch.any_meter_lost());
  EXPECT_TRUE(watch.alarms().empty());
}

TEST(HealthWatch, SaysWhenAMeterSendsNoNumbers) {
  HealthWatch watch(small_rig());
  hear_both(watch, 10);
  watch.step(at(10));
  watch.garbled(0, at(11.5));
  watch.heard(1, at(11.6));
  watch.step(at(11.6));
  ASSERT_EQ(watch.alarms().size(), 1u);
  EXPECT_NE(watch.alarms()[0].text.find("no usable number"), std::string::npos);
}

TEST(HealthWatch, LosesAMeterThatCannotBeBelievedUntilItCan) {
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

TEST(HealthWatch, TellsLossOfLightFromLossOfMeters) {
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

TEST(HealthWatch, SaysOnceThatABusIsGoneNotForEachMeterOnIt) {
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

TEST(HealthWatch, AxesThatAreLostAreLightLostAndTheirBusSaysItOnce) {
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
