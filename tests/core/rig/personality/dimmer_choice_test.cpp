// Choice of the dimmer channel in a maker's file, and the value sent at a level. These files are made for the test,
// after products whose files misled an earlier reader.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "core/rig/personality/gdtf/gdtf_file.h"
#include "core/rig/personality/ofl/ofl_file.h"
#include "core/rig/reading/mode_slots.h"
#include "core/rig/rig_file.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

std::string ofl_of(const std::string& channels, const std::string& names) {
  return R"({"$schema": "https://raw.githubusercontent.com/OpenLightingProject/open-fixture-library/master/schemas/fixture.json",
  "name": "x", "availableChannels": {)" +
         channels + R"(}, "modes": [{"name": "m", "channels": [)" + names + "]}]}";
}

/// A mode fitted as one light, or the reason why it cannot be.
struct Fitted {
  std::optional<ModeSlots> slots;
  std::string problem;

  /// Value of a slot at a level.
  int sent(std::size_t slot, double level) const {
    const DmxSlot& s = slots->slots.at(slot).slot;
    if (s.use == SlotUse::constant) return s.constant_dmx;
    return static_cast<int>(std::lround(s.travel.at(level) * 255));
  }
  bool told(const std::string& text) const {
    return std::any_of(slots->told.begin(), slots->told.end(),
                       [&](const std::string& line) { return line.find(text) != std::string::npos; });
  }
};

Fitted fit(const Checked<Personality>& personality, const std::string& dimmer = "",
           const std::vector<std::string>& emitters = {}) {
  if (!personality) return {std::nullopt, personality.error().front().text()};
  ProblemList problems("x");
  ModeWanted wanted;
  wanted.owner = SlotOwner{"lamp", emitters};
  wanted.beam_deg = 20;
  wanted.dimmer = dimmer;
  Fitted out{slots_of_mode(*personality, personality->modes.at(0), wanted, problems), ""};
  if (!out.slots) out.problem = problems.take().front().text();
  return out;
}
Fitted fit_ofl(const std::string& channels, const std::string& names, const std::string& dimmer = "") {
  return fit(parse_ofl(ofl_of(channels, names), "m", "x"), dimmer);
}

std::string gdtf_of(const std::string& channels) {
  return R"(<GDTF DataVersion="1.2"><FixtureType Name="x" Manufacturer="m"><Geometries><Geometry Name="Base">
    <Beam Name="Lens"/></Geometry></Geometries><DMXModes><DMXMode Name="m" Geometry="Base"><DMXChannels>)" +
         channels + "</DMXChannels></DMXMode></DMXModes></FixtureType></GDTF>";
}
std::string gdtf_channel(int slot, const std::string& logical) {
  return "<DMXChannel Geometry=\"Base\" Offset=\"" + std::to_string(slot) + "\">" + logical + "</DMXChannel>";
}

// As showtec/dim-4lc, channel "Switch": level 1 sent 127, which is off.
TEST(DimmerChoice, ASwitchIsOffAtLevel0AndOnAtLevel1) {
  const std::string channel = R"("Switch": {"capabilities": [
      {"dmxRange": [0, 127], "type": "Intensity", "brightness": "off"},
      {"dmxRange": [128, 255], "type": "Intensity", "brightness": "bright"}]})";
  const Fitted pack = fit_ofl(channel, "\"Switch\"");
  ASSERT_TRUE(pack.slots) << pack.problem;
  EXPECT_EQ(pack.sent(0, 1), 255);
  EXPECT_EQ(pack.sent(0, 0), 0);
  EXPECT_TRUE(pack.slots->steps);
  EXPECT_TRUE(pack.told("it is switched"));
}

TEST(DimmerChoice, AnOnOffModeMakesAFixtureSwitched) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "luxrig_switch_mode";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "switch.json") << ofl_of(R"("Switch": {"capabilities": [
      {"dmxRange": [0, 127], "type": "Intensity", "brightness": "off"},
      {"dmxRange": [128, 255], "type": "Intensity", "brightness": "bright"}]})",
                                                  "\"Switch\"");
  const std::string text = R"([rig]
