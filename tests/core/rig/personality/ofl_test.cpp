// Open Fixture Library files of real fixtures against the values in their JSON, and small ones made here.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <random>

#include "core/rig/personality/ofl/ofl_file.h"
#include "core/rig/personality/personality_file.h"
#include "core/text/plain_text.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

const std::filesystem::path kOfl = test::source_folder() / "tests/data/fixtures/ofl";

Personality loaded(const char* file) {
  Checked<Personality> personality = load_personality(kOfl / file);
  EXPECT_TRUE(personality) << personality.error().front().text();
  return personality ? *personality : Personality{};
}

const PersonalityMode& mode_named(const Personality& personality, const std::string& name) {
  const auto at = std::find_if(personality.modes.begin(), personality.modes.end(),
                               [&](const PersonalityMode& m) { return m.name == name; });
  EXPECT_NE(at, personality.modes.end()) << name;
  static const PersonalityMode none;
  return at == personality.modes.end() ? none : *at;
}

std::vector<std::pair<std::string, std::vector<int>>> layout(const PersonalityMode& mode) {
  std::vector<std::pair<std::string, std::vector<int>>> out;
  for (const PersonalityChannel& channel : mode.channels) out.emplace_back(channel.name, channel.offsets);
  return out;
}

TEST(Ofl, EverySampleLoads) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kOfl)) {
    if (entry.path().extension() != ".json") continue;
    const Checked<Personality> personality = load_personality(entry.path());
    ASSERT_TRUE(personality) << personality.error().front().text();
    EXPECT_EQ(personality->manufacturer, entry.path().parent_path().filename().string());
    for (const PersonalityMode& mode : personality->modes) EXPECT_GT(mode.footprint(), 0) << entry.path() << mode.name;
    ++files;
  }
  EXPECT_EQ(files, 9u);
}

TEST(Ofl, FineChannelsJoinTheirValueAtAnyPosition) {
  const Personality pan_tilt = loaded("generic/pan-tilt.json");
  using Layout = std::vector<std::pair<std::string, std::vector<int>>>;
  EXPECT_EQ(layout(mode_named(pan_tilt, "8 bit")), (Layout{{"Pan", {0}}, {"Tilt", {1}}}));
  EXPECT_EQ(layout(mode_named(pan_tilt, "16 bit (alternate)")), (Layout{{"Pan", {0, 2}}, {"Tilt", {1, 3}}}));
  EXPECT_EQ(layout(mode_named(pan_tilt, "24 bit (alternate)")), (Layout{{"Pan", {0, 2, 4}}, {"Tilt", {1, 3, 5}}}));
  // 50 % at the mode's resolution, rounded down; the middle of the travel is straight down.
  EXPECT_EQ(mode_named(pan_tilt, "8 bit").channels[0].default_dmx, 127u);
  EXPECT_EQ(mode_named(pan_tilt, "16 bit").channels[0].default_dmx, 32767u);
  EXPECT_EQ(mode_named(pan_tilt, "24 bit").channels[0].default_dmx, 8388607u);
  EXPECT_EQ(mode_named(pan_tilt, "24 bit").channels[0].max_dmx(), 16777215u);
  EXPECT_EQ(mode_named(pan_tilt, "8 bit").pan_offset_deg, -270);
  EXPECT_EQ(mode_named(pan_tilt, "8 bit").tilt_offset_deg, -90);
}

TEST(Ofl, MatricesAreExpandedAndAGroupOfAllPixelsIsTheWhole) {
  const Personality pack = loaded("generic/4-channel-dimmer-pack.json");
  const PersonalityMode& one = mode_named(pack, "1-channel");
  ASSERT_EQ(one.channels.size(), 1u);
  EXPECT_EQ(one.channels[0].geometry, 0u);
  const PersonalityMode& four = mode_named(pack, "4-channel");
  ASSERT_EQ(four.channels.size(), 4u);
  EXPECT_EQ(four.channels[3].name, "Dimmer 4");
  EXPECT_FALSE(four.share_a_branch(four.channels[0].geometry, four.channels[3].geometry));

  const Personality wash = loaded("robe/robin-ledwash-600.json");
  const PersonalityMode& first = wash.modes[0];  // Pan, Tilt, speed, special, then R G B W of Inner, Middle, Outer
  const auto red = std::find_if(first.channels.begin(), first.channels.end(),
                                [](const PersonalityChannel& c) { return c.name == "Red Middle"; });
  ASSERT_NE(red, first.channels.end());
  EXPECT_EQ(red->offsets, (std::vector{14, 15}));
  EXPECT_EQ(red->functions[0].attribute, "ColorAdd_R");
  EXPECT_EQ(first.geometries[red->geometry].name, "Middle");
}

