// Results of [[luminaire]]: distribution, shape and colour, and fixtures of luminaires with emitters.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/photometry/light_colour.h"
#include "core/rig/rig_file.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

const std::filesystem::path kData = test::source_folder() / "tests/data/photometry";

Luminaire luminaire_of(const std::string& keys) {
  const Checked<Rig> rig = parse_rig("[rig]\nname = \"r\"\n[[luminaire]]\nname = \"l\"\n" + keys, "rig.toml", kData);
  if (!rig) {
    ADD_FAILURE() << rig.error().front().text();
    return {};
  }
  return rig->luminaires.at(0);
}

Vec3 at(double gamma_deg) { return {std::sin(rad_from_deg(gamma_deg)), 0, -std::cos(rad_from_deg(gamma_deg))}; }

TEST(Luminaires, RectanglesAndDisksAreLambertianAndFaceDown) {
  using Kind = LuminousShape::Kind;
  const Luminaire panel = luminaire_of("model = \"rectangle\"\nlength_m = 1.2\nwidth_m = 0.3\nlumens = 3600\n");
  EXPECT_EQ(panel.shape, (LuminousShape{Kind::rectangle, Vec3(1.2, 0.3, 0)}));
  EXPECT_NEAR(panel.intensity->intensity_cd(at(60)), 3600 / kPi * 0.5, 1e-9);
  EXPECT_EQ(panel.intensity->intensity_cd(at(100)), 0);
  const Luminaire downlight = luminaire_of("model = \"disk\"\ndiameter_m = 0.2\nlumens = 900\n");
  EXPECT_EQ(downlight.shape, (LuminousShape{Kind::disk, Vec3(0.2, 0, 0)}));
  EXPECT_NEAR(downlight.intensity->max_intensity_cd(), 900 / kPi, 1e-9);
}

TEST(Luminaires, CosineLuminairesFallOffByTheirPower) {
  const Luminaire lamp = luminaire_of("model = \"cosine\"\nexponent = 4\nlumens = 900\n");
  const double peak_cd = 900 * 5 / (2 * kPi);
  EXPECT_NEAR(lamp.intensity->intensity_cd(at(0)), peak_cd, 1e-9);
  EXPECT_NEAR(lamp.intensity->intensity_cd(at(60)), peak_cd / 16, 1e-9);
  EXPECT_EQ(lamp.intensity->intensity_cd(at(91)), 0);
  EXPECT_NEAR(lamp.lumens, 900, 0);
  const auto said = [](const std::string& keys) {
    const auto rig =
        parse_rig("[rig]\nname = \"r\"\n[[luminaire]]\nname = \"l\"\nlumens = 1\n" + keys, "rig.toml", kData);
    return rig ? std::string() : rig.error().front().text();
  };
  EXPECT_NE(said("model = \"cosine\"\n").find("exponent"), std::string::npos) << said("model = \"cosine\"\n");
  EXPECT_NE(said("model = \"isotropic\"\nexponent = 2\n").find("exponent has no effect on this model"),
            std::string::npos);
}

TEST(Luminaires, SpheresAndCylindersHaveUniformLuminance) {
  using Kind = LuminousShape::Kind;
  const Luminaire globe = luminaire_of("model = \"sphere\"\ndiameter_m = 0.4\nlumens = 900\n");
  EXPECT_EQ(globe.shape, (LuminousShape{Kind::sphere, Vec3(0.4, 0, 0)}));
  EXPECT_NEAR(globe.intensity->intensity_cd(at(130)), 900 / (4 * kPi), 1e-9);

  const Luminaire tube = luminaire_of("model = \"cylinder\"\ndiameter_m = 0.04\nlength_m = 1.2\nlumens = 2400\n");
  EXPECT_EQ(tube.shape, (LuminousShape{Kind::cylinder, Vec3(0.04, 0, 1.2)}));
  const double luminance = 2400 / (kPi * kPi * 0.04 * (1.2 + 0.02));  // flux over π times its whole surface
  EXPECT_NEAR(tube.intensity->intensity_cd(at(90)), luminance * 0.04 * 1.2, 1e-9);
  EXPECT_NEAR(tube.intensity->intensity_cd(at(0)), luminance * kPi / 4 * 0.04 * 0.04, 1e-9);
  EXPECT_NEAR(tube.intensity->intensity_cd(at(180)), luminance * kPi / 4 * 0.04 * 0.04, 1e-9);
  EXPECT_NEAR(tube.lumens, 2400, 0);
}

