// GDTF files of real fixtures against the values in their description.xml, read by eye (tests/data/fixtures/README.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <random>

#include "core/rig/personality/dmx_value.h"
#include "core/rig/personality/gdtf/gdtf_file.h"
#include "core/rig/personality/personality_file.h"
#include "core/text/plain_text.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

const std::filesystem::path kFiles = test::source_folder() / "tests/data/fixtures";

const PersonalityChannel& channel_named(const PersonalityMode& mode, const std::string& name) {
  const auto at = std::find_if(mode.channels.begin(), mode.channels.end(),
                               [&](const PersonalityChannel& c) { return c.name == name; });
  EXPECT_NE(at, mode.channels.end()) << name;
  static const PersonalityChannel none;
  return at == mode.channels.end() ? none : *at;
}

TEST(DmxValue, RepeatsItsBytesToFillUnlessShifted) {
  EXPECT_EQ(dmx_value("255/1", 1), 255u);
  EXPECT_EQ(dmx_value("255/1", 2), 65535u);  // DIN SPEC 15800's own example
  EXPECT_EQ(dmx_value("255/1s", 2), 65280u);
  EXPECT_EQ(dmx_value("128/1", 2), 0x8080u);
  EXPECT_EQ(dmx_value("4660/2", 3), 0x123412u);
  EXPECT_EQ(dmx_value("4660/2s", 3), 0x123400u);
  EXPECT_EQ(dmx_value("65535/2", 1), 255u);
  EXPECT_EQ(dmx_value("4294967295/4", 4), 0xFFFFFFFFu);
}

TEST(DmxValue, RefusesInvalidValues) {
  for (const char* text : {"", "255", "255/", "256/1", "-1/1", "1/0", "1/5", "1/1x", "1/1ss", "a/1", "/1", " 1/1",
                           "99999999999999999999/4"})
    EXPECT_FALSE(dmx_value(text, 2)) << text;
}

TEST(Gdtf, EverySampleLoadsWithTheSlotCountsOfItsModes) {
  const std::vector<std::tuple<const char*, std::string, int>> expected = {
      {"BlenderDMX@LED_PAR_64_RGBW@v0.3.gdtf", "Default", 5},
      {"Clay Paky@Alpha Spot QWO 800.gdtf", "Standard Mode (32 ch)", 32},
      {"Robe ColorWash 2500 AT.gdtf", "DMX Mode", 16},
      {"Robe@BMFL Spot.gdtf", "Mode 1 - Standard 16 bit", 41},
      {"Robe@BMFL Spot.gdtf", "Mode 2 - Reduced 8 bit", 33},
      {"Robe@Robin 100 LEDBeam.gdtf", "mode 2", 19},
      {"Robe@Robin 100 LEDBeam.gdtf", "mode 6", 37},
      {"Robe@Robin 100 LEDBeam.gdtf", "mode 4", 9},
      {"Robe_Lighting@Robin_MMX_Blade@2023-07-25__Beam_revision.gdtf", "Mode 1 - Standard", 45},
      {"Robe_Lighting@Robin_MMX_Blade@2023-07-25__Beam_revision.gdtf", "Mode 3 - 8 bit", 37},
      {"virtual_channel.gdtf", "Default", 2},
  };
  for (const auto& [file, mode_name, footprint] : expected) {
    const Checked<Personality> personality = load_personality(kFiles / file);
    ASSERT_TRUE(personality) << personality.error().front().text();
    const auto mode = std::find_if(personality->modes.begin(), personality->modes.end(),
                                   [&, wanted = mode_name](const PersonalityMode& m) { return m.name == wanted; });
    ASSERT_NE(mode, personality->modes.end()) << file << ": " << mode_name;
    EXPECT_EQ(mode->footprint(), footprint) << file << ": " << mode_name;
    EXPECT_EQ(mode->break_footprints.size(), 1u);
  }
}

