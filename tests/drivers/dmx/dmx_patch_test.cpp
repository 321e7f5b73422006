#include "drivers/dmx/dmx_patch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/drivers/test_rig.h"

namespace luxrig {
namespace {

TEST(DmxPatch, RoundsDrivesToTheNearestValueOfTheSlot) {
  EXPECT_EQ(encode_dmx(0, 1), 0u);
  EXPECT_EQ(encode_dmx(1, 1), 255u);
  EXPECT_EQ(encode_dmx(0.5, 1), 128u);  // 127.5 rounds away from zero
  EXPECT_EQ(encode_dmx(1.0 / 255 * 0.49, 1), 0u);
  EXPECT_EQ(encode_dmx(1.0 / 255 * 0.51, 1), 1u);
  EXPECT_EQ(encode_dmx(0.5, 2), 0x8000u);
  EXPECT_EQ(encode_dmx(1, 2), 0xFFFFu);
}

TEST(DmxPatch, EncodesThePublishedAimVectors) {
  // Pan −270…270, tilt −135…135.
  const auto pan = [](double deg) { return encode_dmx(share_of_travel(deg, -270, 270), 2); };
  const auto tilt = [](double deg) { return encode_dmx(share_of_travel(deg, -135, 135), 2); };
  EXPECT_EQ(pan(0), 0x8000u);
  EXPECT_EQ(pan(-90), 0x5555u);
  EXPECT_EQ(pan(90), 0xAAAAu);
  EXPECT_EQ(tilt(90), 0xD555u);
  EXPECT_EQ(tilt(-90), 0x2AABu);
  EXPECT_EQ(tilt(0), 0x8000u);
}

TEST(DmxPatch, RoundTrips16BitAnglesWithinHalfAStep) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> angle(-270, 270);
  for (int i = 0; i < 2000; ++i) {
    const double wanted = angle(random);
    const double got = -270 + encode_dmx(share_of_travel(wanted, -270, 270), 2) / 65535.0 * 540;
    EXPECT_LE(std::abs(got - wanted), 540.0 / 65535 / 2 + 1e-9);
  }
}

TEST(DmxPatch, WritesBothBytesOfEachValueAndTheConstants) {
  Rig rig = rig_with(bus_of("sacn"));
  add_head(rig, "head", 3, 10);
  DmxPatchbay bay(rig, 0);
  const AimCommand aim{0, {rad_from_deg(-90), rad_from_deg(90)}};
  ASSERT_TRUE(bay.set_aims({&aim, 1}));
  const LevelCommand level{0, 0.25};
  ASSERT_TRUE(bay.set_levels({&level, 1}));
  ASSERT_EQ(bay.universes().size(), 1u);
  EXPECT_EQ(bay.universes()[0].number, 3);
  const DmxSlots& slots = bay.universes()[0].slots;
  const std::vector<int> got(slots.begin() + 9, slots.begin() + 16);
  EXPECT_EQ(got, (std::vector<int>{0x55, 0x55, 0xD5, 0x55, 0x40, 0x00, 255}));
  for (std::size_t i = 0; i < kDmxSlots; ++i) {
    if (i >= 9 && i < 16) continue;
    EXPECT_EQ(slots[i], 0) << i;
  }
}

TEST(DmxPatch, UsesTheFullByteWithoutAFineSlot) {
  Rig rig = rig_with(bus_of("sacn"));
  Fixture& head = add_dmx(rig, "head", 1, 1, {{SlotUse::pan}, {SlotUse::tilt}, {SlotUse::dimmer}});
  head.moves = true;
  DmxPatchbay bay(rig, 0);
  const AimCommand aim{0, {rad_from_deg(270), rad_from_deg(-135)}};
  ASSERT_TRUE(bay.set_aims({&aim, 1}));
  const LevelCommand level{0, 1};
  ASSERT_TRUE(bay.set_levels({&level, 1}));
  const DmxSlots& slots = bay.universes()[0].slots;
  EXPECT_EQ(slots[0], 255);
  EXPECT_EQ(slots[1], 0);
  EXPECT_EQ(slots[2], 255);
}

TEST(DmxPatch, StartsDarkWithHeadsAimedAsTheRigFileStates) {
  Rig rig = rig_with(bus_of("sacn"));
  add_head(rig, "head", 1, 1).joints = {rad_from_deg(90), 0};
  const DmxPatchbay bay(rig, 0);
  const DmxSlots& slots = bay.universes()[0].slots;
  EXPECT_EQ(slots[0], 0xAA);
  EXPECT_EQ(slots[1], 0xAA);
  EXPECT_EQ(slots[4], 0);
  EXPECT_EQ(slots[6], 255);
}

TEST(DmxPatch, SendsAnAimOnlyWithTheNextLevels) {
  Rig rig = rig_with(bus_of("sacn"));
  add_head(rig, "head", 1, 1);
  DmxPatchbay bay(rig, 0);
  const AimCommand aim{0, {rad_from_deg(90), 0}};
  ASSERT_TRUE(bay.set_aims({&aim, 1}));
  EXPECT_EQ(bay.universes()[0].slots[0], 0x80);
  ASSERT_TRUE(bay.set_levels({}));
  EXPECT_EQ(bay.universes()[0].slots[0], 0xAA);
}

TEST(DmxPatch, RefusesAWholeCommandForOneBadValueAndChangesNothing) {
  Rig rig = rig_with(bus_of("sacn"));
  rig.buses.push_back(bus_of("sacn"));
  add_dmx(rig, "good", 1, 1);
  add_dmx(rig, "bad", 1, 2);
  add_dmx(rig, "elsewhere", 1, 3).bus = 1;
  DmxPatchbay bay(rig, 0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const LevelCommand& bad : {LevelCommand{1, nan}, LevelCommand{1, 1.0000001}, LevelCommand{1, -1e-9},
                                  LevelCommand{1, inf}, LevelCommand{2, 0.5}, LevelCommand{99, 0.5}}) {
    const LevelCommand both[] = {{0, 1.0}, bad};
    const auto result = bay.set_levels(both);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().cause, Cause::invalid);
    EXPECT_EQ(bay.universes()[0].slots[0], 0);
  }
  const AimCommand still{0, {0, 0}};
  EXPECT_EQ(bay.set_aims({&still, 1}).error().device, "good");
}

