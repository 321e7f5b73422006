// From a mode to the slots of a fixture: slots that carry the light, and slots held at a value. Numbers are those of
// the sample files.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/rig/personality/held_values.h"
#include "core/rig/personality/personality_file.h"
#include "core/rig/rig_file.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

const std::filesystem::path kFixtureFiles = test::source_folder() / "tests/data/fixtures";

/// A rig of one fixture with a personality, in the folder of the samples.
Checked<Rig> rig_with_fixture(const std::string& fixture, const std::string& luminaire = "lumens = 1000") {
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
address = 11
)" + fixture;
  return parse_rig(text, "rig.toml", kFixtureFiles);
}

Rig good_rig(const std::string& fixture, const std::string& luminaire = "lumens = 1000") {
  Checked<Rig> rig = rig_with_fixture(fixture, luminaire);
  EXPECT_TRUE(rig) << rig.error().front().text();
  return rig ? std::move(*rig) : Rig{};
}

const std::vector<DmxSlot>& slots_in(const Rig& rig, std::size_t fixture = 0) {
  return std::get<DmxPatch>(rig.fixtures.at(fixture).patch).slots;
}

std::string first_problem(const std::string& fixture, const std::string& luminaire = "lumens = 1000") {
  const Checked<Rig> rig = rig_with_fixture(fixture, luminaire);
  return rig ? "accepted" : rig.error().front().text();
}

TEST(ModeSlots, AHeadHasItsAxesItsDimmerAndItsShutter) {
  const Rig rig = good_rig("personality = \"Clay Paky@Alpha Spot QWO 800.gdtf\"\n");
  ASSERT_EQ(rig.fixtures.size(), 1u);
  const Fixture& head = rig.fixtures[0];
  const std::vector<DmxSlot>& slots = slots_in(rig);
  ASSERT_EQ(slots.size(), 32u);
  EXPECT_EQ(slots[7].use, SlotUse::dimmer);
  EXPECT_EQ(slots[8].use, SlotUse::dimmer_fine);
  EXPECT_EQ(slots[25].use, SlotUse::pan);
  EXPECT_EQ(slots[26].use, SlotUse::pan_fine);
  EXPECT_EQ(slots[27].use, SlotUse::tilt);
  EXPECT_TRUE(head.moves);
  EXPECT_NEAR(deg_from_rad(head.range.pan_min_rad), -270, 1e-9);
  EXPECT_NEAR(deg_from_rad(head.range.tilt_max_rad), 125, 1e-9);
  EXPECT_EQ(slots[25].travel.at_start, 1) << "its pan is 270 at DMX 0";
  EXPECT_EQ(slots[25].travel.at_end, 0);
  EXPECT_EQ(slots[27].travel.at_start, 0);
  EXPECT_EQ(slots[6].constant_dmx, 104) << "shutter, open by default";
  EXPECT_EQ(slots[9].constant_dmx, 128) << "iris, its default";
  EXPECT_EQ(slots[31].constant_dmx, 217) << "lamp on: 180 to 255";
  // Zoom 55° at 0, 11° at 255: 20° at 255 · 35/44.
  EXPECT_EQ(slots[21].constant_dmx, 203);
}

TEST(ModeSlots, AShutterClosedByDefaultIsOpened) {
  // MAC 700: closed 0 to 19, open 20 to 49. The same channel strikes its lamp, so that stays manual.
  const Rig rig = good_rig("personality = \"ofl/martin/mac-700-wash.json\"\nmode = \"Extended 23-channel\"\n");
  ASSERT_FALSE(rig.fixtures.empty());
  EXPECT_EQ(slots_in(rig)[0].constant_dmx, 34);
  const std::vector<std::string>& told = rig.fixtures[0].mode->told;
  EXPECT_TRUE(std::any_of(told.begin(), told.end(), [](const std::string& line) {
    return line.find("strike its lamp by hand") != std::string::npos;
  }));
}