TEST(Gdtf, ReadsTheAlphaSpotsChannelsAsStated) {
  const Checked<Personality> personality = load_personality(kFiles / "Clay Paky@Alpha Spot QWO 800.gdtf");
  ASSERT_TRUE(personality) << personality.error().front().text();
  EXPECT_EQ(personality->manufacturer, "Clay Paky");
  const PersonalityMode& mode = personality->modes[0];
  const PersonalityChannel& dimmer = channel_named(mode, "Head_Dimmer");
  EXPECT_EQ(dimmer.offsets, (std::vector{7, 8}));
  EXPECT_EQ(dimmer.highlight_dmx, 65535u);
  const PersonalityChannel& pan = channel_named(mode, "Yoke_Pan");
  EXPECT_EQ(pan.offsets, (std::vector{25, 26}));
  EXPECT_EQ(pan.default_dmx, 32767u);
  EXPECT_EQ(pan.functions[0].physical_from, 270);  // an inverted axis
  EXPECT_EQ(pan.functions[0].physical_to, -270);

  const PersonalityChannel& shutter = channel_named(mode, "Head_Shutter1");
  EXPECT_EQ(shutter.default_dmx, 104u);
  ASSERT_EQ(shutter.functions.size(), 7u);
  EXPECT_EQ(shutter.functions[0].dmx, (DmxInterval{0, 3}));
  EXPECT_EQ(shutter.functions[1].dmx, (DmxInterval{4, 103}));
  EXPECT_EQ(shutter.functions[6].dmx, (DmxInterval{252, 255}));
  EXPECT_EQ(shutter_state(shutter.functions[0], 2), ShutterState::closed);
  EXPECT_EQ(shutter_state(shutter.functions[1], 50), ShutterState::unsteady);
  EXPECT_EQ(shutter_state(shutter.functions[2], 104), ShutterState::open);

  const PersonalityChannel& lamp = channel_named(mode, "Head_LampControl");
  EXPECT_FALSE(strikes_lamp(lamp.functions[0], 50)) << "Lamp Off";
  EXPECT_TRUE(strikes_lamp(lamp.functions[0], 200)) << "Lamp On";
  // Only cyan exists while the colour wheel's channel is at 0.
  const PersonalityChannel& cyan = channel_named(mode, "Head_ColorSub_C");
  ASSERT_TRUE(cyan.functions[0].when && cyan.functions[1].when);
  EXPECT_EQ(mode.channels[cyan.functions[0].when->channel].name, "Head_Color2");
  EXPECT_EQ(cyan.functions[0].when->dmx, (DmxInterval{0, 0}));
  EXPECT_EQ(cyan.functions[1].when->dmx, (DmxInterval{1, 147}));
  EXPECT_EQ(cyan.functions[0].dmx, (DmxInterval{0, 255})) << "the other function exists under another condition";
}

TEST(Gdtf, AVirtualChannelHasNoSlotAndAReferenceShiftsOffsets) {
  const Checked<Personality> personality = load_personality(kFiles / "virtual_channel.gdtf");
  ASSERT_TRUE(personality) << personality.error().front().text();
  const PersonalityMode& mode = personality->modes[0];
  ASSERT_EQ(mode.channels.size(), 3u);
  EXPECT_TRUE(mode.channels[1].is_virtual());
  EXPECT_EQ(mode.channels[2].name, "Reference 1_Dimmer");
  EXPECT_EQ(mode.channels[2].offsets, std::vector{1});  // Offset 2 + DMXOffset 1 - 1
  ASSERT_TRUE(mode.geometries[1].beam);
  EXPECT_EQ(mode.geometries[1].beam->lumens, 1000);
}

TEST(Gdtf, LampOnMacroGivesItsValueAndDuration) {
  const Checked<Personality> personality =
      load_personality(kFiles / "Robe_Lighting@Robin_MMX_Blade@2023-07-25__Beam_revision.gdtf");
  ASSERT_TRUE(personality) << personality.error().front().text();
  const PersonalityMode& mode = personality->modes[0];
  const PersonalityChannel& control = channel_named(mode, "Base_Control1");
  const auto lamp = std::find_if(control.functions.begin(), control.functions.end(),
                                 [](const ChannelFunction& f) { return strikes_lamp(f, f.default_dmx); });
  ASSERT_NE(lamp, control.functions.end());
  EXPECT_EQ(lamp->default_dmx, 135u);
  EXPECT_DOUBLE_EQ(lamp->hold_s, 3.06);
  // Its yoke is drawn with a quarter turn about z: {0,1,0}{-1,0,0}.
  EXPECT_NEAR(mode.pan_offset_deg, -90, 1e-6);
  EXPECT_NEAR(mode.base_from_lamp.translation_m.z(), -0.000614 - 0.414878, 1e-9);
}