TEST(DmxPatch, RefusesAnAimOutsideTheRange) {
  Rig rig = rig_with(bus_of("sacn"));
  add_head(rig, "head", 1, 1);
  DmxPatchbay bay(rig, 0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Joints& joints :
       {Joints{rad_from_deg(270.1), 0}, Joints{0, rad_from_deg(-135.1)}, Joints{nan, 0}, Joints{0, nan}}) {
    const AimCommand aim{0, joints};
    EXPECT_EQ(bay.set_aims({&aim, 1}).error().cause, Cause::invalid);
  }
  const AimCommand edge{0, {rad_from_deg(270) + 1e-9, 0}};
  EXPECT_TRUE(bay.set_aims({&edge, 1}));
}

/// A head that zooms from 10° to 50° in 16 bits; sixteenths give round numbers.
Fixture& add_zooming_head(Rig& rig, bool inverted) {
  const DmxTravel travel = inverted ? DmxTravel{1, 0} : DmxTravel{};
  Fixture& head = add_dmx(rig, "head", 1, 1,
                          {{SlotUse::pan},
                           {SlotUse::tilt},
                           {SlotUse::dimmer},
                           {SlotUse::zoom, 0, true, 0, travel},
                           {SlotUse::zoom_fine, 0, true, 0, travel}});
  head.moves = true;
  head.range.beam_min_rad = rad_from_deg(10);
  head.range.beam_max_rad = rad_from_deg(50);
  head.joints.beam_rad = rad_from_deg(20);
  return head;
}

