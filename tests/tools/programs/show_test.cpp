// `luxrig render --show`: its drawings, and its messages when it cannot draw.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <regex>

#include "tests/tools/programs/process.h"

namespace luxrig::testing {
namespace {

Ran show(const std::string& rig, const std::string& what, const std::filesystem::path& png,
         std::vector<std::string> more = {}) {
  std::vector<std::string> command = {program("luxrig"), "render", rig, "-o", png.string(), "--show", what};
  for (const char* word : {"--width", "160", "--height", "120"}) command.emplace_back(word);
  command.insert(command.end(), more.begin(), more.end());
  return luxrig::testing::run(command);
}

/// A rig with one object, given as the text of an OBJ file.
std::string rig_with(const Folder& folder, const std::string& obj) {
  std::ofstream(folder / "thing.obj") << obj;
  std::ofstream(folder / "rig.toml") << "[rig]\nname = \"one\"\n\n[[scene.object]]\nname = \"thing\"\n"
                                        "file = \"thing.obj\"\nunit = \"m\"\nup_axis = \"z\"\nposition_m = [0, 0, 0]\n";
  return (folder / "rig.toml").string();
}

std::string ball_obj() {
  constexpr int kRings = 24, kAround = 48;
  std::string text;
  for (int i = 0; i <= kRings; ++i)
    for (int j = 0; j < kAround; ++j) {
      const double theta = std::numbers::pi * i / kRings, phi = 2 * std::numbers::pi * j / kAround;
      text += "v " + std::to_string(std::sin(theta) * std::cos(phi)) + " " +
              std::to_string(std::sin(theta) * std::sin(phi)) + " " + std::to_string(std::cos(theta)) + "\n";
    }
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kAround; ++j) {
      const auto at = [&](int ring, int around) { return std::to_string(1 + ring * kAround + around % kAround); };
      text += "f " + at(i, j) + " " + at(i + 1, j) + " " + at(i + 1, j + 1) + "\n";
      text += "f " + at(i, j) + " " + at(i + 1, j + 1) + " " + at(i, j + 1) + "\n";
    }
  return text;
}

TEST(Show, DrawsEveryKindForTheStudiosSkull) {
  const Folder folder;
  for (const char* what : {"curvature", "interest", "features", "histogram", "domain", "beams"}) {
    const auto png = folder / (std::string(what) + ".png");
    const Ran ran = show(source("rigs/studio"), what, png);
    ASSERT_EQ(ran.code, 0) << ran.output;
    EXPECT_NE(ran.output.find("studio"), std::string::npos) << ran.output;
    EXPECT_EQ(text_of(png).substr(1, 3), "PNG");
    EXPECT_GT(std::filesystem::file_size(png), 2000u) << what;
  }
}

TEST(Show, RequiresAnObjectAndSuggestsTheirNames) {
  const Folder folder;
  const Ran which = show(source("rigs/gallery"), "curvature", folder / "a.png");
  EXPECT_EQ(which.code, 2);
  EXPECT_NE(which.output.find("--object takes one of: venus, chess, cat, teapot"), std::string::npos) << which.output;
  const Ran unknown = show(source("rigs/gallery"), "features", folder / "a.png", {"--object", "venuss"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_NE(unknown.output.find("did you mean \"venus\"?"), std::string::npos) << unknown.output;
  EXPECT_FALSE(std::filesystem::exists(folder / "a.png"));
}

TEST(Show, RefusesObjectsWithoutRelief) {
  const Folder folder;
  const Ran ball = show(rig_with(folder, ball_obj()), "interest", folder / "a.png");
  EXPECT_EQ(ball.code, 2);
  EXPECT_NE(ball.output.find("thing: the target has no recessed places"), std::string::npos) << ball.output;
  const Ran cloud = show(rig_with(folder, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"), "domain", folder / "a.png");
  EXPECT_EQ(cloud.code, 2);
  EXPECT_NE(cloud.output.find("thing"), std::string::npos) << cloud.output;
  const Ran box = show(source("rigs/studio"), "features", folder / "a.png", {"--object", "table"});
  EXPECT_EQ(box.code, 2);
  EXPECT_NE(box.output.find("table: the target"), std::string::npos) << box.output;
}

TEST(Render, RefusesAnUnsupportedFileExtensionBeforeComputing) {
  const Folder folder;
  for (const char* name : {"a.gif", "a", "a.jpgg"}) {
    const Ran ran =
        luxrig::testing::run({program("luxrig"), "render", folder / "no-such-rig.toml", "-o", folder / name});
    EXPECT_EQ(ran.code, 2);
    EXPECT_NE(ran.output.find("end its name in .png or .jpg"), std::string::npos) << ran.output;
  }
}

TEST(Render, WritesJpegAndReportsItsExposure) {
  const Folder folder;
  const Ran ran =
      luxrig::testing::run({program("luxrig"), "render", source("rigs/studio"), "-o", folder / "a.jpg", "--exposure",
                            "-1", "--white-balance", "3000K", "--passes", "1", "--width", "32", "--height", "32"});
  EXPECT_EQ(ran.code, 0) << ran.output;
  EXPECT_NE(ran.output.find(") of 3000 K"), std::string::npos) << ran.output;
  std::ifstream in(folder / "a.jpg", std::ios::binary);
  EXPECT_EQ(in.get(), 0xFF);
  EXPECT_EQ(in.get(), 0xD8);
  for (const std::vector<std::string>& bad :
       {std::vector<std::string>{"--exposure", "bright"}, {"--white-balance", "warm"}}) {
    std::vector<std::string> words = {program("luxrig"), "render", source("rigs/studio"), "-o", folder / "b.png"};
    words.insert(words.end(), bad.begin(), bad.end());
    EXPECT_EQ(luxrig::testing::run(words).code, 2) << bad[1];
  }
}

// The key light is the same lamp, as far away, and the eye sees the ball's brightest place in both: so both have one white.
// As planned, the lamp is dimmed.
// The studio's camera looks at the skull in 540 × 420 pixels.
TEST(Render, DrawsWhatACameraOfTheRigSees) {
  const Folder folder;
  const auto render = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> command = {
        program("luxrig"), "render", source("rigs/studio"), "-o", (folder / "a.png").string(), "--camera", name,
        "--passes",        "1"};
    command.insert(command.end(), more.begin(), more.end());
    return luxrig::testing::run(command);
  };
  const auto size = [&](int at) {  // PNG: width at byte 16, height at 20
    const std::string png = text_of(folder / "a.png");
    int value = 0;
    for (int k = 0; k < 4; ++k)
      value = 256 * value + static_cast<unsigned char>(png.at(static_cast<std::size_t>(at + k)));
    return value;
  };
  const Ran own = render("front", {});
  ASSERT_EQ(own.code, 0) << own.output;
  const int width = size(16), height = size(20);
  const Ran asked = render("front", {"--width", "160", "--height", "120"});
  ASSERT_EQ(asked.code, 0) << asked.output;
  EXPECT_EQ(width - size(16), 540 - 160);
  EXPECT_EQ(height - size(20), 420 - 120);
  const Ran unknown = render("frnt", {});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_NE(unknown.output.find("did you mean \"front\"?"), std::string::npos) << unknown.output;
  EXPECT_NE(render("front", {"--fov-deg", "30"}).code, 0);
}

TEST(Compare, ShowsTheObjectInThreeLightsMeteredOnIt) {
  const Folder folder;
  const std::string rig = rig_with(folder, ball_obj());
  std::ofstream(rig, std::ios::app) << R"(
[[luminaire]]
name = "bulb"
model = "isotropic"
lumens = 800
[[bus]]
name = "dmx"
driver = "sacn"
[[fixture]]
name = "left"
luminaire = "bulb"
bus = "dmx"
universe = 1
address = 1
position_m = [-4, -2, 0]
[[point]]
name = "west"
position_m = [-1.001, 0, 0]
normal = [-1, 0, 0]
goal_lx = 2
)";
  const std::string plan = (folder / "plan.json").string();
  const auto png = folder / "sheet.png";
  ASSERT_EQ(luxrig::testing::run({program("luxrig"), "solve", rig, "-o", plan}).code, 0);
  const std::vector<std::string> command = {program("luxrig"), "render", rig,        "-o", png.string(), "--compare",
                                            "--passes",        "4",      "--eye",    "0",  "-6",         "0",
                                            "--width",         "300",    "--height", "100"};
  EXPECT_EQ(luxrig::testing::run(command).code, 2) << "without a plan";
  auto with_plan = command;
  with_plan.push_back(plan);
  const Ran ran = luxrig::testing::run(with_plan);
  ASSERT_EQ(ran.code, 0) << ran.output;
  for (const char* title : {"before: ", "after: ", "one key light, 45°"})
    EXPECT_NE(ran.output.find(title), std::string::npos) << ran.output;
  std::vector<double> white_cd_m2;
  const std::regex white("white is ([0-9.e+-]+) cd/m2");
  for (auto at = std::sregex_iterator(ran.output.begin(), ran.output.end(), white); at != std::sregex_iterator(); ++at)
    white_cd_m2.push_back(std::stod((*at)[1].str()));
  ASSERT_EQ(white_cd_m2.size(), 3u) << ran.output;
  EXPECT_NEAR(white_cd_m2[2], white_cd_m2[0], 0.15 * white_cd_m2[0]) << ran.output;
  EXPECT_GT(white_cd_m2[0], 1.2 * white_cd_m2[1]) << "all at full, and dimmed to the goal: " << ran.output;
  const std::string bytes = text_of(png);
  ASSERT_EQ(bytes.substr(1, 3), "PNG");
  // Big-endian width and height of the PNG's header.
  const auto number_at = [&](std::size_t at) {
    return (static_cast<unsigned char>(bytes[at + 2]) << 8) + static_cast<unsigned char>(bytes[at + 3]);
  };
  EXPECT_EQ(number_at(16), 300);
  EXPECT_EQ(number_at(20), 100);
}

TEST(Show, RefusesIncompatibleOptions) {
  const Folder folder;
  EXPECT_EQ(show(source("rigs/studio"), "curvatur", folder / "a.png").code, 2);
  EXPECT_EQ(show(source("rigs/studio"), "curvature", folder / "a.png", {"--false-colour", "lux"}).code, 2);
  const Ran ran = luxrig::testing::run(
      {program("luxrig"), "render", source("rigs/studio"), "-o", (folder / "a.png").string(), "--object", "skull"});
  EXPECT_EQ(ran.code, 2) << ran.output;
  const Ran eye =
      show(source("rigs/studio"), "curvature", folder / "a.png", {"--eye", "1", "1", "1", "--target", "1", "1", "1"});
  EXPECT_EQ(eye.code, 2);
  EXPECT_NE(eye.output.find("camera's target lies in its eye"), std::string::npos) << eye.output;
  const Ran nowhere = show(source("rigs/studio"), "curvature", folder / "no/such/folder/a.png");
  EXPECT_EQ(nowhere.code, 1);
  EXPECT_NE(nowhere.output.find("picture not written"), std::string::npos) << nowhere.output;
}

}  // namespace
}  // namespace luxrig::testing