TEST(Gdtf, VirtualDimmersAndTheirRelationsAreRead) {
  const Checked<Personality> personality = load_personality(kFiles / "Robe@Robin 100 LEDBeam.gdtf");
  ASSERT_TRUE(personality) << personality.error().front().text();
  const auto with = std::find_if(personality->modes.begin(), personality->modes.end(),
                                 [](const PersonalityMode& m) { return !m.relations.empty(); });
  ASSERT_NE(with, personality->modes.end());
  const ChannelRelation& relation = with->relations[0];
  EXPECT_EQ(with->channels[relation.master].name, "middlering_Dimmer");
  EXPECT_TRUE(with->channels[relation.master].is_virtual());
  EXPECT_EQ(with->channels[relation.follower].name, "middlering_ColorAdd_R");
  EXPECT_EQ(relation.kind, RelationKind::multiply);
}

std::string description(const std::string& channels, const std::string& geometries = R"(<Geometry Name="Base"/>)") {
  return R"(<?xml version="1.0"?><GDTF DataVersion="1.2"><FixtureType Name="x" Manufacturer="y"><Geometries>)" +
         geometries + R"(</Geometries><DMXModes><DMXMode Name="m" Geometry="Base"><DMXChannels>)" + channels +
         "</DMXChannels></DMXMode></DMXModes></FixtureType></GDTF>";
}

TEST(Gdtf, AChannelSetWithoutAValueIsOmittedAndReported) {
  // Line 186 of the LEDBeam: DMXFrom="asdasd0asd/2asdasdasd".
  const Checked<Personality> personality = load_personality(kFiles / "Robe@Robin 100 LEDBeam.gdtf");
  ASSERT_TRUE(personality) << personality.error().front().text();
  EXPECT_TRUE(std::any_of(personality->notes.begin(), personality->notes.end(), [](const std::string& note) {
    return note.find("line 186: set \"min Red\"") != std::string::npos;
  }));
  const PersonalityChannel& red = channel_named(personality->modes[0], "Beam_ColorAdd_R");
  EXPECT_EQ(red.functions[0].sets.size(), 2u);
  // A function without a value is a different case.
  const auto wrong = parse_gdtf_description(
      description("<DMXChannel Offset=\"1\" Geometry=\"Base\"><LogicalChannel Attribute=\"Dimmer\"><ChannelFunction "
                  "DMXFrom=\"x/1\"/></LogicalChannel></DMXChannel>"),
      "x");
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error()[0].what.find("is no DMX value"), std::string::npos);
}

TEST(Gdtf, BrokenXmlIsRefusedWithItsPlace) {
  const Checked<Personality> personality = load_personality(kFiles / "XMLBroken.gdtf");
  ASSERT_FALSE(personality);
  EXPECT_NE(personality.error()[0].what.find("not well-formed"), std::string::npos) << personality.error()[0].text();
  EXPECT_GT(personality.error()[0].line, 1);
}

std::string dimmer_at(const std::string& offset, const std::string& geometry = "Base",
                      const std::string& dmx_break = "1") {
  return "<DMXChannel DMXBreak=\"" + dmx_break + "\" Offset=\"" + offset + "\" Geometry=\"" + geometry +
         "\"><LogicalChannel Attribute=\"Dimmer\"><ChannelFunction/></LogicalChannel></DMXChannel>";
}

TEST(Gdtf, ReferencesRepeatTheirChannelsAtTheirOwnOffsets) {
  const std::string geometries =
      R"(<Geometry Name="Base">
           <GeometryReference Name="left" Geometry="Cell"><Break DMXBreak="1" DMXOffset="3"/></GeometryReference>
           <GeometryReference Name="right" Geometry="Cell"><Break DMXBreak="1" DMXOffset="5"/></GeometryReference>
         </Geometry><Geometry Name="Cell"><Beam Name="Lens"/></Geometry>)";
  const auto personality =
      parse_gdtf_description(description(dimmer_at("1,2") + dimmer_at("1,2", "Lens", "Overwrite"), geometries), "x");
  ASSERT_TRUE(personality) << personality.error().front().text();
  const PersonalityMode& mode = personality->modes[0];
  ASSERT_EQ(mode.channels.size(), 3u);
  EXPECT_EQ(mode.channels[1].offsets, (std::vector{2, 3}));
  EXPECT_EQ(mode.channels[2].offsets, (std::vector{4, 5}));
  EXPECT_FALSE(mode.share_a_branch(mode.channels[1].geometry, mode.channels[2].geometry));
  EXPECT_TRUE(mode.share_a_branch(mode.channels[0].geometry, mode.channels[2].geometry));
  EXPECT_EQ(mode.footprint(), 6);
}