TEST(DmxPatch, ZoomsLinearlyInBeamAngleInEitherDirection) {
  for (const bool inverted : {false, true}) {
    Rig rig = rig_with(bus_of("sacn"));
    add_zooming_head(rig, inverted);
    DmxPatchbay bay(rig, 0);
    const DmxSlots& slots = bay.universes()[0].slots;
    const auto zoom = [&] { return slots[3] * 256 + slots[4]; };
    EXPECT_EQ(zoom(), inverted ? 49151 : 16384) << "as the rig file says: a quarter of the way";
    const AimCommand wide{0, {0, 0, rad_from_deg(50)}};
    ASSERT_TRUE(bay.set_aims({&wide, 1}));
    ASSERT_TRUE(bay.set_levels({}));
    EXPECT_EQ(zoom(), inverted ? 0 : 65535);
    std::bitset<kDmxSlots> given;
    given.set();
    DmxSlots sent{};
    sent[3] = 0x80;  // 0x8000: half way, to within half a step
    const auto wanted = bay.decode(0, sent, given);
    ASSERT_EQ(wanted.size(), 1u);
    ASSERT_TRUE(wanted[0].joints);
    EXPECT_NEAR(deg_from_rad(wanted[0].joints->beam_rad), 30, 40.0 / 65535);
    given.reset(4);
    const auto half = bay.decode(0, sent, given);
    EXPECT_NEAR(deg_from_rad(half[0].joints->beam_rad), 50, 1e-9) << "half a zoom is none: it stays where it was sent";
    for (const double beam_deg : {9.9, 50.1, std::numeric_limits<double>::quiet_NaN()}) {
      const AimCommand outside{0, {0, 0, rad_from_deg(beam_deg)}};
      EXPECT_EQ(bay.set_aims({&outside, 1}).error().cause, Cause::invalid);
    }
    EXPECT_EQ(zoom(), inverted ? 0 : 65535);
  }
}

TEST(DmxPatch, KeepsUniversesApartAndInOrder) {
  Rig rig = rig_with(bus_of("sacn"));
  add_dmx(rig, "a", 9, 1);
  add_dmx(rig, "b", 2, 512);
  DmxPatchbay bay(rig, 0);
  const LevelCommand levels[] = {{0, 1.0}, {1, 0.2}};
  ASSERT_TRUE(bay.set_levels(levels));
  ASSERT_EQ(bay.universes().size(), 2u);
  EXPECT_EQ(bay.universes()[0].number, 2);
  EXPECT_EQ(bay.universes()[0].slots[511], 51);
  EXPECT_EQ(bay.universes()[1].number, 9);
  EXPECT_EQ(bay.universes()[1].slots[0], 255);
}

TEST(DmxPatch, ReportsWhatADmxBusCannotCarry) {
  Rig rig = rig_with(bus_of("sacn"));
  add_modbus(rig, "dimmer", 1, 0);
  add_dmx(rig, "far", 64000, 1);
  add_dmx(rig, "long", 1, 512, {{SlotUse::dimmer}, {SlotUse::dimmer_fine}});
  add_meter(rig, "meter", 1, 2);
  const std::vector<Problem> problems = check_dmx_patch(rig, 0, 1, 63999);
  ASSERT_EQ(problems.size(), 4u);
  EXPECT_EQ(problems[0].text(),
            "a/rig.toml:20:3: fixture \"dimmer\" has a Modbus register, but its bus \"the-bus\" carries DMX: give it "
            "universe and address in place of unit and register, or another bus");
  EXPECT_EQ(problems[1].mend, "choose a universe in 1…63999");
  EXPECT_EQ(problems[2].mend, "choose an address in 1…511");
  EXPECT_EQ(problems[3].line, 40);
}

}  // namespace
}  // namespace luxrig
