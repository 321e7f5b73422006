#include "core/photometry/files/eulumdat.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>

#include "tests/core/photometry/load_files.h"
#include "tests/core/photometry/photometric_data.h"

namespace luxrig {
namespace {

/// The lines of a file with the given grid: 500 lm lamps, conversion factor 2, so that the values are candela.
struct Text {
  std::vector<std::string> lines;
  Text(int symmetry, const std::vector<double>& c, const std::vector<double>& gamma,
       const std::vector<double>& values) {
    lines = {"maker",
             "1",
             std::to_string(symmetry),
             std::to_string(c.size()),
             "0",
             std::to_string(gamma.size()),
             "0",
             "report",
             "name",
             "number",
             "file",
             "date",
             "300",
             "0",
             "100",
             "200",
             "0",
             "0",
             "0",
             "0",
             "0",
             "100",
             "100",
             "2",
             "0",
             "1",
             "1",
             "LED",
             "500",
             "3000 K",
             "80",
             "9"};
    for (int i = 0; i < 10; ++i) lines.push_back("0.5");
    for (const auto* list : {&c, &gamma, &values}) {
      for (const double value : *list) lines.push_back(number(value));
    }
  }
  static std::string number(double value) {
    std::ostringstream text;
    text << value;
    return text.str();
  }
  [[nodiscard]] std::string joined(const std::string& end = "\r\n") const {
    std::string text;
    for (const std::string& line : lines) text += line + end;
    return text;
  }
};

EulumdatFile parsed_eulumdat(const std::string& text) {
  const auto file = parse_eulumdat(text, "test.ldt");
  if (!file) {
    ADD_FAILURE() << file.error().front().text();
    return {};
  }
  return *file;
}

const std::vector<double> kEight{0, 45, 90, 135, 180, 225, 270, 315};

TEST(Eulumdat, ConvertsItsFieldsToOurUnits) {
  Text text(1, {0}, {0, 90}, {100, 50});
  text.lines[21] = "87.5";
  text.lines[13] = "250";
  text.lines[24] = "15";
  const EulumdatFile file = parsed_eulumdat(text.joined());
  EXPECT_EQ(file.company, "maker");
  EXPECT_EQ(file.name, "name");
  EXPECT_DOUBLE_EQ(file.length_m, 0.3);
  EXPECT_DOUBLE_EQ(file.width_m, 0.25);
  EXPECT_DOUBLE_EQ(file.luminous_length_m, 0.2);
  EXPECT_DOUBLE_EQ(file.downward_share, 0.875);
  EXPECT_DOUBLE_EQ(file.conversion_factor, 2);
  EXPECT_DOUBLE_EQ(file.tilt_deg, 15);
  EXPECT_DOUBLE_EQ(file.direct_ratios[9], 0.5);
  ASSERT_EQ(file.lamp_sets.size(), 1u);
  EXPECT_EQ(file.lamp_sets[0].colour, "3000 K");
  EXPECT_DOUBLE_EQ(file.lamp_sets[0].watts, 9);
  EXPECT_NEAR(make_intensity(file)->intensity_cd(direction(45, 77)), 75, 1e-9);
}

TEST(Eulumdat, ScalesByTheChosenLampSet) {
  Text text(1, {0}, {0, 90}, {100, 100});
  text.lines[25] = "2";
  text.lines.insert(text.lines.begin() + 32, {"-2", "LED", "1500", "4000 K", "90", "20"});
  const EulumdatFile file = parsed_eulumdat(text.joined());
  ASSERT_EQ(file.lamp_sets.size(), 2u);
  EXPECT_FALSE(file.lamp_sets[0].absolute);
  EXPECT_TRUE(file.lamp_sets[1].absolute);
  EXPECT_EQ(file.lamp_sets[1].lamps, 2);
  EXPECT_NEAR(make_intensity(file)->flux_lm(), 200 * kPi, 1e-9);
  EXPECT_NEAR(make_intensity(file, 1)->flux_lm(), 600 * kPi, 1e-9);
  EXPECT_NE(file.warnings.back().find("2 lamp sets"), std::string::npos);
}

TEST(EulumdatSymmetry, None) {
  const Intensity light =
      make_intensity(parsed_eulumdat(Text(0, {0, 120, 240}, {0, 90}, {10, 20, 10, 30, 10, 40}).joined()));
  EXPECT_NEAR(light->intensity_cd(direction(90, 120)), 30, 1e-9);
  EXPECT_NEAR(light->intensity_cd(direction(90, 300)), 30, 1e-9);
  EXPECT_NEAR(light->intensity_cd(direction(90, 360)), 20, 1e-9);
}

TEST(EulumdatSymmetry, RoundKeepsOnePlaneOfMany) {
  const EulumdatFile file = parsed_eulumdat(Text(1, kEight, {0, 90}, {10, 20}).joined());
  EXPECT_EQ(file.stored_planes(), 1u);
  EXPECT_NEAR(make_intensity(file)->intensity_cd(direction(90, 200)), 20, 1e-9);
}

TEST(EulumdatSymmetry, AboutC0C180) {
  const EulumdatFile file = parsed_eulumdat(Text(2, kEight, {0, 90}, {1, 10, 1, 20, 1, 30, 1, 40, 1, 50}).joined());
  EXPECT_EQ(file.stored_planes(), 5u);
  const Intensity light = make_intensity(file);
  for (const auto& [c, cd] : std::vector<std::pair<double, double>>{{0, 10}, {90, 30}, {180, 50}, {270, 30}, {315, 20}})
    EXPECT_NEAR(light->intensity_cd(direction(90, c)), cd, 1e-9) << c;
}

TEST(EulumdatSymmetry, AboutC90C270HoldsTheHalfThroughC0) {
  // In file order: C270, C315, C0, C45, C90.
  const EulumdatFile file = parsed_eulumdat(Text(3, kEight, {0, 90}, {1, 10, 1, 20, 1, 30, 1, 40, 1, 50}).joined());
  EXPECT_EQ(file.stored_first(), 6u);
  const Intensity light = make_intensity(file);
  for (const auto& [c, cd] : std::vector<std::pair<double, double>>{
           {270, 10}, {315, 20}, {0, 30}, {45, 40}, {90, 50}, {135, 40}, {180, 30}, {225, 20}, {22.5, 35}, {292.5, 15}})
    EXPECT_NEAR(light->intensity_cd(direction(90, c)), cd, 1e-9) << c;
}

TEST(EulumdatSymmetry, Both) {
  const Intensity light = make_intensity(parsed_eulumdat(Text(4, kEight, {0, 90}, {1, 10, 1, 20, 1, 30}).joined()));
  for (const double c : {45.0, 135.0, 225.0, 315.0}) EXPECT_NEAR(light->intensity_cd(direction(90, c)), 20, 1e-9) << c;
  EXPECT_NEAR(light->intensity_cd(direction(90, 270)), 30, 1e-9);
}

TEST(EulumdatSymmetry, OnePlaneIsRoundForAnySymmetryField) {
  for (int symmetry = 0; symmetry <= 4; ++symmetry) {
    const Intensity light = make_intensity(parsed_eulumdat(Text(symmetry, {0}, {0, 90}, {10, 20}).joined()));
    EXPECT_NEAR(light->flux_lm(), make_intensity(parsed_eulumdat(Text(1, {0}, {0, 90}, {10, 20}).joined()))->flux_lm(),
                1e-9);
  }
}

TEST(Eulumdat, ToleratesTheQuirksOfRealFiles) {
  const Text plain(1, {0}, {0, 90}, {100.5, 100.5});
  const double flux_lm = make_intensity(parsed_eulumdat(plain.joined()))->flux_lm();
  Text odd = plain;
  for (std::string& line : odd.lines) {
    if (line == "100.5") line = "  100,5\t";
  }
  odd.lines[0] = "\xFC\xC3\x83\xC5\x93 maker";  // Latin-1 and mangled UTF-8
  odd.lines[17] = "";
  odd.lines[31] = "";
  for (const std::string end : {"\n", "\r", "\r\n"}) {
    for (const std::string start : {"", "\xEF\xBB\xBF"}) {
      EXPECT_DOUBLE_EQ(make_intensity(parsed_eulumdat(start + odd.joined(end) + end + "  " + end))->flux_lm(), flux_lm);
    }
  }
}

TEST(Eulumdat, WarnsWhenItsIntensitiesContradictItsLampFlux) {
  // Uniform below: 2π · 79.577 cd = 500 lm.
  const double cd = 500 / (2 * kPi);
  EXPECT_TRUE(parsed_eulumdat(Text(1, {0}, {0, 90}, {cd, cd}).joined()).warnings.empty());
  for (const double factor : {0.9, 1.1}) {
    const EulumdatFile file = parsed_eulumdat(Text(1, {0}, {0, 90}, {factor * cd, factor * cd}).joined());
    ASSERT_EQ(file.warnings.size(), 1u);
    EXPECT_NE(file.warnings[0].find("of the lamps' flux is 500 lm"), std::string::npos) << file.warnings[0];
  }
}

TEST(Eulumdat, ReturnsItsOwnValuesAtItsOwnAngles) {
  for (const char* name : {"sample1.ldt", "sample2.ldt", "sample3.ldt", "sample5.ldt", "sample6.ldt", "sample9.ldt"}) {
    const auto file = load_eulumdat(data_file(name));
    ASSERT_TRUE(file.has_value()) << file.error().front().text();
    const Intensity light = make_intensity(*file);
    const double scale = file->conversion_factor * file->lamp_sets[0].flux_lm / 1000;
    for (std::size_t i = 0; i < file->stored_planes(); ++i) {
      const double c = file->c_deg[(file->stored_first() + i) % file->c_deg.size()];
      for (std::size_t g = 0; g < file->gamma_deg.size(); ++g) {
        if (file->gamma_deg[g] == 0 || file->gamma_deg[g] == 180) continue;  // all planes meet there
        const double stored = file->cd_per_klm[i * file->gamma_deg.size() + g] * scale;
        ASSERT_NEAR(light->intensity_cd(direction(file->gamma_deg[g], c)), stored, 1e-8 * light->max_intensity_cd())
            << name << " " << c << " " << file->gamma_deg[g];
      }
    }
  }
}

struct BadLine {
  std::size_t line;  ///< 1-based line to replace
  const char* text;
  const char* what;
};

TEST(Eulumdat, ReportsWhereAndWhatIsWrong) {
  const BadLine bad[] = {
      {3, "5", "symmetry (field 3) '5' is out of range"},
      {3, "x", "symmetry (field 3) 'x' is not a number"},
      {3, "", "symmetry (field 3) is empty"},
      {4, "7", "does not fit symmetry 4"},
      {4, "20000", "is out of range"},
      {6, "1", "one angle in a plane"},
      {6, "2.5", "is not a whole number"},
      {13, "-1", "length (field 13) '-1' is out of range"},
      {24, "0", "the conversion factor is 0"},
      {26, "0", "number of lamp sets"},
      {27, "0", "is no count"},
      {27, "-1e20", "number of lamps (field 26a) '-1e20' is out of range"},
      {29, "0", "the lamp flux is 0"},
      {29, "nan", "is not a number"},
      {43, "10", "C plane 1 of 8 is at 10"},
      {45, "80", "C plane 3 of 8 is at 80"},
      {46, "90", "C angles do not ascend"},
      {51, "90", "gamma angles do not ascend"},
      {53, "-4", "intensity 1 of 6 '-4' is out of range"},
      {58, "inf", "intensity 6 of 6 'inf' is not a number"},
      {1, "values in mW/sr", "radiometric"},
  };
  for (const BadLine& one : bad) {
    Text text(4, kEight, {0, 90}, {1, 10, 1, 20, 1, 30});
    text.lines[one.line - 1] = one.text;
    const auto file = parse_eulumdat(text.joined(), "lamp.ldt");
    ASSERT_FALSE(file.has_value()) << one.what;
    const Problem& problem = file.error().front();
    EXPECT_NE(problem.what.find(one.what), std::string::npos) << problem.text();
    EXPECT_EQ(problem.file, "lamp.ldt");
    // Lists that do not ascend are reported at their first line.
    const int line = std::string(one.what).find("ascend") == std::string::npos ? static_cast<int>(one.line)
                     : one.line == 46                                          ? 43
                                                                               : 51;
    EXPECT_EQ(problem.line, line) << problem.text();
    EXPECT_FALSE(problem.mend.empty());
  }
  const auto dark = parse_eulumdat(Text(1, {0}, {0, 90}, {0, 0}).joined(), "f");
  ASSERT_FALSE(dark.has_value());
  EXPECT_EQ(dark.error().front().line, 46);  // first line of the intensities
}

TEST(Eulumdat, ReadsUtf16) {
  std::string wide = "\xFF\xFE";
  for (const char c : Text(1, {0}, {0, 90}, {200, 0}).joined()) wide += {c, '\0'};
  const auto file = parse_eulumdat(wide, "f");
  ASSERT_TRUE(file.has_value()) << file.error().front().text();
  EXPECT_EQ(file->cd_per_klm, (std::vector<double>{200, 0}));
}

TEST(Eulumdat, WarnsOfValuesAfterItsEnd) {
  const std::string whole = Text(1, {0}, {0, 90}, {1000 / kPi, 0}).joined();
  const auto said = [&](const std::string& after) {
    const auto file = parse_eulumdat(whole + after, "f");
    return file && !file->warnings.empty() ? file->warnings.back() : std::string();
  };
  EXPECT_EQ(said("\r\n\x1a").find("not read"), std::string::npos);
  EXPECT_NE(said("\r\n12\r\n13\r\n").find("2 values after the last intensity are not read: '12'"), std::string::npos);
}

TEST(Eulumdat, NamesTheFirstMissingFieldOfATruncatedFile) {
  const Text whole(2, kEight, {0, 45, 90}, std::vector<double>(15, 7.0));
  for (std::size_t kept = 0; kept < whole.lines.size(); ++kept) {
    Text cut = whole;
    cut.lines.resize(kept);
    const auto file = parse_eulumdat(cut.joined(), "f");
    ASSERT_FALSE(file.has_value()) << kept;
    EXPECT_NE(file.error().front().what.find("the file ends before the "), std::string::npos);
    EXPECT_EQ(file.error().front().line, static_cast<int>(kept) + 1);
  }
  EXPECT_TRUE(parse_eulumdat(whole.joined(), "f").has_value());
}

TEST(EulumdatOpening, IsAcrossXAndAlongY) {
  using Kind = LuminousShape::Kind;
  EulumdatFile file;
  EXPECT_EQ(luminous_opening(file).shape, LuminousShape{});
  file.luminous_length_m = 1.2;
  EXPECT_EQ(luminous_opening(file).shape, (LuminousShape{Kind::disk, Vec3(1.2, 0, 0)}));
  file.luminous_height_m = {0.1, 0.1, 0.1, 0.1};
  EXPECT_EQ(luminous_opening(file).shape, (LuminousShape{Kind::cylinder, Vec3(1.2, 0, 0.1)}));
  EXPECT_TRUE(luminous_opening(file).note.empty());
  file.luminous_width_m = 0.3;
  EXPECT_EQ(luminous_opening(file).shape, (LuminousShape{Kind::rectangle, Vec3(0.3, 1.2, 0)}));
  EXPECT_FALSE(luminous_opening(file).note.empty());
}

}  // namespace
}  // namespace luxrig
