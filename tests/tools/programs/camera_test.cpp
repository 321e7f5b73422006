// luxrig camera: taking a picture, and checking a camera from the files of one that encodes with a gamma of 2.2.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "tests/tools/programs/live_rig.h"

namespace luxrig::testing {
namespace {

constexpr int kWidth_px = 96, kHeight_px = 64;

/// An exposure bracket as a camera would save it: light over two decades, noise of half a count.
void write_bracket(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.5);
  for (const double ms : {1.0, 1.7, 3.9, 6.7, 15.0, 26.0, 60.0})
    for (int frame = 1; frame <= 4; ++frame) {
      std::ofstream out(folder / fmt::format("wall_{}ms_{}.pgm", ms, frame), std::ios::binary);
      out << "P5 " << kWidth_px << " " << kHeight_px << " 255\n";
      for (int i = 0; i < kWidth_px * kHeight_px; ++i) {
        const double light = ms / 15 * std::pow(10.0, -2.0 * (i % kWidth_px) / kWidth_px);
        const double sample = 255 * std::pow(std::min(1.0, light), 1 / 2.2) + noise(random);
        out.put(static_cast<char>(static_cast<unsigned char>(std::lround(std::clamp(sample, 0.0, 255.0)))));
      }
    }
}

/// Pictures of a light at known levels, with this exponent as its dimmer curve, seen by a linear camera beside other
/// light.
void write_levels(const std::filesystem::path& folder, double exponent) {
  std::filesystem::create_directories(folder);
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0, 6);
  for (const double percent : {0.0, 6.0, 10.0, 25.0, 42.5, 70.0, 100.0})
    for (int frame = 1; frame <= 4; ++frame) {
      std::ofstream out(folder / fmt::format("wall_{}pct_{}.pgm", percent, frame), std::ios::binary);
      out << "P5 " << kWidth_px << " " << kHeight_px << " 65535\n";
      for (int i = 0; i < kWidth_px * kHeight_px; ++i) {
        const double place = std::pow(10.0, -1.5 * (i % kWidth_px) / kWidth_px);
        const double light = 0.8 * place * std::pow(percent / 100, exponent) + 0.05;
        const auto sample = static_cast<int>(std::lround(std::clamp(65535 * light + noise(random), 0.0, 65535.0)));
        out.put(static_cast<char>(sample >> 8)).put(static_cast<char>(sample & 255));
      }
    }
}

void write_rig(const std::filesystem::path& file, const std::string& more = "") {
  std::ofstream(file) << "[rig]\nname = \"cameras\"\n\n[[camera]]\nname = \"wall\"\nposition_m = [0, -3, 1.5]\n"
                      << "aim_m = [0, 0, 1]\nwidth_px = " << kWidth_px << "\nheight_px = " << kHeight_px
                      << "\nsource = \"files\"\nfiles = \"shots\"\n"
                      << more;
}

Ran camera(const std::vector<std::string>& words) {
  std::vector<std::string> all = {program("luxrig"), "camera"};
  all.insert(all.end(), words.begin(), words.end());
  return luxrig::testing::run(all);
}

TEST(CameraCommands, CheckByLevelsReportsTheDimmerAndItsLimits) {
  const Folder folder;
  write_rig(folder / "rig.toml");
  const std::string rig = (folder / "rig.toml").string();
  write_levels(folder / "shots", 1);
  const Ran good = camera({"check", rig, "--levels"});
  EXPECT_EQ(good.code, 0) << good.output;
  EXPECT_NE(good.output.find("linear light, and the dimmer is as stated"), std::string::npos) << good.output;
  EXPECT_NE(good.output.find("6 levels from 0.06 to 1"), std::string::npos) << good.output;
  write_levels(folder / "shots", 1.3);
  const Ran bent = camera({"check", rig, "--levels", "--json"});
  EXPECT_EQ(bent.code, 1) << bent.output;
  const json out = json::parse(bent.output, nullptr, false);
  ASSERT_TRUE(out.is_object()) << bent.output;
  EXPECT_TRUE(out["camera_linear"].get<bool>());
  EXPECT_NEAR(out["exponent"].get<double>(), 1.3, 0.01);
  EXPECT_NE(out["not_told"].get<std::string>().find("exposures"), std::string::npos);
  EXPECT_EQ(out["levels"].size(), 6u);
  std::filesystem::rename(folder / "shots" / "wall_25pct_1.pgm", folder / "shots" / "wall_b_1.pgm");
  const Ran unnamed = camera({"check", rig, "--levels"});
  EXPECT_EQ(unnamed.code, 1);
  EXPECT_NE(unnamed.output.find("name it as wall_40pct_1.png"), std::string::npos) << unnamed.output;
}

