// A fixture with a maker's file, from the rig file through the DMX frame to the simulated fixture. The simulated
// fixture reads the frame only by the file's functions.
#include <gtest/gtest.h>

#include "core/rig/personality/personality.h"
#include "core/rig/rig_file.h"
#include "drivers/dmx/dmx_patch.h"
#include "sim/devices/dmx_fixture.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

Rig rig_of(const std::string& personality, const std::string& mode, const std::string& more = "",
           const std::string& luminaire = "lumens = 1000") {
  const std::string text = R"([rig]
name = "one"
[[luminaire]]
name = "lamp"
model = "spot"
beam_angle_deg = 20
field_angle_deg = 40
)" + luminaire + R"(
[[bus]]
name = "dmx"
driver = "sacn"
[[fixture]]
name = "it"
luminaire = "lamp"
position_m = [0, 0, 3]
bus = "dmx"
address = 21
personality = ")" + personality +
                           "\"\nmode = \"" + mode + "\"\n" + more;
  Checked<Rig> rig = parse_rig(text, "rig.toml", test::source_folder() / "tests/data/fixtures");
  EXPECT_TRUE(rig) << rig.error().front().text();
  return rig ? std::move(*rig) : Rig{};
}

sim::DmxOrder seen_by(const Rig& rig, std::size_t fixture, const DmxSlots& slots) {
  return sim::decode_slots(rig.fixtures[fixture], std::get<DmxPatch>(rig.fixtures[fixture].patch), slots);
}

void light_and_turn(const Rig& rig, double slack) {
  ASSERT_FALSE(rig.fixtures.empty());
  DmxPatchbay bay(rig, 0);
  for (const double drive : {0.0, 0.001, 0.25, 0.5, 0.75, 1.0}) {
    std::vector<LevelCommand> levels;
    for (std::size_t i = 0; i < rig.fixtures.size(); ++i) levels.push_back({i, drive});
    ASSERT_TRUE(bay.set_levels(levels));
    for (std::size_t i = 0; i < rig.fixtures.size(); ++i)
      EXPECT_NEAR(seen_by(rig, i, bay.universes()[0].slots).drive, drive, slack) << rig.fixtures[i].name;
  }
  const Fixture& head = rig.fixtures[0];
  if (!head.moves) return;
  for (const double share : {0.0, 0.1, 0.5, 0.9, 1.0}) {
    const Joints wanted{head.range.pan_min_rad + share * (head.range.pan_max_rad - head.range.pan_min_rad),
                        head.range.tilt_max_rad + share * (head.range.tilt_min_rad - head.range.tilt_max_rad)};
    const AimCommand aims[] = {{0, wanted}};
    ASSERT_TRUE(bay.set_aims(aims));
    ASSERT_TRUE(bay.set_levels({}));
    const sim::DmxOrder order = seen_by(rig, 0, bay.universes()[0].slots);
    ASSERT_TRUE(order.joints);
    EXPECT_NEAR(deg_from_rad(order.joints->pan_rad), deg_from_rad(wanted.pan_rad), 540 * slack);
    EXPECT_NEAR(deg_from_rad(order.joints->tilt_rad), deg_from_rad(wanted.tilt_rad), 540 * slack);
  }
}

TEST(PersonalityOnTheWire, EverySampleGivesTheIntendedLightAndAim) {
  constexpr double k8Bit = 0.5 / 255 + 1e-9, k16Bit = 0.5 / 65535 + 1e-9;
  light_and_turn(rig_of("Clay Paky@Alpha Spot QWO 800.gdtf", "Standard Mode (32 ch)"), k16Bit);
  light_and_turn(rig_of("Robe@BMFL Spot.gdtf", "Mode 1 - Standard 16 bit"), k16Bit);
  light_and_turn(rig_of("Robe@BMFL Spot.gdtf", "Mode 2 - Reduced 8 bit"), k8Bit);
  light_and_turn(rig_of("Robe_Lighting@Robin_MMX_Blade@2023-07-25__Beam_revision.gdtf", "Mode 1 - Standard"), k16Bit);
  light_and_turn(rig_of("Robe@Robin 100 LEDBeam.gdtf", "mode 2"), k16Bit);
  light_and_turn(rig_of("BlenderDMX@LED_PAR_64_RGBW@v0.3.gdtf", "Default"), k8Bit);
  light_and_turn(rig_of("Robe ColorWash 2500 AT.gdtf", "DMX Mode"), k8Bit);
  light_and_turn(rig_of("ofl/martin/mac-700-wash.json", "Extended 23-channel"), k16Bit);
  light_and_turn(rig_of("ofl/generic/4-channel-dimmer-pack.json", "4-channel"), k8Bit);
}