name = "one"
[[luminaire]]
name = "lamp"
model = "isotropic"
lumens = 100
[[bus]]
name = "dmx"
driver = "sacn"
[[fixture]]
name = "it"
luminaire = "lamp"
position_m = [0, 0, 3]
bus = "dmx"
address = 1
personality = "switch.json"
)";
  const Checked<Rig> rig = parse_rig(text, "rig.toml", folder);
  ASSERT_TRUE(rig) << rig.error().front().text();
  EXPECT_TRUE(rig->fixtures.at(0).switched);
  const Checked<Rig> dims = parse_rig(text + "switched = false\n", "rig.toml", folder);
  ASSERT_FALSE(dims);
  EXPECT_NE(dims.error().front().text().find("the dimmer of this mode is on or off"), std::string::npos);
  std::filesystem::remove_all(folder);
}

// As Ayrton's MagicBlade FX: "Blackout", in a corner of the speed slot, has the attribute Dimmer. It was taken for the
// dimmer, and the real one was held at 255.
TEST(DimmerChoice, ABlackoutInASpeedSlotIsNoDimmer) {
  const std::string speed =
      R"(<LogicalChannel Attribute="PositionMSpeed"><ChannelFunction Name="Speed" Attribute="PositionMSpeed"/>
         </LogicalChannel><LogicalChannel Attribute="Dimmer">
         <ChannelFunction Name="CORNER" Attribute="Dimmer" DMXFrom="226/1" PhysicalFrom="0" PhysicalTo="1"/>
         <ChannelFunction Name="None" Attribute="NoFeature" DMXFrom="236/1"/></LogicalChannel>)";
  const std::string dimmer =
      R"(<LogicalChannel Attribute="Dimmer"><ChannelFunction Name="Dimmer" Attribute="Dimmer"/></LogicalChannel>)";
  for (const std::string name : {"Blackout by movement", "Dark while moving"}) {
    std::string named = speed;
    named.replace(named.find("CORNER"), 6, name);
    const Fitted blade = fit(parse_gdtf_description(gdtf_of(gdtf_channel(1, named) + gdtf_channel(2, dimmer)), "x"));
    ASSERT_TRUE(blade.slots) << blade.problem;
    EXPECT_EQ(blade.sent(0, 1), 0) << "speed, its default";
    EXPECT_EQ(blade.sent(1, 0), 0);
    EXPECT_EQ(blade.sent(1, 0.5), 128);
    EXPECT_EQ(blade.sent(1, 1), 255);
    const Fitted corner = fit(parse_gdtf_description(gdtf_of(gdtf_channel(1, named)), "x"));
    EXPECT_FALSE(corner.slots);
    EXPECT_NE(corner.problem.find("has no dimmer"), std::string::npos) << corner.problem;
    EXPECT_NE(corner.problem.find("at 226 to 235"), std::string::npos) << corner.problem;
  }
}

const char* const kTwoDimmers = R"("Color Presets Dimmer": {"defaultValue": 0, "capability": {"type": "Intensity"}},
    "Dimmer": {"defaultValue": 7, "capability": {"type": "Intensity"}})";

// As elation/platinum-seven: the first channel was taken, which only dims built-in colours, so no limit held.
TEST(DimmerChoice, TwoPossibleDimmersAreRefusedAndNamed) {
  const Fitted seven = fit_ofl(kTwoDimmers, R"("Color Presets Dimmer", "Dimmer")");
  ASSERT_FALSE(seven.slots);
  EXPECT_NE(seven.problem.find("\"Color Presets Dimmer\" (slot 1) and \"Dimmer\" (slot 2)"), std::string::npos)
      << seven.problem;
  EXPECT_NE(seven.problem.find("dimmer ="), std::string::npos) << seven.problem;
  const Fitted mixed = fit(
      parse_ofl(
          ofl_of(std::string(kTwoDimmers) + R"(, "Red": {"capability": {"type": "ColorIntensity", "color": "Red"}})",
                 R"("Color Presets Dimmer", "Dimmer", "Red")"),
          "m", "x"),
      "", {"red"});
  EXPECT_FALSE(mixed.slots) << "held full beside emitters, it would be a guess as well";
}