TEST(ModeSlots, EmittersOfTheLuminaireAreMixedAndTheMasterIsHeldFull) {
  const Rig rig = good_rig("personality = \"BlenderDMX@LED_PAR_64_RGBW@v0.3.gdtf\"\nmode = \"Default\"\n",
                           "emitters = [{ name = \"White\", lumens = 400 }, { name = \"red\", lumens = 100 }]");
  ASSERT_EQ(rig.fixtures.size(), 2u);
  EXPECT_EQ(rig.fixtures[1].mode->emitter, "red");
  const std::vector<DmxSlot>&white = slots_in(rig, 0), &red = slots_in(rig, 1);
  EXPECT_EQ(white[0].use, SlotUse::constant);
  EXPECT_EQ(white[0].constant_dmx, 255);
  EXPECT_EQ(white[4].use, SlotUse::dimmer);
  EXPECT_EQ(red[1].use, SlotUse::dimmer);
  EXPECT_EQ(red[4].use, SlotUse::unused);
  EXPECT_EQ(white[2].constant_dmx, 0) << "green is the fixture's, not the luminaire's; its default is 255";
  EXPECT_TRUE(white[2].sent);
  EXPECT_FALSE(red[2].sent);
}

TEST(ModeSlots, ColoursWithoutEmittersAreHeldFullOrFollowTheLevel) {
  const Rig dimmed = good_rig("personality = \"BlenderDMX@LED_PAR_64_RGBW@v0.3.gdtf\"\n");
  EXPECT_EQ(slots_in(dimmed)[0].use, SlotUse::dimmer);
  EXPECT_EQ(slots_in(dimmed)[4].constant_dmx, 255) << "white, which is dark by default";
  const Rig cells = good_rig("personality = \"ofl/generic/4-channel-dimmer-pack.json\"\nmode = \"4-channel\"\n");
  for (const DmxSlot& slot : slots_in(cells)) EXPECT_EQ(slot.use, SlotUse::dimmer);
  EXPECT_NE(slots_in(cells)[0].cell, slots_in(cells)[3].cell);
}

TEST(ModeSlots, TheRigFileMayNarrowTheTravel) {
  const Rig rig = good_rig(
      "personality = \"Clay Paky@Alpha Spot QWO 800.gdtf\"\npan_range_deg = [-90, 180]\ntilt_range_deg = [0, 125]\n");
  const std::vector<DmxSlot>& slots = slots_in(rig);
  // 270 at 0, -270 at full: -90 lies at 360/540 of the travel, 180 at 90/540.
  EXPECT_NEAR(slots[25].travel.at_start, 360.0 / 540, 1e-12);
  EXPECT_NEAR(slots[25].travel.at_end, 90.0 / 540, 1e-12);
  EXPECT_NEAR(slots[27].travel.at_start, 0.5, 1e-12);
  EXPECT_EQ(slots[27].travel.at_end, 1);
  EXPECT_NE(first_problem("personality = \"Clay Paky@Alpha Spot QWO 800.gdtf\"\npan_range_deg = [-300, 180]\n")
                .find("goes beyond the -270 to 270"),
            std::string::npos);
}

TEST(ModeSlots, APlaceholderTravelIsReplacedByTheRigFiles) {
  // Robe ColorWash 2500 AT: pan and tilt 0 to 1.
  const Rig rig = good_rig("personality = \"Robe ColorWash 2500 AT.gdtf\"\npan_range_deg = [-265, 265]\n");
  EXPECT_NEAR(deg_from_rad(rig.fixtures.at(0).range.pan_max_rad), 265, 1e-9);
  EXPECT_NEAR(deg_from_rad(rig.fixtures[0].range.tilt_max_rad), 135, 1e-9);
  EXPECT_EQ(slots_in(rig)[1].travel.at_end, 1);
}

