// A fixture with several emitters, from the rig file through the DMX frame to the simulated device. Each emitter's
// level arrives in its own slots, whatever its siblings do. Their common values are sent once.
#include <gtest/gtest.h>

#include "core/rig/rig_file.h"
#include "drivers/dmx/dmx_patch.h"
#include "sim/devices/dmx_fixture.h"

namespace luxrig {
namespace {

constexpr const char* kStage = R"([rig]
name = "stage"
[[luminaire]]
name = "par"
model = "spot"
beam_angle_deg = 20
field_angle_deg = 40
emitters = [
  { name = "red", xy = [0.64, 0.33], lumens = 150 },
  { name = "green", xy = [0.30, 0.60], lumens = 300 },
  { name = "blue", xy = [0.15, 0.06], lumens = 50 },
]
[[bus]]
name = "dmx"
driver = "sacn"
[[fixture]]
name = "still"
luminaire = "par"
position_m = [0, 0, 3]
bus = "dmx"
address = 1
slots = ["constant:255", "emitter:blue", "emitter:red", "unused", "emitter:green"]
[[fixture]]
name = "head"
luminaire = "par"
position_m = [1, 0, 3]
pan_deg = -90
tilt_deg = 90
bus = "dmx"
address = 6
slots = ["pan", "pan-fine", "tilt", "tilt-fine", "emitter:red", "emitter:green-fine", "emitter:green", "constant:200", "emitter:blue"]
)";

TEST(EmittersOnTheWire, EachHasItsOwnSlotsAndSharesTheRest) {
  const Checked<Rig> rig = parse_rig(kStage, "stage.toml", ".");
  ASSERT_TRUE(rig) << rig.error().front().text();
  ASSERT_EQ(rig->fixtures.size(), 6u);
  DmxPatchbay bay(*rig, 0);
  const double drives[] = {0.2, 0.4, 0.6, 1, 0.5, 0.8};
  std::vector<LevelCommand> commands;
  for (std::size_t i = 0; i < 6; ++i) commands.push_back({i, drives[i]});
  ASSERT_TRUE(bay.set_levels(commands));
  const DmxSlots& slots = bay.universes()[0].slots;
  const std::vector<int> sent(slots.begin(), slots.begin() + 15);
  // red 0.2, green 0.4, blue 0.6 of "still"; pan 0x5555, tilt 0xD555, green 0x8000 of "head".
  EXPECT_EQ(sent, (std::vector<int>{255, 153, 51, 0, 102, 0x55, 0x55, 0xD5, 0x55, 255, 0x00, 0x80, 200, 204, 0}));
  for (std::size_t i = 0; i < 6; ++i) {
    const Fixture& fixture = rig->fixtures[i];
    const sim::DmxOrder order = sim::decode_slots(fixture, std::get<DmxPatch>(fixture.patch), slots);
    EXPECT_NEAR(order.drive, drives[i], 1e-4 + (i == 4 ? 0 : 0.5 / 255)) << fixture.name;
    ASSERT_EQ(order.joints.has_value(), i >= 3) << fixture.name;
    if (i < 3) continue;
    EXPECT_NEAR(deg_from_rad(order.joints->pan_rad), -90, 0.01) << fixture.name;
  }
  // One emitter alone changes only its own slot. A shutter that is not open shuts all emitters of its housing.
  DmxSlots before = slots;
  const LevelCommand alone[] = {{1, 1.0}};
  ASSERT_TRUE(bay.set_levels(alone));
  before[4] = 255;
  EXPECT_EQ(slots, before);
  before[12] = 0;
  for (std::size_t i = 3; i < 6; ++i) {
    const Fixture& fixture = rig->fixtures[i];
    EXPECT_EQ(sim::decode_slots(fixture, std::get<DmxPatch>(fixture.patch), before).drive, 0) << fixture.name;
  }
}

TEST(EmittersOnTheWire, AHeadIsAimedOnceForAllItsEmitters) {
  const Checked<Rig> rig = parse_rig(kStage, "stage.toml", ".");
  ASSERT_TRUE(rig) << rig.error().front().text();
  DmxPatchbay bay(*rig, 0);
  const AimCommand aims[] = {{3, {0, 0}}, {4, {0, 0}}, {5, {0, 0}}};
  ASSERT_TRUE(bay.set_aims(aims));
  ASSERT_TRUE(bay.set_levels({}));
  EXPECT_EQ(bay.universes()[0].slots[5], 0x80);
  // An order sent to a sibling by mistake does not reach the wire.
  const AimCommand stray[] = {{4, {1, 1}}};
  ASSERT_TRUE(bay.set_aims(stray));
  ASSERT_TRUE(bay.set_levels({}));
  EXPECT_EQ(bay.universes()[0].slots[5], 0x80);
}

}  // namespace
}  // namespace luxrig