TEST(Ofl, SwitchingChannelsTakeTheirDefaultMeaning) {
  const Personality mac = loaded("martin/mac-700-wash.json");
  const PersonalityMode& mode = mac.modes[0];
  EXPECT_TRUE(std::any_of(mode.channels.begin(), mode.channels.end(),
                          [](const PersonalityChannel& c) { return c.name == "Cyan Intensity"; }));
  // A lamp behind cyan, magenta and yellow filters adds no cyan light.
  for (const PersonalityChannel& channel : mode.channels) {
    if (channel.name == "Cyan Intensity") {
      EXPECT_EQ(channel.functions[0].attribute, "ColorSub_C");
    }
    if (channel.name != "Shutter / Strobe") continue;
    EXPECT_EQ(shutter_state(channel.functions[0], 10), ShutterState::closed);
    EXPECT_EQ(shutter_state(channel.functions[1], 30), ShutterState::open);
    EXPECT_EQ(shutter_state(channel.functions[2], 60), ShutterState::unsteady);
    EXPECT_TRUE(std::any_of(channel.functions.begin(), channel.functions.end(), [](const ChannelFunction& f) {
      return strikes_lamp(f, f.dmx.from) && f.dmx == DmxInterval{228, 237};
    }));
  }
  const Personality lustr = loaded("etc/source-four-led-series-2-lustr.json");
  bool cyan_light = false;
  for (const PersonalityChannel& channel : lustr.modes[0].channels)
    cyan_light |= channel.functions[0].attribute == "ColorAdd_C";
  EXPECT_TRUE(cyan_light) << "beside red and blue emitters, cyan is one, too";
}

std::string ofl(const std::string& channels, const std::string& modes, const std::string& more = "") {
  return R"({"$schema": "https://raw.githubusercontent.com/OpenLightingProject/open-fixture-library/master/schemas/fixture.json",
  "name": "x", )" +
         more + R"("availableChannels": {)" + channels + R"(}, "modes": [)" + modes + "]}";
}

TEST(Ofl, RangesAreScaledToTheBytesOfAMode) {
  const std::string wide = R"("D": {"fineChannelAliases": ["D fine"], "dmxValueResolution": "8bit", "defaultValue": 9,
    "capabilities": [{"dmxRange": [0, 9], "type": "ShutterStrobe", "shutterEffect": "Closed"},
                     {"dmxRange": [10, 255], "type": "Intensity"}]})";
  const auto read = parse_ofl(ofl(wide, R"({"name": "a", "channels": ["D", null, "D fine"]},
                                           {"name": "b", "channels": ["D"]})"),
                              "m", "x");
  ASSERT_TRUE(read) << read.error().front().text();
  const PersonalityChannel& both = read->modes[0].channels[0];
  EXPECT_EQ(both.offsets, (std::vector{0, 2}));
  EXPECT_EQ(both.functions[0].dmx, (DmxInterval{0, 9 * 256 + 255}));
  EXPECT_EQ(both.functions[1].dmx, (DmxInterval{10 * 256, 65535}));
  EXPECT_EQ(both.default_dmx, 9u * 256);
  EXPECT_EQ(read->modes[1].channels[0].functions[1].dmx, (DmxInterval{10, 255}));
  EXPECT_EQ(read->modes[0].footprint(), 3);
}

TEST(Ofl, PixelsAreRepeatedInTheRequestedOrder) {
  const std::string more = R"("matrix": {"pixelCount": [2, 2, 1]}, "templateChannels": {
    "R $pixelKey": {"capability": {"type": "ColorIntensity", "color": "Red"}}}, )";
  const auto names = [&](const std::string& repeat) {
    const auto read = parse_ofl(ofl("",
                                    R"({"name": "a", "channels": [{"insert": "matrixChannels", "repeatFor": )" +
                                        repeat + R"(, "channelOrder": "perPixel",
                                            "templateChannels": ["R $pixelKey"]}]})",
                                    more),
                                "m", "x");
    std::vector<std::string> out;
    if (read)
      for (const PersonalityChannel& channel : read->modes[0].channels) out.push_back(channel.name);
    return out;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(names(R"("eachPixelXYZ")"), (Names{"R (1, 1)", "R (2, 1)", "R (1, 2)", "R (2, 2)"}));
  EXPECT_EQ(names(R"("eachPixelYXZ")"), (Names{"R (1, 1)", "R (1, 2)", "R (2, 1)", "R (2, 2)"}));
  EXPECT_EQ(names("[\"(2, 2)\", \"(1, 1)\"]"), (Names{"R (2, 2)", "R (1, 1)"}));
}