// As in 84 modes of the Open Fixture Library.
TEST(DimmerChoice, HueAndSaturationAreNotDimmersDespiteTheirIntensityType) {
  const Fitted lamp = fit_ofl(R"("Hue 1": {"defaultValue": 3, "capability": {"type": "Intensity"}},
      "Saturation 1": {"capability": {"type": "Intensity"}}, "Intensity 1": {"capability": {"type": "Intensity"}})",
                              R"("Hue 1", "Saturation 1", "Intensity 1")");
  ASSERT_TRUE(lamp.slots) << lamp.problem;
  EXPECT_EQ(lamp.sent(0, 1), 3);
  EXPECT_EQ(lamp.sent(1, 1), 0);
  EXPECT_EQ(lamp.sent(2, 1), 255);
  EXPECT_EQ(lamp.sent(2, 0), 0);
}

TEST(DimmerChoice, TheRigFileChoosesAndTheOtherKeepsItsDefault) {
  const Fitted dimmer = fit_ofl(kTwoDimmers, R"("Color Presets Dimmer", "Dimmer")", "Dimmer");
  ASSERT_TRUE(dimmer.slots) << dimmer.problem;
  EXPECT_EQ(dimmer.sent(0, 1), 0);
  EXPECT_EQ(dimmer.sent(1, 1), 255);
  EXPECT_EQ(dimmer.sent(1, 0), 0);
  EXPECT_TRUE(dimmer.told("\"Color Presets Dimmer\" is another dimmer"));
  const Fitted presets = fit_ofl(kTwoDimmers, R"("Color Presets Dimmer", "Dimmer")", "Color Presets Dimmer");
  ASSERT_TRUE(presets.slots) << presets.problem;
  EXPECT_EQ(presets.sent(0, 1), 255);
  EXPECT_EQ(presets.sent(1, 1), 7);
  const Fitted unknown = fit_ofl(kTwoDimmers, R"("Color Presets Dimmer", "Dimmer")", "Dimer");
  ASSERT_FALSE(unknown.slots);
  EXPECT_NE(unknown.problem.find("has no dimmer \"Dimer\""), std::string::npos) << unknown.problem;
  EXPECT_NE(unknown.problem.find("\"Dimmer\""), std::string::npos) << unknown.problem;
}

// As Capture writes it for a fixture without a file: all slots but the first were held at 255.
TEST(DimmerChoice, APlaceholderWhoseEverySlotIsADimmerIsRefused) {
  std::string channels;
  for (int i = 1; i <= 12; ++i) {
    const std::string attribute = "Dimmer" + std::to_string(i);
    channels += gdtf_channel(i, "<LogicalChannel Attribute=\"" + attribute + "\"><ChannelFunction Name=\"" + attribute +
                                    "\" Attribute=\"" + attribute + "\" Default=\"255/1\"/></LogicalChannel>");
  }
  const Fitted stand_in = fit(parse_gdtf_description(gdtf_of(channels), "x"));
  ASSERT_FALSE(stand_in.slots);
  EXPECT_NE(stand_in.problem.find("calls all of its 12 slots dimmers"), std::string::npos) << stand_in.problem;
  EXPECT_NE(stand_in.problem.find("does not say what any slot does"), std::string::npos) << stand_in.problem;
  EXPECT_NE(stand_in.problem.find("get the maker's GDTF file"), std::string::npos) << stand_in.problem;
}