// Alpha Spot QWO 800: 55° at 0, 11° at 255.
TEST(PersonalityOnTheWire, AZoomGivesTheIntendedBeam) {
  const Rig rig = rig_of("Clay Paky@Alpha Spot QWO 800.gdtf", "Standard Mode (32 ch)", "zoom_speed_deg_s = 12\n",
                         "lumens = 1000\nzoom_deg = [5, 40]");
  ASSERT_EQ(rig.fixtures.size(), 1u);
  const Fixture& head = rig.fixtures[0];
  EXPECT_NEAR(deg_from_rad(head.range.beam_min_rad), 11, 1e-9) << "what both can do";
  EXPECT_NEAR(deg_from_rad(head.range.beam_max_rad), 40, 1e-9);
  EXPECT_NEAR(deg_from_rad(head.zoom_speed_rad_s), 12, 1e-9);
  DmxPatchbay bay(rig, 0);
  constexpr std::size_t kZoom = 20 + 21;
  EXPECT_EQ(bay.universes()[0].slots[kZoom], 203) << "20° at 255 · 35/44";
  for (const double beam_deg : {11.0, 17.5, 40.0}) {
    const AimCommand aim{0, {0, 0, rad_from_deg(beam_deg)}};
    ASSERT_TRUE(bay.set_aims({&aim, 1}));
    ASSERT_TRUE(bay.set_levels({}));
    EXPECT_EQ(bay.universes()[0].slots[kZoom], std::lround(255 * (55 - beam_deg) / 44)) << beam_deg;
    const sim::DmxOrder order = seen_by(rig, 0, bay.universes()[0].slots);
    ASSERT_TRUE(order.joints);
    EXPECT_NEAR(deg_from_rad(order.joints->beam_rad), beam_deg, 44.0 / 255 / 2 + 1e-9);
  }
}

TEST(PersonalityOnTheWire, EmittersAreMixedIndividually) {
  const std::string emitters =
      "emitters = [{ name = \"red\", lumens = 100 }, { name = \"green\", lumens = 300 }, { name = \"blue\", lumens = "
      "50 "
      "}, { name = \"white\", lumens = 400 }]";
  for (const auto& [file, mode, slack] : {std::tuple("BlenderDMX@LED_PAR_64_RGBW@v0.3.gdtf", "Default", 0.5 / 255),
                                          std::tuple("Robe@Robin 100 LEDBeam.gdtf", "mode 2", 0.5 / 65535)}) {
    const Rig rig = rig_of(file, mode, "", emitters);
    ASSERT_EQ(rig.fixtures.size(), 4u);
    DmxPatchbay bay(rig, 0);
    const double drives[] = {0.1, 0.9, 0, 0.4};
    std::vector<LevelCommand> levels;
    for (std::size_t i = 0; i < 4; ++i) levels.push_back({i, drives[i]});
    ASSERT_TRUE(bay.set_levels(levels));
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_NEAR(seen_by(rig, i, bay.universes()[0].slots).drive, drives[i], slack + 1e-9) << file << i;
  }
}

TEST(PersonalityOnTheWire, AClosedShutterAStrobeAndAnUnstruckLampAreDark) {
  const Rig rig = rig_of("Clay Paky@Alpha Spot QWO 800.gdtf", "Standard Mode (32 ch)");
  DmxPatchbay bay(rig, 0);
  const LevelCommand full[] = {{0, 1.0}};
  ASSERT_TRUE(bay.set_levels(full));
  DmxSlots slots = bay.universes()[0].slots;
  EXPECT_EQ(seen_by(rig, 0, slots).drive, 1);
  constexpr std::size_t kShutter = 20 + 6, kLamp = 20 + 31, kColourWheel = 20 + 4;
  for (const int dark : {0, 3, 4, 50, 103, 150, 220}) {
    slots[kShutter] = static_cast<std::uint8_t>(dark);
    EXPECT_EQ(seen_by(rig, 0, slots).drive, 0) << dark;
  }
  for (const int open : {104, 107, 208, 255}) {
    slots[kShutter] = static_cast<std::uint8_t>(open);
    EXPECT_EQ(seen_by(rig, 0, slots).drive, 1) << open;
  }
  for (const int off : {0, 26, 100, 179}) {
    slots[kLamp] = static_cast<std::uint8_t>(off);
    EXPECT_EQ(seen_by(rig, 0, slots).drive, 0) << off;
  }
  slots[kLamp] = 180;
  EXPECT_EQ(seen_by(rig, 0, slots).drive, 1);
  slots[kColourWheel] = 40;
  EXPECT_EQ(seen_by(rig, 0, slots).drive, 1) << "colour is not modelled";
}

TEST(PersonalityOnTheWire, TwentyFourBitsArriveWhole) {
  Rig rig = rig_of("BlenderDMX@LED_PAR_64_RGBW@v0.3.gdtf", "Default");
  Fixture& fixture = rig.fixtures[0];
  fixture.mode.reset();
  std::get<DmxPatch>(fixture.patch).slots = {{SlotUse::dimmer_fine}, {SlotUse::dimmer}, {SlotUse::dimmer_ultra}};
  DmxPatchbay bay(rig, 0);
  const LevelCommand level[] = {{0, 0x123456 / 16777215.0}};
  ASSERT_TRUE(bay.set_levels(level));
  const DmxSlots& slots = bay.universes()[0].slots;
  EXPECT_EQ(slots[20], 0x34);
  EXPECT_EQ(slots[21], 0x12);
  EXPECT_EQ(slots[22], 0x56);
  EXPECT_NEAR(seen_by(rig, 0, slots).drive, 0x123456 / 16777215.0, 1e-12);
}

}  // namespace
}  // namespace luxrig
