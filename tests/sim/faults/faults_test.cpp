#include "sim/faults/faults.h"

#include <gtest/gtest.h>

#include "tests/sim/tiny_rig.h"

namespace luxrig::sim {
namespace {

using namespace std::chrono_literals;

TEST(Faults, NamesOfKindsRoundTrip) {
  for (const FaultKind kind : all_faults()) EXPECT_EQ(fault_named(name_of(kind)), kind);
  EXPECT_EQ(all_faults().size(), 22u);
  EXPECT_FALSE(fault_named("tired"));
}

TEST(Faults, UnknownDevicesFaultsAndValuesAreRefusedWithARemedy) {
  const Rig rig = tiny_rig();
  Faults faults;
  const auto device = faults.set_named(rig, "meter-9", "silent", true);
  ASSERT_FALSE(device);
  EXPECT_NE(device.error().detail.find("name a fixture, an axis of one, a luxmeter or a bus"), std::string::npos);
  const auto fault = faults.set_named(rig, "meter-1", "tired", true);
  ASSERT_FALSE(fault);
  EXPECT_NE(fault.error().detail.find("stuck"), std::string::npos);
  EXPECT_FALSE(faults.set_named(rig, "meter-1", "lost", true, 1.5));
  EXPECT_FALSE(faults.set_named(rig, "meter-1", "slow", true, std::nan("")));
  EXPECT_TRUE(faults.set_named(rig, "meter-1", "silent", true));
  EXPECT_TRUE(faults.set_named(rig, "field", "dead", true));
  EXPECT_TRUE(faults.set_named(rig, "bulb-1", "slow", true, 20));
}

TEST(Faults, OfBusAndDeviceAddUp) {
  Faults faults;
  faults.set("field", FaultKind::slow, true, 100);
  faults.set("meter-1", FaultKind::slow, true, 250);
  faults.set("meter-1", FaultKind::exception, true, 6);
  const std::string names[] = {"field", "meter-1"};
  const Disturbance disturbance = faults.disturbance(names, 0);
  EXPECT_EQ(disturbance.delay, 250ms);
  EXPECT_EQ(disturbance.exception, 6);
  EXPECT_FALSE(disturbance.silent);
  faults.clear();
  EXPECT_EQ(faults.disturbance(names, 1).delay, 0ms);
}

TEST(Faults, LostExchangesHaveTheStatedShare) {
  Faults faults;
  faults.set("meter-1", FaultKind::lost, true, 0.3);
  const std::string name = "meter-1";
  int lost = 0;
  for (std::uint64_t i = 0; i < 10000; ++i) lost += faults.disturbance({&name, 1}, i).silent ? 1 : 0;
  EXPECT_NEAR(lost, 3000, 5 * std::sqrt(10000 * 0.3 * 0.7));
}

TEST(Faults, DuplicatedAndReorderedAreDrawnIndependentlyWithTheirShares) {
  Faults faults;
  faults.set("dmx", FaultKind::duplicated, true, 0.2);
  faults.set("dmx", FaultKind::reordered, true, 0.4);
  const std::string name = "dmx";
  int twice = 0, late = 0, both = 0;
  for (std::uint64_t i = 0; i < 10000; ++i) {
    const Disturbance disturbance = faults.disturbance({&name, 1}, i);
    twice += disturbance.duplicated;
    late += disturbance.reordered;
    both += disturbance.duplicated && disturbance.reordered;
  }
  EXPECT_NEAR(twice, 2000, 200);
  EXPECT_NEAR(late, 4000, 245);
  EXPECT_NEAR(both, 800, 140);
}

TEST(Faults, EveryStateHasItsOwnRevision) {
  Faults faults;
  const std::uint64_t begun = faults.revision();
  faults.set("dmx", FaultKind::silent, true);
  const std::uint64_t on = faults.revision();
  EXPECT_NE(on, begun);
  EXPECT_TRUE(faults.find("dmx", FaultKind::silent));
  EXPECT_EQ(faults.revision(), on) << "looking changes nothing";
  faults.clear();
  EXPECT_NE(faults.revision(), on);
}

TEST(Faults, AStuckMeterRepeatsItsValueAndALyingOneScalesIt) {
  Faults faults;
  EXPECT_EQ(faults.shown_lx("meter-1", 100), 100);
  faults.set("meter-1", FaultKind::stuck, true);
  EXPECT_EQ(faults.shown_lx("meter-1", 110), 110);
  EXPECT_EQ(faults.shown_lx("meter-1", 500), 110);
  EXPECT_EQ(faults.shown_lx("meter-2", 500), 500);
  faults.set("meter-1", FaultKind::stuck, false);
  EXPECT_EQ(faults.shown_lx("meter-1", 500), 500);
  faults.set("meter-1", FaultKind::lying, true, 0.1);
  EXPECT_EQ(faults.shown_lx("meter-1", 500), 50);
}

}  // namespace
}  // namespace luxrig::sim