// The simulated lamp's curve is the rig file's raised to 1 ± 0.08, by the seed; its camera is linear.
TEST(CameraCommands, CheckByLevelsSeparatesASimulatedDimmerFromItsCamera) {
  const Folder folder;
  std::ofstream(folder / "rig.toml") << R"([rig]
name = "levels"
[[luminaire]]
name = "spot"
model = "spot"
beam_angle_deg = 20
field_angle_deg = 60
lumens = 2000
[[bus]]
name = "dmx"
driver = "sacn"
[[fixture]]
name = "lamp"
luminaire = "spot"
position_m = [0, 0, 3]
bus = "dmx"
address = 1
slots = ["dimmer", "dimmer-fine"]
[[scene.object]]
name = "table"
box_m = [4, 4, 0.5]
reflectance = 0.6
[[scene.object]]
name = "block"
box_m = [0.6, 0.6, 0.5]
position_m = [0.5, 0, 0.5]
[[camera]]
name = "eye"
position_m = [0, -4, 3]
aim_m = [0, 0, 0.5]
width_px = 64
height_px = 48
[[point]]
name = "middle"
position_m = [0, 0, 0.51]
)";
  std::vector<double> exponents;
  for (const char* seed : {"1", "2"}) {
    const Ran ran = camera({"check", (folder / "rig.toml").string(), "--sim", "--sim-seed", seed, "--frames", "3",
                            "--steps", "7", "--json"});
    const json out = json::parse(ran.output.substr(std::min(ran.output.find('{'), ran.output.size())), nullptr, false);
    ASSERT_TRUE(out.is_object()) << ran.output;
    EXPECT_TRUE(out["camera_told"].get<bool>()) << ran.output;
    EXPECT_TRUE(out["camera_linear"].get<bool>()) << ran.output;
    exponents.push_back(out["exponent"].get<double>());
    EXPECT_NEAR(exponents.back(), 1, 0.09) << ran.output;
    EXPECT_LT(out["light_off_power"].get<double>(), 0.02) << ran.output;
  }
  EXPECT_GT(std::abs(exponents[0] - exponents[1]), 0.003) << "two worlds";
}

TEST(CameraCommands, CheckReportsTheGammaAndItsCurveMakesPicturesLinear) {
  const Folder folder;
  write_bracket(folder / "shots");
  write_rig(folder / "rig.toml");
  const std::string rig = (folder / "rig.toml").string(), curve = (folder / "curve.csv").string();
  const Ran first = camera({"check", rig, "-o", curve});
  EXPECT_EQ(first.code, 1) << first.output;
  EXPECT_NE(first.output.find("not linear light yet, but can be"), std::string::npos) << first.output;
  EXPECT_NE(first.output.find("gamma"), std::string::npos) << first.output;
  const Ran as_json = camera({"check", rig, "--camera", "wall", "--json"});
  const json out = json::parse(as_json.output, nullptr, false);
  ASSERT_TRUE(out.is_object()) << as_json.output;
  EXPECT_NEAR(out["response"]["exponent"].get<double>(), 2.2, 0.03);
  EXPECT_FALSE(out["good"].get<bool>());
  // With the curve, twice the exposure gives twice the light.
  write_rig(folder / "rig.toml", "response_file = \"curve.csv\"\nfull_scale_cd_m2 = 400\n");
  const Ran second = camera({"check", rig});
  EXPECT_EQ(second.code, 0) << second.output;
  const std::string picture = (folder / "shot.pfm").string();
  const Ran shot = camera({"shot", rig, "-o", picture});
  EXPECT_EQ(shot.code, 0) << shot.output;
  EXPECT_NE(shot.output.find("exposed 60 ms"), std::string::npos) << shot.output;
  EXPECT_NE(shot.output.find("cd/m²"), std::string::npos) << shot.output;
  const std::string bytes = text_of(picture);
  ASSERT_EQ(bytes.size(), fmt::format("PF\n{} {}\n-1.0\n", kWidth_px, kHeight_px).size() + 12 * kWidth_px * kHeight_px);
  // At 3/4 of the width the light is 60 / 15 * 10^-1.5 of full scale, in all rows.
  double sum = 0;
  for (int y = 0; y < kHeight_px; ++y) {
    float light = 0;
    const auto pixel = static_cast<std::size_t>(y * kWidth_px + 3 * kWidth_px / 4);
    std::memcpy(&light, bytes.data() + bytes.size() - 12 * kWidth_px * kHeight_px + 12 * pixel, sizeof light);
    sum += static_cast<double>(light);
  }
  const double truly = 400 * 4 * std::pow(10.0, -1.5);
  EXPECT_NEAR(sum / kHeight_px, truly, 0.01 * truly);
}

TEST(CameraCommands, ReportErrors) {
  const Folder folder;
  const std::string rig = (folder / "rig.toml").string(), picture = (folder / "shot.pfm").string();
  write_rig(rig);
  const Ran empty = camera({"shot", rig, "-o", picture});
  EXPECT_EQ(empty.code, 1) << empty.output;
  EXPECT_NE(empty.output.find("shots"), std::string::npos) << empty.output;
  const Ran unknown = camera({"shot", rig, "--camera", "hall", "-o", picture});
  EXPECT_EQ(unknown.code, 2) << unknown.output;
  EXPECT_NE(unknown.output.find("there is no camera \"hall\""), std::string::npos) << unknown.output;
  EXPECT_FALSE(std::filesystem::exists(picture));
  std::ofstream(rig) << "[rig]\nname = \"none\"\n";
  const Ran none = camera({"check", rig});
  EXPECT_EQ(none.code, 2) << none.output;
  EXPECT_NE(none.output.find("no [[camera]] has a source"), std::string::npos) << none.output;
}

}  // namespace
}  // namespace luxrig::testing