TEST(Luminaires, AcceptFilesOfEitherFormat) {
  const Luminaire ldt = luminaire_of("model = \"ies\"\nfile = \"sample9.ldt\"\n");
  EXPECT_NEAR(ldt.lumens, 10002.8, 0.1);
  const Luminaire ies = luminaire_of("model = \"ies\"\nfile = \"type_b_full.ies\"\nlumens = 1000\n");
  EXPECT_NEAR(ies.intensity->flux_lm(), 1000, 1e-9);
  EXPECT_TRUE(luminaire_of("model = \"ies\"\nfile = \"tilt_include_geometry2.ies\"\n").tilt.has_value());
}

TEST(Luminaires, UseTheFilesOpeningOnlyWhenAsked) {
  EXPECT_EQ(luminaire_of("model = \"ies\"\nfile = \"sample9.ldt\"\n").shape, LuminousShape{});
  const Luminaire near = luminaire_of("model = \"ies\"\nfile = \"sample9.ldt\"\nnear_field = true\n");
  EXPECT_EQ(near.shape, (LuminousShape{LuminousShape::Kind::rectangle, Vec3(0.065, 1.75, 0)}));
  const auto notes = [](const std::string& file) {
    const Checked<Rig> rig = parse_rig("[rig]\nname = \"r\"\n[[luminaire]]\nname = \"l\"\nmodel = \"ies\"\nfile = \"" +
                                           file + "\"\nnear_field = true\n",
                                       "rig.toml", kData);
    return rig && !rig->notes.empty() ? rig->notes.back().what : std::string();
  };
  EXPECT_NE(notes("sample9.ldt").find("a box"), std::string::npos);  // reported, as it is simplified
  EXPECT_NE(notes("defined.ies").find("no luminous opening"), std::string::npos);
  EXPECT_EQ(notes("comet.ies"), "");
}

TEST(Luminaires, HaveAColourWithALuminanceOfOne) {
  EXPECT_EQ(luminaire_of("model = \"isotropic\"\nlumens = 1\n").colour_rgb, Vec3::Ones());
  const Vec3 warm = luminaire_of("model = \"isotropic\"\nlumens = 1\ncct_k = 2700\n").colour_rgb;
  EXPECT_NEAR(luminance_of_rgb(warm), 1, 1e-12);
  EXPECT_GT(warm.x(), 1.5);
  EXPECT_LT(warm.z(), 0.4);
  const Vec3 stated = luminaire_of("model = \"isotropic\"\nlumens = 1\ncolour = [4, 2, 1]\n").colour_rgb;
  EXPECT_NEAR(luminance_of_rgb(stated), 1, 1e-12);
  EXPECT_NEAR(stated.x() / stated.z(), 4, 1e-12);
}

TEST(Luminaires, AcceptAChromaticity) {
  const Vec3 inside = luminaire_of("model = \"isotropic\"\nlumens = 1\nxy = [0.45, 0.41]\n").colour_rgb;
  EXPECT_NEAR(luminance_of_rgb(inside), 1, 1e-12);
  EXPECT_NEAR((xy_of_rgb(inside) - Chromaticity(0.45, 0.41)).norm(), 0, 1e-12);
  const Vec3 white = luminaire_of("model = \"isotropic\"\nlumens = 1\nxy = [0.3127, 0.3290]\n").colour_rgb;
  EXPECT_NEAR((white - Vec3::Ones()).norm(), 0, 1e-3) << "D65";
  // Primaries of Rec. 709 as published.
  for (const auto& [rgb, xy] : {std::pair{Vec3(1, 0, 0), Chromaticity(0.64, 0.33)},
                                {Vec3(0, 1, 0), Chromaticity(0.30, 0.60)},
                                {Vec3(0, 0, 1), Chromaticity(0.15, 0.06)}})
    EXPECT_NEAR((xy_of_rgb(rgb) - xy).norm(), 0, 2e-5);
}

TEST(Luminaires, ClampAColourOutsideRec709ToItsEdgeWithANote) {
  const Checked<Rig> rig = parse_rig(
      "[rig]\nname = \"r\"\n[[luminaire]]\nname = \"l\"\nmodel = \"isotropic\"\nlumens = 1\nxy = [0.69, 0.31]\n",
      "rig.toml", kData);
  ASSERT_TRUE(rig);
  const Vec3& rgb = rig->luminaires[0].colour_rgb;
  EXPECT_EQ(rgb.y(), 0);
  EXPECT_EQ(rgb.minCoeff(), 0);
  EXPECT_NEAR(luminance_of_rgb(rgb), 1, 1e-12);
  ASSERT_EQ(rig->notes.size(), 1u);
  EXPECT_EQ(rig->notes[0].line, 7);
  EXPECT_NE(rig->notes[0].what.find("xy [0.69, 0.31] lies outside Rec. 709"), std::string::npos) << rig->notes[0].what;
}