// As cameo/hydrabeam-300-rgbw: each head's mode sets the meaning of its next slot.
TEST(Ofl, PixelSwitchingChannelsTakeTheirDefaultMeaningToo) {
  const std::string more = R"("matrix": {"pixelCount": [2, 1, 1]}, "templateChannels": {
    "Mode $pixelKey": {"defaultValue": 20, "capabilities": [
      {"dmxRange": [0, 9], "type": "NoFunction", "switchChannels": {"Speed $pixelKey / Sound $pixelKey": "Speed $pixelKey"}},
      {"dmxRange": [10, 255], "type": "Effect", "switchChannels": {"Speed $pixelKey / Sound $pixelKey": "Sound $pixelKey"}}]},
    "Speed $pixelKey": {"capability": {"type": "EffectSpeed"}},
    "Sound $pixelKey": {"capability": {"type": "SoundSensitivity"}}}, )";
  const auto read =
      parse_ofl(ofl("", R"({"name": "a", "channels": [{"insert": "matrixChannels", "repeatFor": "eachPixelABC",
          "channelOrder": "perPixel", "templateChannels": ["Mode $pixelKey", "Speed $pixelKey / Sound $pixelKey"]}]})",
                    more),
                "m", "x");
  ASSERT_TRUE(read) << read.error().front().text();
  std::vector<std::string> names;
  for (const PersonalityChannel& channel : read->modes[0].channels) names.push_back(channel.name);
  EXPECT_EQ(names, (std::vector<std::string>{"Mode 1", "Sound 1", "Mode 2", "Sound 2"}));
}

TEST(Ofl, HostileFilesAreRefusedWithAReason) {
  const std::string dimmer = R"("D": {"fineChannelAliases": ["F"], "capability": {"type": "Intensity"}})";
  const auto mode = [](const std::string& channels) { return R"({"name": "a", "channels": )" + channels + "}"; };
  const std::pair<std::string, const char*> cases[] = {
      {ofl(dimmer, mode(R"(["F"])")), "without the byte above it"},
      {ofl(dimmer, mode(R"(["D", "D"])")), "twice"},
      {ofl(dimmer, mode(R"(["E"])")), "there is no channel"},
      {ofl(dimmer, ""), "no modes"},
      {ofl(R"("D": {})", mode(R"(["D"])")), "no capability"},
      {ofl(R"("D": {"defaultValue": 256, "capability": {"type": "Intensity"}})", mode(R"(["D"])")), "no DMX value"},
      {ofl(R"("D": {"capabilities": [{"dmxRange": [9, 3], "type": "Intensity"}]})", mode(R"(["D"])")), "dmxRange"},
      {ofl(dimmer, mode(R"([{"insert": "everything"}])")), "insert block"},
      {ofl(dimmer, mode(R"(["D"])"), R"("matrix": {"pixelCount": [5000, 5000, 5000]}, )"), "pixels"},
      {"{\"name\": \"x\"}", "no $schema"},
      {R"({"$schema": "https://x/open-fixture-library/schema-13.0.0/schemas/fixture.json"})", "not known"},
      {"{", "not well-formed JSON"},
      {"[1e999999]", "number"},
      {std::string(100'000, '['), "nested deeper"},
  };
  for (const auto& [json, reason] : cases) {
    const auto personality = parse_ofl(json, "m", "x.json");
    ASSERT_FALSE(personality) << json.substr(0, 200);
    EXPECT_NE(personality.error()[0].what.find(reason), std::string::npos) << personality.error()[0].text();
  }
}

TEST(Ofl, TruncatedAndCorruptedFilesAreReadOrRefused) {
  std::ifstream in(kOfl / "american-dj/crazy-pocket-8.json");
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  ASSERT_TRUE(parse_ofl(whole, "m", "x"));
  for (std::size_t length = 0; length + 2 < whole.size(); length += 37)
    EXPECT_FALSE(parse_ofl(std::string_view(whole).substr(0, length), "m", "x"));
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    std::string spoiled = whole;
    for (int j = 0; j < 4; ++j) spoiled[random() % spoiled.size()] = static_cast<char>(random());
    const auto personality = parse_ofl(spoiled, "m", "x");
    if (personality) continue;
    for (const Problem& problem : personality.error()) EXPECT_TRUE(is_plain_text(problem.text()));
  }
}

}  // namespace
}  // namespace luxrig