TEST(DimmerChoice, LevelsUseTheDimmersOwnRangeAboveItsMinimumLight) {
  // Dark up to 15, then from a tenth of the light up.
  const Fitted lamp = fit_ofl(R"("D": {"capabilities": [
      {"dmxRange": [0, 15], "type": "Intensity", "brightness": "off"},
      {"dmxRange": [16, 215], "type": "Intensity", "brightnessStart": "10%", "brightnessEnd": "100%"},
      {"dmxRange": [216, 255], "type": "ShutterStrobe", "shutterEffect": "Strobe"}]})",
                              "\"D\"");
  ASSERT_TRUE(lamp.slots) << lamp.problem;
  EXPECT_EQ(lamp.sent(0, 0), 0);
  EXPECT_EQ(lamp.sent(0, 0.05), 0) << "5 % is less than its least: it must not give 10";
  EXPECT_EQ(lamp.sent(0, 0.1), 16);
  EXPECT_EQ(lamp.sent(0, 0.55), 116) << "half way from 10 to 100 %, so half way from 16 to 215";
  EXPECT_EQ(lamp.sent(0, 1), 215);
}

TEST(DimmerChoice, AReversedDimmerIsBrightAtItsLowEnd) {
  const Fitted lamp = fit_ofl(R"("D": {"capability":
      {"type": "Intensity", "brightnessStart": "bright", "brightnessEnd": "off"}})",
                              "\"D\"");
  ASSERT_TRUE(lamp.slots) << lamp.problem;
  EXPECT_EQ(lamp.sent(0, 1), 0);
  EXPECT_EQ(lamp.sent(0, 0.25), 191);
  EXPECT_EQ(lamp.sent(0, 0), 255);
}

TEST(DimmerChoice, AShutterClosesAtLevel0WhenTheDimmerIsNeverDark) {
  const std::string dimmer = R"("D": {"capability":
      {"type": "Intensity", "brightnessStart": "dark", "brightnessEnd": "bright"}})";
  const std::string shutter = R"(, "S": {"defaultValue": 40, "capabilities": [
      {"dmxRange": [0, 31], "type": "ShutterStrobe", "shutterEffect": "Closed"},
      {"dmxRange": [32, 255], "type": "ShutterStrobe", "shutterEffect": "Open"}]})";
  const Fitted both = fit_ofl(dimmer + shutter, R"("D", "S")");
  ASSERT_TRUE(both.slots) << both.problem;
  EXPECT_EQ(both.sent(1, 0), 15);
  EXPECT_EQ(both.sent(1, 0.01), 40);
  EXPECT_EQ(both.sent(1, 1), 40);
  const Fitted alone = fit_ofl(dimmer, "\"D\"");
  ASSERT_TRUE(alone.slots) << alone.problem;
  EXPECT_TRUE(alone.told("1 % of its light at level 0"));
}

TEST(DimmerChoice, AStrobeIsHeldAtItsNeutralValue) {
  const Fitted lamp =
      fit_ofl(R"("D": {"capability": {"type": "Intensity"}}, "S": {"defaultValue": 200, "capabilities": [
      {"dmxRange": [0, 9], "type": "NoFunction"},
      {"dmxRange": [10, 255], "type": "ShutterStrobe", "shutterEffect": "Strobe"}]})",
              R"("D", "S")");
  ASSERT_TRUE(lamp.slots) << lamp.problem;
  EXPECT_EQ(lamp.sent(1, 1), 4);
}

TEST(DimmerChoice, AZoomStatedOnlyInWordsIsReported) {
  const Fitted lamp = fit_ofl(R"("D": {"capability": {"type": "Intensity"}}, "Zoom": {"defaultValue": 9, "capability":
      {"type": "Zoom", "angleStart": "wide", "angleEnd": "narrow"}})",
                              R"("D", "Zoom")");
  ASSERT_TRUE(lamp.slots) << lamp.problem;
  EXPECT_EQ(lamp.sent(1, 1), 9);
  EXPECT_TRUE(
      lamp.told("\"Zoom\" stays at its default 9: its file states no angles but \"wide to narrow\", so set it "
                "to the luminaire's 20° by hand"));
}

