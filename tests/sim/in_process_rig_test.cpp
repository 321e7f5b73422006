#include "sim/in_process_rig.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/sim/tiny_rig.h"

namespace luxrig::sim {
namespace {

using namespace std::chrono_literals;

struct Bench {
  explicit Bench(const InProcessOptions& options = {}) : devices(tiny_rig(), tiny_world(tiny_rig()), options) {}

  const Health& health_of(const std::string& name, Time now) {
    all = devices.health(now);
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const Health& health) { return health.device == name; });
    EXPECT_NE(found, all.end()) << name;
    return *found;
  }
  // Last reading of a meter between two instants, polled every 50 ms.
  std::optional<LuxReading> last_reading(std::size_t meter, Time from, Time to) {
    std::optional<LuxReading> last;
    for (Time now = from; now <= to; now += 50ms) {
      const auto readings = devices.read(now);
      if (!readings) continue;
      for (const LuxReading& reading : *readings) {
        if (reading.luxmeter == meter) last = reading;
      }
    }
    return last;
  }

  InProcessRig devices;
  std::vector<Health> all;
};

TEST(InProcessRig, WrittenLevelsShineAndAreMeasured) {
  Bench bench;
  const LevelCommand commands[] = {{0, 0.5}, {2, 0.25}};
  ASSERT_TRUE(bench.devices.write(at_s(0), commands));
  const auto reading = bench.last_reading(0, at_s(0), at_s(1));
  ASSERT_TRUE(reading);
  EXPECT_NEAR(reading->lux, 0.5 * 100 + 0.25 * 200, 1e-9);
  EXPECT_LE(at_s(0.75), reading->taken);
}

TEST(InProcessRig, GivesEachReadingOnce) {
  Bench bench;
  std::size_t readings = 0;
  for (Time now = at_s(0); now <= at_s(2); now += 10ms) readings += bench.devices.read(now)->size();
  EXPECT_EQ(readings, 2u * 10u);  // two meters, five a second, two seconds
}

TEST(InProcessRig, WrongInputIsRefusedAndNothingIsSent) {
  Bench bench;
  for (const double drive : {std::numeric_limits<double>::quiet_NaN(), -0.1, 1.1}) {
    const LevelCommand commands[] = {{0, 0.5}, {2, drive}};
    const auto written = bench.devices.write(at_s(0), commands);
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().cause, Cause::invalid);
  }
  const LevelCommand nobody[] = {{0, 0.5}, {3, 0.5}};
  EXPECT_FALSE(bench.devices.write(at_s(0), nobody));
  const AimCommand fixed[] = {{0, {0, 0}}};
  EXPECT_FALSE(bench.devices.move(at_s(0), fixed));
  EXPECT_EQ(bench.devices.world().drives(), (std::vector<double>{0, 0, 0}));
}

TEST(InProcessRig, LatencyDelaysCommandsAndReadings) {
  InProcessOptions options;
  options.start = at_s(100);
  options.write_latency = 100ms;
  options.read_latency = 70ms;
  Bench bench(options);
  const LevelCommand commands[] = {{0, 1.0}};
  ASSERT_TRUE(bench.devices.write(at_s(100), commands));
  bench.devices.advance(at_s(100.1));
  EXPECT_EQ(bench.devices.world().levels()[0], 0);
  bench.devices.advance(at_s(100.11));
  EXPECT_EQ(bench.devices.world().levels()[0], 1);
  ASSERT_TRUE(bench.devices.read(at_s(100.25))->empty());  // sampled at 0.2 s, in transit until 0.27 s
  const auto readings = bench.devices.read(at_s(100.27));
  ASSERT_FALSE(readings->empty());
  EXPECT_EQ(readings->front().taken, at_s(100.2));
}

TEST(InProcessRig, HeadsMoveToTheirAims) {
  Bench bench;
  const AimCommand commands[] = {{1, {kPi / 2, kPi / 4}}};
  ASSERT_TRUE(bench.devices.move(at_s(0), commands));
  bench.devices.advance(at_s(0.25));
  EXPECT_NEAR(bench.devices.world().joints()[1].pan_rad, kPi / 4, 1e-9);
  bench.devices.advance(at_s(2));
  EXPECT_EQ(bench.devices.world().joints()[1].pan_rad, kPi / 2);
}

TEST(InProcessRig, ADeadBusIsFaultedAndItsLightHolds) {
  Bench bench;
  const LevelCommand on[] = {{0, 1.0}, {2, 1.0}};
  ASSERT_TRUE(bench.devices.write(at_s(0), on));
  bench.devices.faults().set("field", FaultKind::dead, true);
  const LevelCommand off[] = {{0, 0.0}, {2, 0.0}};
  const auto written = bench.devices.write(at_s(1), off);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().device, "field");
  EXPECT_EQ(bench.devices.world().drives(), (std::vector<double>{0, 0, 1}));  // the living bus was served
  EXPECT_FALSE(bench.devices.read(at_s(1)));
  EXPECT_EQ(bench.health_of("field", at_s(1)).life, Life::faulted);
  EXPECT_EQ(bench.health_of("dmx", at_s(1)).life, Life::active);
  bench.devices.faults().clear();
  EXPECT_TRUE(bench.devices.write(at_s(2), off));
  EXPECT_EQ(bench.health_of("field", at_s(2)).life, Life::active);
}