constexpr const char* kPar = R"([rig]
name = "r"
[[luminaire]]
name = "par"
model = "spot"
beam_angle_deg = 20
field_angle_deg = 40
emitters = [
  { name = "red", xy = [0.64, 0.33], lumens = 150, watts = 6 },
  { name = "white", cct_k = 3000, lumens = 300, watts = 8 },
]
[[bus]]
name = "dmx"
driver = "sacn"
[[fixture]]
name = "a"
luminaire = "par"
position_m = [0, 0, 3]
aim_m = [1, 0, 0]
bus = "dmx"
address = 11
max_level = 0.8
slots = ["constant:255", "emitter:white", "emitter:white-fine", "pan", "tilt", "emitter:red", "unused"]
[[fixture]]
name = "b"
luminaire = "par/red"
position_m = [1, 0, 3]
bus = "dmx"
address = 18
)";

TEST(Luminaires, EmittersNeedNoSlotsOnANullBus) {
  std::string text = kPar;
  text.replace(text.find("\"sacn\""), 6, "\"null\"");
  for (const char* line : {"address = 11\n", "address = 18\n",
                           "slots = [\"constant:255\", \"emitter:white\", \"emitter:white-fine\", \"pan\", \"tilt\", "
                           "\"emitter:red\", \"unused\"]\n"}) {
    const auto at = text.find(line);
    ASSERT_NE(at, std::string::npos) << line;
    text.erase(at, std::string(line).size());
  }
  const Checked<Rig> rig = parse_rig(text, "rig.toml", kData);
  ASSERT_TRUE(rig) << rig.error().front().text();
  ASSERT_EQ(rig->fixtures.size(), 3u) << "an emitter each of a, and b";
  EXPECT_EQ(rig->fixtures[1].name, "a/white");
}