TEST(DimmerChoice, PixelDimmersAreFullUnderAMasterAndFollowWithoutOne) {
  const std::string geometry =
      R"(<GDTF DataVersion="1.2"><FixtureType Name="x" Manufacturer="m"><Geometries><Geometry Name="Base">
    <Beam Name="A"/><Beam Name="B"/></Geometry></Geometries><DMXModes><DMXMode Name="m" Geometry="Base"><DMXChannels>)";
  const auto dimmer = [](const std::string& part, int slot) {
    return "<DMXChannel Geometry=\"" + part + "\" Offset=\"" + std::to_string(slot) +
           "\"><LogicalChannel Attribute=\"Dimmer\"><ChannelFunction/></LogicalChannel></DMXChannel>";
  };
  const std::string end = "</DMXChannels></DMXMode></DMXModes></FixtureType></GDTF>";
  const Fitted pixels = fit(parse_gdtf_description(geometry + dimmer("A", 1) + dimmer("B", 2) + end, "x"));
  ASSERT_TRUE(pixels.slots) << pixels.problem;
  EXPECT_EQ(pixels.sent(0, 0.2), 51);
  EXPECT_EQ(pixels.sent(1, 0.2), 51);
  const Fitted master =
      fit(parse_gdtf_description(geometry + dimmer("A", 1) + dimmer("B", 2) + dimmer("Base", 3) + end, "x"));
  ASSERT_TRUE(master.slots) << master.problem;
  EXPECT_EQ(master.sent(0, 0), 255);
  EXPECT_EQ(master.sent(1, 0), 255);
  EXPECT_EQ(master.sent(2, 0.2), 51);
}

const char* const kParWithItsFile = R"([rig]
name = "one"
[[luminaire]]
name = "par"
model = "spot"
KEYS
[[bus]]
name = "dmx"
driver = "sacn"
[[fixture]]
name = "it"
luminaire = "par"
position_m = [0, 0, 3]
bus = "dmx"
address = 1
personality = "BlenderDMX@LED_PAR_64_RGBW@v0.3.gdtf"
)";

Checked<Rig> par_with(const std::string& keys) {
  std::string text = kParWithItsFile;
  text.replace(text.find("KEYS"), 4, keys);
  return parse_rig(text, "rig.toml", test::source_folder() / "tests/data/fixtures");
}

TEST(StatedLight, OfAGdtfFileIsUsedAndReportedWhenTheRigFileHasNone) {
  const Checked<Rig> rig = par_with("");
  ASSERT_TRUE(rig) << rig.error().front().text();
  const Luminaire& par = rig->luminaires.at(0);
  EXPECT_EQ(par.lumens, 7000);
  EXPECT_NEAR(par.intensity->flux_lm(), 7000, 1e-6);
  EXPECT_NEAR(deg_from_rad(par.beam_angle_rad), 60, 1e-9);
  EXPECT_NEAR(deg_from_rad(par.field_angle_rad), 90, 1e-9);
  EXPECT_EQ(par.watts.value_or(0), 216);
  EXPECT_LT(par.colour_rgb.z(), par.colour_rgb.x()) << "6000 K is warmer than white";
  EXPECT_EQ(rig->fixtures.at(0).mode->told.at(0),
            "its light from its file: 7000 lm, a beam of 60° in a field of 90°, 6000 K, 216 W");
}

TEST(StatedLight, OfTheRigFileWinsAndBothAreReported) {
  const Checked<Rig> rig =
      par_with("lumens = 900\nbeam_angle_deg = 20\nfield_angle_deg = 30\ncct_k = 3000\nwatts = 40");
  ASSERT_TRUE(rig) << rig.error().front().text();
  EXPECT_EQ(rig->luminaires.at(0).lumens, 900);
  EXPECT_NEAR(deg_from_rad(rig->luminaires.at(0).beam_angle_rad), 20, 1e-9);
  EXPECT_EQ(rig->luminaires.at(0).watts.value_or(0), 40);
  EXPECT_EQ(rig->fixtures.at(0).mode->told.at(0),
            "its file states otherwise: 7000 lm (the rig file: 900), a beam of 60° (the rig file: 20); the rig file "
            "holds");
}

}  // namespace
}  // namespace luxrig