TEST(ModeSlots, TwentyFourBitsAreThreeSlots) {
  EXPECT_NE(first_problem("personality = \"ofl/generic/pan-tilt.json\"\nmode = \"24 bit\"\n").find("has no dimmer"),
            std::string::npos);
  const std::string hand =
      "slots = [\"dimmer\", \"dimmer-ultra\", \"dimmer-fine\", \"pan\", \"pan-fine\", \"pan-ultra\", \"tilt\"]\n";
  EXPECT_EQ(slots_in(good_rig(hand))[1].use, SlotUse::dimmer_ultra);
  EXPECT_NE(first_problem("slots = [\"dimmer\", \"dimmer-ultra\"]\n").find("without a dimmer-fine slot"),
            std::string::npos);
}

TEST(ModeSlots, UnknownModesAndEmittersNameTheNearest) {
  const std::string mode = first_problem("personality = \"Robe@BMFL Spot.gdtf\"\nmode = \"Mode 1 - Standard 8 bit\"\n");
  EXPECT_NE(mode.find("\"Mode 1 - Standard 16 bit\", \"Mode 2 - Reduced 8 bit\""), std::string::npos) << mode;
  EXPECT_NE(mode.find("did you mean"), std::string::npos) << mode;
  EXPECT_EQ(mode.find("rig.toml:19:8"), 0u) << mode;
  const std::string none = first_problem("personality = \"Robe@BMFL Spot.gdtf\"\n");
  EXPECT_NE(none.find("has 2 modes, and none is chosen"), std::string::npos) << none;
  const std::string emitter = first_problem("personality = \"BlenderDMX@LED_PAR_64_RGBW@v0.3.gdtf\"\n",
                                            "emitters = [{ name = \"amber\", lumens = 400 }]");
  EXPECT_NE(emitter.find("has no emitter \"amber\""), std::string::npos) << emitter;
}

TEST(HeldValues, MeetTheConditionsOfOtherChannels) {
  // LEDBeam: its colours exist only while the virtual colour wheel is at 0, its open place.
  const Checked<Personality> beam = load_personality(kFixtureFiles / "Robe@Robin 100 LEDBeam.gdtf");
  ASSERT_TRUE(beam);
  const PersonalityMode& mode = beam->modes[0];
  const HeldValues held = held_values(mode, std::nullopt);
  for (std::size_t c = 0; c < mode.channels.size(); ++c) {
    if (mode.channels[c].name == "Head_Color1") {
      EXPECT_EQ(held.dmx[c], 0u);
    }
    if (mode.channels[c].name != "Beam_ColorAdd_R") continue;
    const auto* red = active_function(mode.channels[c], held.dmx, [](const ChannelFunction&) { return true; });
    ASSERT_NE(red, nullptr);
    EXPECT_EQ(red->attribute, "ColorAdd_R");
  }
}

TEST(ModeSlots, EverySampleModeFitsOrReportsWhyNot) {
  std::size_t fitted = 0, refused = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kFixtureFiles)) {
    if (entry.path().extension() != ".gdtf" && entry.path().extension() != ".json") continue;
    const Checked<Personality> personality = load_personality(entry.path());
    if (!personality) continue;
    for (const PersonalityMode& mode : personality->modes) {
      const Checked<Rig> rig =
          rig_with_fixture("personality = \"" + std::filesystem::relative(entry.path(), kFixtureFiles).string() +
                           "\"\nmode = \"" + mode.name + "\"\n");
      if (rig) {
        EXPECT_EQ(slots_in(*rig).size(), static_cast<std::size_t>(mode.footprint()));
        EXPECT_FALSE(rig->fixtures[0].mode->told.empty());
        ++fitted;
      } else {
        EXPECT_NE(rig.error()[0].what.find(mode.name), std::string::npos) << rig.error()[0].text();
        ++refused;
      }
    }
  }
  EXPECT_GE(fitted, 30u);
  EXPECT_LE(refused, 8u) << "modes without a dimmer: pan and tilt alone, built-in shows";
}

}  // namespace
}  // namespace luxrig