TEST(Gdtf, HostileDescriptionsAreRefusedWithAReason) {
  const std::pair<std::string, const char*> cases[] = {
      {description(dimmer_at("1,2") + dimmer_at("2")), "which channel"},
      {description(dimmer_at("513")), "no list of one to four slots"},
      {description(dimmer_at("0")), "no list of one to four slots"},
      {description(dimmer_at("1,2,3,4,5")), "no list of one to four slots"},
      {description(dimmer_at("1"), R"(<Geometry Name="Other"/>)"), "does not exist"},
      {description(dimmer_at("1"), R"(<Geometry Name="Base"><GeometryReference Name="r" Geometry="Base"/></Geometry>)"
                                   R"()"),
       "refers to itself"},
      {"<!DOCTYPE a [<!ENTITY b SYSTEM \"file:///etc/passwd\">]><GDTF/>", "DOCTYPE"},
      {"<GDTF DataVersion=\"2.0\"><FixtureType/></GDTF>", "not known"},
      {"<GDTF/>", "not the description"},
      {"", "not well-formed"},
  };
  for (const auto& [xml, reason] : cases) {
    const auto personality = parse_gdtf_description(xml, "x.xml");
    ASSERT_FALSE(personality) << xml;
    EXPECT_NE(personality.error()[0].what.find(reason), std::string::npos) << personality.error()[0].text();
    EXPECT_FALSE(personality.error()[0].mend.empty());
  }
}

TEST(Gdtf, NestingAndMultiplyingReferencesAreBounded) {
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += "<a>";
  for (int i = 0; i < 100'000; ++i) deep += "</a>";
  const auto nested = parse_gdtf_description(deep, "x");
  ASSERT_FALSE(nested);
  EXPECT_NE(nested.error()[0].what.find("nested deeper"), std::string::npos);

  // Ten references in each of twelve levels would be 10^12 instances without a limit.
  std::string geometries = "<Geometry Name=\"Base\"><GeometryReference Name=\"r\" Geometry=\"g0\"/></Geometry>";
  for (int level = 0; level < 12; ++level) {
    geometries += "<Geometry Name=\"g" + std::to_string(level) + "\">";
    for (int i = 0; i < 10; ++i)
      geometries += "<GeometryReference Name=\"r\" Geometry=\"g" + std::to_string(level + 1) + "\"/>";
    geometries += "</Geometry>";
  }
  geometries += "<Geometry Name=\"g12\"/>";
  const auto many = parse_gdtf_description(description(dimmer_at("1"), geometries), "x");
  ASSERT_FALSE(many);
  EXPECT_NE(many.error()[0].what.find("geometries in a mode"), std::string::npos) << many.error()[0].text();
}

TEST(Gdtf, TruncatedAndCorruptedFilesAreReadOrRefused) {
  std::ifstream in(kFiles / "Robe ColorWash 2500 AT.gdtf", std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  ASSERT_TRUE(read_gdtf(whole, "x"));
  std::mt19937 random(1);
  for (std::size_t length = 0; length < whole.size(); length += 13)
    EXPECT_FALSE(read_gdtf(whole.substr(0, length), "x")) << "a zip archive has its directory at its end";
  for (int i = 0; i < 300; ++i) {
    std::string spoiled = whole;
    for (int j = 0; j < 4; ++j) spoiled[random() % spoiled.size()] = static_cast<char>(random());
    const auto personality = read_gdtf(spoiled, "x");
    if (personality) continue;
    for (const Problem& problem : personality.error()) EXPECT_TRUE(is_plain_text(problem.text()));
  }
}

TEST(Gdtf, ADecompressionBombIsRefused) {
  const Checked<Personality> bomb = load_personality(kFiles / "hostile/bomb.gdtf");
  ASSERT_FALSE(bomb);
  EXPECT_NE(bomb.error()[0].what.find("unpacks to more than"), std::string::npos) << bomb.error()[0].text();
  const Checked<Personality> elsewhere = load_personality(kFiles / "hostile/description_in_a_folder.gdtf");
  ASSERT_FALSE(elsewhere);
  EXPECT_NE(elsewhere.error()[0].what.find("no description.xml"), std::string::npos);
}

}  // namespace
}  // namespace luxrig