TEST(InProcessRig, ASilentMeterFaultsAloneAndRecovers) {
  Bench bench;
  bench.last_reading(0, at_s(0), at_s(1));
  bench.devices.faults().set("meter-1", FaultKind::silent, true);
  EXPECT_FALSE(bench.last_reading(0, at_s(1.05), at_s(2)));
  EXPECT_EQ(bench.health_of("meter-1", at_s(2)).life, Life::faulted);
  EXPECT_NE(bench.all[3].detail.find("no answer"), std::string::npos) << bench.all[3].detail;
  EXPECT_EQ(bench.health_of("meter-2", at_s(2)).life, Life::active);
  EXPECT_TRUE(bench.last_reading(1, at_s(2), at_s(3)));
  bench.devices.faults().clear();
  EXPECT_TRUE(bench.last_reading(0, at_s(3.05), at_s(4)));
  EXPECT_EQ(bench.health_of("meter-1", at_s(4)).life, Life::active);
}

TEST(InProcessRig, EveryMeterFaultIsNoticeableOrFalsifiesItsReading) {
  for (const FaultKind kind : all_faults()) {
    if (kind == FaultKind::duplicated || kind == FaultKind::reset || kind == FaultKind::unmappable ||
        kind == FaultKind::bus_off || kind == FaultKind::reordered || kind == FaultKind::lamp_failure ||
        kind == FaultKind::pressed)
      continue;  // faults of axes, of packets without an answer, of lamps
    Bench bench;
    bench.devices.faults().set("meter-1", kind, true,
                               kind == FaultKind::lost   ? std::optional(1.0)
                               : kind == FaultKind::slow ? std::optional(5000.0)
                                                         : std::nullopt);
    const LevelCommand on[] = {{0, 1.0}};
    ASSERT_TRUE(bench.devices.write(at_s(0), on));
    const auto reading = bench.last_reading(0, at_s(0), at_s(2));
    const Life life = bench.health_of("meter-1", at_s(2)).life;
    if (kind == FaultKind::stuck || kind == FaultKind::lying) {
      ASSERT_TRUE(reading) << name_of(kind);
      EXPECT_LT(reading->lux, 60) << name_of(kind);
      EXPECT_EQ(life, Life::active) << name_of(kind);
    } else {
      EXPECT_FALSE(reading) << name_of(kind);
      EXPECT_EQ(life, Life::faulted) << name_of(kind);
    }
  }
}

TEST(InProcessRig, ABurntOutOrUnpoweredLampGivesNoLightOnAnyBus) {
  for (const FaultKind kind : {FaultKind::lamp_failure, FaultKind::unpowered}) {
    for (const std::size_t lamp : {0u, 2u}) {  // on DMX, on Modbus
      Bench bench;
      const LevelCommand on[] = {{lamp, 0.8}};
      ASSERT_TRUE(bench.devices.write(at_s(0), on));
      bench.devices.advance(at_s(1));
      ASSERT_GT(bench.devices.world().points()[0].lux, 50);
      bench.devices.faults().set(lamp == 0 ? "spot-1" : "bulb-1", kind, true);
      bench.devices.advance(at_s(1.5));
      EXPECT_EQ(bench.devices.world().points()[0].lux, 0) << name_of(kind) << " with nothing sent since";
      ASSERT_TRUE(bench.devices.write(at_s(2), on));
      bench.devices.advance(at_s(2.5));
      EXPECT_EQ(bench.devices.world().levels()[lamp], 0) << name_of(kind);
      bench.devices.faults().clear();
      bench.devices.advance(at_s(3));
      EXPECT_EQ(bench.devices.world().levels()[lamp] > 0, kind == FaultKind::lamp_failure)
          << "what had no power knows no level until it is sent one";
      ASSERT_TRUE(bench.devices.write(at_s(3), on));
      bench.devices.advance(at_s(4));
      EXPECT_NEAR(bench.devices.world().levels()[lamp], 0.8, 1e-9);
    }
  }
}

TEST(InProcessRig, CommandsOfOneFixtureNeverOvertakeEachOther) {
  Bench bench;
  bench.devices.faults().set("bulb-1", FaultKind::slow, true, 300);
  const LevelCommand first[] = {{2, 0.2}}, second[] = {{2, 0.7}};
  ASSERT_TRUE(bench.devices.write(at_s(0), first));
  bench.devices.faults().clear();
  ASSERT_TRUE(bench.devices.write(at_s(0.1), second));
  bench.devices.advance(at_s(0.2));
  EXPECT_EQ(bench.devices.world().drives()[2], 0);
  bench.devices.advance(at_s(1));
  EXPECT_EQ(bench.devices.world().drives()[2], 0.7);
}

}  // namespace
}  // namespace luxrig::sim