TEST(Luminaires, EmittersAreOneLuminaireEachAndOneTogether) {
  const Checked<Rig> rig = parse_rig(kPar, "rig.toml", kData);
  ASSERT_TRUE(rig) << rig.error().front().text();
  ASSERT_EQ(rig->luminaires.size(), 3u);
  const Luminaire &par = rig->luminaires[0], &red = rig->luminaires[1], &white = rig->luminaires[2];
  EXPECT_EQ(par.emitters, (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(red.name, "par/red");
  EXPECT_EQ(white.emitter_of, 0u);
  EXPECT_NEAR(par.intensity->flux_lm(), 450, 0.5);
  EXPECT_EQ(par.lumens, 450);
  EXPECT_EQ(par.watts, 14);
  EXPECT_NEAR(red.intensity->flux_lm(), 150, 0.2);
  EXPECT_EQ(white.watts, 8);
  const Vec3 aside = at(12);
  EXPECT_NEAR(red.intensity->intensity_cd(aside) + white.intensity->intensity_cd(aside),
              par.intensity->intensity_cd(aside), 1e-9);
  EXPECT_NEAR((150 * red.colour_rgb + 300 * white.colour_rgb - 450 * par.colour_rgb).norm(), 0, 1e-9);
}

TEST(Fixtures, OfALuminaireWithEmittersAreOnePerEmitter) {
  const Checked<Rig> rig = parse_rig(kPar, "rig.toml", kData);
  ASSERT_TRUE(rig) << rig.error().front().text();
  ASSERT_EQ(rig->fixtures.size(), 3u);
  const Fixture &red = rig->fixtures[0], &white = rig->fixtures[1], &plain = rig->fixtures[2];
  EXPECT_EQ(red.name, "a/red");
  EXPECT_EQ(white.name, "a/white");
  EXPECT_EQ(red.housing, 0u);
  EXPECT_EQ(white.housing, 0u);
  EXPECT_FALSE(plain.housing) << "an emitter by itself is a luminaire like another";
  EXPECT_EQ(rig->luminaires[white.luminaire].name, "par/white");
  EXPECT_EQ(white.joints.pan_rad, red.joints.pan_rad);
  EXPECT_TRUE(white.moves);
  EXPECT_EQ(white.max_level, 0.8);
  const auto &of_red = std::get<DmxPatch>(red.patch), &of_white = std::get<DmxPatch>(white.patch);
  EXPECT_EQ(of_white.address, 11);
  const auto uses = [](const DmxPatch& patch) {
    std::vector<std::pair<SlotUse, bool>> out;
    for (const DmxSlot& slot : patch.slots) out.emplace_back(slot.use, slot.sent);
    return out;
  };
  using Use = SlotUse;
  EXPECT_EQ(uses(of_red), (std::vector<std::pair<Use, bool>>{{Use::constant, true},
                                                             {Use::unused, true},
                                                             {Use::unused, true},
                                                             {Use::pan, true},
                                                             {Use::tilt, true},
                                                             {Use::dimmer, true},
                                                             {Use::unused, true}}));
  EXPECT_EQ(uses(of_white), (std::vector<std::pair<Use, bool>>{{Use::constant, false},
                                                               {Use::dimmer, true},
                                                               {Use::dimmer_fine, true},
                                                               {Use::pan, false},
                                                               {Use::tilt, false},
                                                               {Use::unused, true},
                                                               {Use::unused, false}}));
}

TEST(Points, CanHaveColourGoals) {
  const std::string head = "[rig]\nname = \"r\"\n[[point]]\nname = \"p\"\nposition_m = [0, 0, 0]\ngoal_lx = 100\n";
  const Checked<Rig> warm = parse_rig(head + "goal_cct_k = 3000\n", "rig.toml", kData);
  ASSERT_TRUE(warm);
  EXPECT_EQ(warm->points[0].goal_rgb, rgb_of_cct(3000));
  EXPECT_TRUE(warm->colour_goals());
  const Checked<Rig> deep = parse_rig(head + "goal_xy = [0.7, 0.29]\n", "rig.toml", kData);
  ASSERT_TRUE(deep);
  EXPECT_EQ(deep->points[0].goal_rgb->y(), 0);
  ASSERT_EQ(deep->notes.size(), 1u);
  EXPECT_NE(deep->notes[0].what.find("goal of point \"p\""), std::string::npos) << deep->notes[0].what;
  const Checked<Rig> plain = parse_rig(head, "rig.toml", kData);
  ASSERT_TRUE(plain);
  EXPECT_FALSE(plain->colour_goals());
}

// LM-63 draws type A with its beam level; aim_m is the place for the beam, whatever the type.
TEST(Luminaires, EveryIesTypeShinesWhereItIsAimed) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "luxrig_ies_aims";
  std::filesystem::create_directories(folder);
  for (const int type : {1, 2, 3}) {
    // Bright at (0, 0), half as bright at 10° from it, dark from 30° on. A and B have one wider half-axis to show their
    // side.
    std::ofstream(folder / "lamp.ies")
        << "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 "
        << (type == 1 ? "4 1 1 2 0 0 0\n1 1 1\n0 10 30 90\n0\n1000 500 0 0\n"
                      : "5 5 " + std::to_string(type) +
                            " 2 0 0 0\n1 1 1\n-90 -10 0 10 90\n-90 -20 0 20 90\n0 0 0 0 0\n0 0 600 0 0\n"
                            "0 500 1000 500 0\n0 0 700 0 0\n0 0 0 0 0\n");
    const Checked<Rig> rig = parse_rig(R"([rig]
name = "r"
[[luminaire]]
name = "l"
model = "ies"
file = "lamp.ies"
[[bus]]
name = "dmx"
driver = "sacn"
[[fixture]]
name = "f"
luminaire = "l"
position_m = [1, 2, 3]
aim_m = [1, 9, 3]
bus = "dmx"
address = 1
)",
                                       "rig.toml", folder);
    ASSERT_TRUE(rig) << rig.error().front().text();
    const Pose pose = rig->fixtures.at(0).world_from_lamp();
    const auto towards = [&](const Vec3& direction_world) {
      return rig->luminaires[0].intensity->intensity_cd(pose.inverse_direction(direction_world.normalized()));
    };
    EXPECT_NEAR(towards(Vec3(0, 7, 0)), 1000, 1e-6) << "type " << type << ", at what it is aimed at";
    EXPECT_NEAR(towards(Vec3(1, 0, 0)), 0, 1e-6) << "type " << type;
    EXPECT_NEAR(towards(Vec3(0, 0, -1)), 0, 1e-6) << "type " << type;
    if (type != 3) continue;
    const double angle = rad_from_deg(20);
    EXPECT_NEAR(towards(Vec3(std::sin(angle), std::cos(angle), 0)), 700, 1e-6) << "X counts to the right";
    EXPECT_NEAR(towards(Vec3(-std::sin(angle), std::cos(angle), 0)), 600, 1e-6);
    EXPECT_NEAR(towards(Vec3(0, std::cos(rad_from_deg(10)), std::sin(rad_from_deg(10)))), 500, 1e-6) << "Y upwards";
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace luxrig
