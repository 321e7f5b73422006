#include "core/photometry/files/ies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>

#include "tests/core/photometry/load_files.h"
#include "tests/core/photometry/photometric_data.h"

namespace luxrig {
namespace {

Intensity intensity_of(const std::string& text) {
  const auto file = parse_ies(text, "test.ies");
  if (!file) {
    ADD_FAILURE() << file.error().front().text();
    return make_isotropic(1);
  }
  return make_intensity(*file);
}

std::string joined(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += std::to_string(value) + " ";
  return text + "\n";
}

/// A file of the 2002 edition with the given angles and values.
std::string file_text(const std::vector<double>& vertical, const std::vector<double>& horizontal,
                      const std::vector<double>& candela, const std::string& factors = "1 1 10") {
  return "IESNA:LM-63-2002\n[TEST] written by the test\nTILT=NONE\n1 -1 1 " + std::to_string(vertical.size()) + " " +
         std::to_string(horizontal.size()) + " 1 2 0 0 0\n" + factors + "\n" + joined(vertical) + joined(horizontal) +
         joined(candela);
}

/// Flux by the midpoint rule over the whole sphere; uses only intensity_cd.
double summed_flux_lm(const IntensityDistribution& of, int rings, int spokes) {
  double sum = 0;
  for (int i = 0; i < rings; ++i) {
    const double gamma_deg = 180 * (i + 0.5) / rings;
    double ring = 0;
    for (int j = 0; j < spokes; ++j) ring += of.intensity_cd(direction(gamma_deg, 360 * (j + 0.5) / spokes));
    sum += ring * std::sin(rad_from_deg(gamma_deg));
  }
  return sum * (kPi / rings) * (2 * kPi / spokes);
}

struct RealFile {
  const char* name;
  const char* edition;
  std::size_t vertical, horizontal;
  double flux_lm;  ///< by bands, from the catalogue of the files
};
class RealFiles : public testing::TestWithParam<RealFile> {};

TEST_P(RealFiles, LoadWithTheirCatalogueFlux) {
  const RealFile& expected = GetParam();
  const auto file = load_ies(data_file(expected.name));
  ASSERT_TRUE(file.has_value()) << file.error().front().text();
  EXPECT_EQ(file->edition, expected.edition);
  EXPECT_EQ(file->vertical_deg.size(), expected.vertical);
  EXPECT_EQ(file->horizontal_deg.size(), expected.horizontal);
  EXPECT_EQ(file->candela.size(), expected.vertical * expected.horizontal);
  EXPECT_NEAR(make_intensity(*file)->flux_lm() / expected.flux_lm, 1, 0.01);
}

TEST_P(RealFiles, HaveTheFluxOfTheirInterpolatedIntensity) {
  const auto file = load_ies(data_file(GetParam().name));
  ASSERT_TRUE(file.has_value());
  const Intensity light = make_intensity(*file);
  // Midpoints of 0.05° rings and 1.25° spokes lie inside the cells, so only the rule's own error remains.
  const int spokes = file->horizontal_deg.size() == 1 ? 1 : 288;
  EXPECT_NEAR(summed_flux_lm(*light, 3600, spokes) / light->flux_lm(), 1, 2e-5);
}

TEST_P(RealFiles, ReturnTheirOwnValuesAtTheirOwnAngles) {
  const auto file = load_ies(data_file(GetParam().name));
  ASSERT_TRUE(file.has_value());
  const Intensity light = make_intensity(*file);
  const double largest = *std::max_element(file->candela.begin(), file->candela.end());
  EXPECT_DOUBLE_EQ(light->max_intensity_cd(), largest);
  for (std::size_t h = 0; h < file->horizontal_deg.size(); ++h) {
    for (std::size_t v = 0; v < file->vertical_deg.size(); ++v) {
      const double gamma_deg = file->vertical_deg[v];
      if (gamma_deg == 0 || gamma_deg == 180) continue;  // all planes meet there
      const double stored = file->candela[h * file->vertical_deg.size() + v];
      EXPECT_NEAR(light->intensity_cd(direction(gamma_deg, file->horizontal_deg[h])), stored, 1e-8 * largest)
          << gamma_deg << " " << file->horizontal_deg[h];
    }
  }
}

const RealFile kRealFiles[] = {
    {"007cfb11e343e2f42e3b476be4ab684e.ies", "IESNA:LM-63-1995", 73, 1, 321.2},
    {"02a7562c650498ebb301153dbbf59207.ies", "IESNA:LM-63-1995", 37, 37, 9600.1},
    {"06b4cfdc8805709e767b5e2e904be8ad.ies", "IESNA:LM-63-1995", 19, 24, 1224.6},
    {"area_light.ies", "IESNA:LM-63-1995", 35, 35, 28338.1},
    {"comet.ies", "IESNA:LM-63-1995", 19, 5, 16073.7},
    {"cylinder_narrow.ies", "IESNA:LM-63-1995", 19, 1, 2976.5},
    {"defined.ies", "IESNA91", 37, 1, 13148.3},
    {"defined_diffuse.ies", "", 19, 1, 1305.2},
    {"display.ies", "", 73, 2, 4055.8},
    {"jelly_fish.ies", "IESNA:LM-63-1995", 25, 21, 6484.4},
    {"overhead.ies", "IESNA:LM-63-1995", 19, 5, 37030.9},
    {"parallel_beam.ies", "IESNA:LM-63-2002", 19, 7, 3259.8},
    {"soft_arrow.ies", "IESNA91", 36, 1, 796.5},
    {"three_lobe_umbrella.ies", "IESNA:LM-63-1995", 37, 1, 1005.1},
    {"LightProfile.ies", "IES:LM-63-2019", 10, 1, 8749.7},
    {"tilt_include_geometry2.ies", "IES:LM-63-2019", 7, 5, 13227.6},
    {"trapezoid.ies", "IESNA:LM-63-2002", 25, 21, 14428.9},
    {"x_arrow.ies", "IESNA:LM-63-1995", 73, 1, 524.6},
};
INSTANTIATE_TEST_SUITE_P(Of, RealFiles, testing::ValuesIn(kRealFiles), [](const auto& of) {
  std::string name = of.param.name;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
  return name;
});

TEST(Ies, RefusesRadiometricFilesOfFarUvcSources) {
  for (const char* name : {"B1 module.ies", "LLIA001477-002.ies", "aerolamp.ies"}) {
    const auto far_uvc = load_ies(data_file(name));
    ASSERT_FALSE(far_uvc.has_value());
    EXPECT_NE(far_uvc.error().front().what.find("radiometric"), std::string::npos);
    EXPECT_GT(far_uvc.error().front().line, 1);
  }
}

TEST(Ies, AppliesMultiplierAndBallastFactorAndTheSecondFactorOnlyInOldEditions) {
  const std::string body = "TILT=NONE\n1 -1 2 2 1 1 2 0 0 0\n0.5 1.10001 10\n0 90\n0\n100 100\n";
  const auto candela = [&](const std::string& edition) {
    const auto file = parse_ies(edition + body, "test.ies");
    return file ? file->candela.front() : -1;
  };
  EXPECT_DOUBLE_EQ(candela(""), 100 * 1.10001);
  EXPECT_DOUBLE_EQ(candela("IESNA91\n"), 100 * 1.10001);
  EXPECT_DOUBLE_EQ(candela("IESNA:LM-63-1995\n"), 100);
  EXPECT_DOUBLE_EQ(candela("IESNA:LM-63-2002\n"), 100);
  EXPECT_DOUBLE_EQ(candela("IES:LM-63-2019\n"), 100);
}

TEST(Ies, ConvertsFeetAndKeepsTheSignsOfTheOpening) {
  const auto file = parse_ies("IES:LM-63-2019\nTILT=NONE\n2 1200 1 2 1 1 1 -1 -2 .5\n1 1 25\n0 90\n0\n100 0\n", "f");
  ASSERT_TRUE(file.has_value());
  EXPECT_DOUBLE_EQ(file->width_m, -0.3048);
  EXPECT_DOUBLE_EQ(file->length_m, -0.6096);
  EXPECT_DOUBLE_EQ(file->height_m, 0.1524);
  EXPECT_EQ(file->lamps, 2);
  EXPECT_DOUBLE_EQ(file->lumens_per_lamp, 1200);
  EXPECT_DOUBLE_EQ(file->input_w, 25);
}

TEST(Ies, ToleratesTheQuirksOfRealFiles) {
  const std::string texts[] = {
      "\xEF\xBB\xBFIESNA91\r\nTILT = NONE\r\n1 -1 1 2 1 1 2 0 0 0\r\n1 1 5\r\n0 90\r\n0\r\n100 100\r\n\x1a",
      "tilt=none 1,-1,1.,2,1,1,2,0,0,.0,1,1,5,0,90,0,1e2,100",
      "IES:LM-63-2019\rTILT=NONE\r1\t-1\t1\t2\t1\t1\t2\t0\t0\t0\r1 1 5\r0 90\r0\r+100 100\rEND of file, 7 8",
  };
  for (const std::string& text : texts) {
    const Intensity light = intensity_of(text);
    EXPECT_NEAR(light->flux_lm(), 200 * kPi, 1e-9) << text;
  }
}

TEST(Ies, AppliesTheTiltFactorOfAnUprightLampAndReportsIt) {
  const auto file = parse_ies(
      "IESNA:LM-63-2002\nTILT=INCLUDE\n1\n3\n0 45 90\n0.9 0.8 0.7\n1 -1 1 2 1 1 2 0 0 0\n1 1 5\n0 90\n0\n100 100\n",
      "f");
  ASSERT_TRUE(file.has_value());
  EXPECT_DOUBLE_EQ(file->candela.front(), 90);
  ASSERT_EQ(file->warnings.size(), 1u);
  EXPECT_NE(file->warnings.front().find("tilt"), std::string::npos);
}

TEST(Ies, WarnsWhenTheDistributionExceedsItsLampFlux) {
  const auto text = [](double lumens) {
    return "IES:LM-63-2019\nTILT=NONE\n1 " + std::to_string(lumens) +
           " 1 2 1 1 2 0 0 0\n1 1 25\n0 90\n0\n100 100\n";  // 628.3 lm
  };
  EXPECT_EQ(parse_ies(text(590), "f")->warnings.size(), 1u);
  EXPECT_EQ(parse_ies(text(600), "f")->warnings.size(), 0u);
  EXPECT_EQ(parse_ies(text(2000), "f")->warnings.size(), 0u);  // a luminaire keeps part of its lamps' light
}

TEST(IesSymmetry, QuadrantFilesAreMirroredInBothPlanes) {
  const Intensity light = intensity_of(file_text({0, 90}, {0, 45, 90}, {10, 20, 10, 30, 10, 40}));
  for (const double c : {20.0, 160.0, 200.0, 340.0}) {
    EXPECT_NEAR(light->intensity_cd(direction(90, c)), 20 + 10 * 20 / 45.0, 1e-9) << c;
  }
}

TEST(IesSymmetry, HalfFilesAreMirroredAboutThePlaneTheyEndOn) {
  const Intensity about_0 = intensity_of(file_text({0, 90}, {0, 90, 180}, {10, 20, 10, 30, 10, 40}));
  EXPECT_NEAR(about_0->intensity_cd(direction(90, 120)), about_0->intensity_cd(direction(90, 240)), 1e-9);
  EXPECT_NEAR(about_0->intensity_cd(direction(90, 0)), 20, 1e-9);
  EXPECT_NEAR(about_0->intensity_cd(direction(90, 180)), 40, 1e-9);

  const Intensity about_90 = intensity_of(file_text({0, 90}, {90, 180, 270}, {10, 20, 10, 30, 10, 40}));
  EXPECT_NEAR(about_90->intensity_cd(direction(90, 90)), 20, 1e-9);
  EXPECT_NEAR(about_90->intensity_cd(direction(90, 180)), 30, 1e-9);
  EXPECT_NEAR(about_90->intensity_cd(direction(90, 0)), 30, 1e-9);
  EXPECT_NEAR(about_90->intensity_cd(direction(90, 270)), 40, 1e-9);
  EXPECT_NEAR(about_90->intensity_cd(direction(90, 315)), 35, 1e-9);
  EXPECT_NEAR(about_90->intensity_cd(direction(90, 225)), 35, 1e-9);
}

TEST(IesSymmetry, ClosesPlanesThatStopOneShortOf360) {
  const Intensity light = intensity_of(file_text({0, 90}, {0, 120, 240}, {10, 20, 10, 30, 10, 40}));
  EXPECT_NEAR(light->intensity_cd(direction(90, 300)), 30, 1e-9);
  EXPECT_NEAR(light->intensity_cd(direction(90, 360)), 20, 1e-9);
  EXPECT_NEAR(light->intensity_cd(direction(90, -1e-9)), 20, 1e-6);
}

TEST(IesSymmetry, RefusesInvalidRanges) {
  EXPECT_FALSE(parse_ies(file_text({0, 90}, {0, 60, 120}, {1, 1, 1, 1, 1, 1}), "f").has_value());
  EXPECT_FALSE(parse_ies(file_text({0, 90}, {10, 360}, {1, 1, 1, 1}), "f").has_value());
}

TEST(IesFlux, IsExactForDistributionsWithAClosedForm) {
  // Uniform over the lower hemisphere: 2πI.
  EXPECT_NEAR(intensity_of(file_text({0, 90}, {0}, {100, 100}))->flux_lm(), 200 * kPi, 1e-9);
  // Falling linearly from nadir to horizon: 2πI ∫ (1 - 2γ/π) sin γ dγ = 2πI (1 - 2/π).
  EXPECT_NEAR(intensity_of(file_text({0, 90}, {0}, {100, 0}))->flux_lm(), 200 * kPi * (1 - 2 / kPi), 1e-9);
  // The same in needlessly many steps of very unequal size.
  std::vector<double> angles, values;
  for (int i = 0; i <= 3000; ++i) angles.push_back(90.0 * i * i / 9e6);
  for (const double angle : angles) values.push_back(100 * (1 - angle / 90));
  std::vector<double> kept_angles{0}, kept_values{100};  // to_string keeps six places
  for (std::size_t i = 1; i < angles.size(); ++i) {
    if (angles[i] - kept_angles.back() < 1e-4) continue;
    kept_angles.push_back(angles[i]);
    kept_values.push_back(values[i]);
  }
  EXPECT_NEAR(intensity_of(file_text(kept_angles, {0}, kept_values))->flux_lm(), 200 * kPi * (1 - 2 / kPi), 1e-3);
  // Upward only.
  EXPECT_NEAR(intensity_of(file_text({90, 180}, {0, 360}, {50, 50, 50, 50}))->flux_lm(), 100 * kPi, 1e-9);
}

TEST(IesIntensity, IsZeroBeyondTheVerticalRangeAndFullOnItsLastAngle) {
  const Intensity light = intensity_of(file_text({0, 90}, {0}, {100, 80}));
  EXPECT_NEAR(light->intensity_cd(direction(90, 77)), 80, 1e-6);
  EXPECT_EQ(light->intensity_cd(direction(90.001, 77)), 0);
  EXPECT_EQ(light->intensity_cd(Vec3::UnitZ()), 0);
}

TEST(IesIntensity, ConeEndsWhereTheLightDoes) {
  EXPECT_NEAR(intensity_of(file_text({0, 30, 45, 90}, {0}, {9, 1, 0, 0}))->emission_cone_rad(), kPi / 2, 1e-12);
  EXPECT_NEAR(intensity_of(file_text({0, 90}, {0}, {9, 1}))->emission_cone_rad(), kPi, 1e-12);
  EXPECT_NEAR(intensity_of(file_text({0, 90, 180}, {0}, {9, 1, 0}))->emission_cone_rad(), 2 * kPi, 1e-12);
}

TEST(IesIntensity, AgreesWithASearchThroughUnevenAngles) {
  // Uneven angles find their cell in another way than even ones: both must interpolate as written here.
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int round = 0; round < 20; ++round) {
    std::vector<double> vertical{0}, horizontal{0}, candela;
    while (vertical.back() < 160) vertical.push_back(vertical.back() + 1 + std::round(15 * unit(random)));
    vertical.push_back(180);
    while (horizontal.back() < 330) horizontal.push_back(horizontal.back() + 1 + std::round(25 * unit(random)));
    horizontal.push_back(360);
    for (std::size_t i = 0; i < vertical.size() * horizontal.size(); ++i)
      candela.push_back(std::round(999 * unit(random)));
    for (std::size_t i = 0; i < vertical.size(); ++i) candela[candela.size() - vertical.size() + i] = candela[i];
    const Intensity light = intensity_of(file_text(vertical, horizontal, candela));
    for (int i = 0; i < 200; ++i) {
      const double gamma = 180 * unit(random);
      const double c = 360 * unit(random);
      std::size_t v = 0, h = 0;
      while (v + 2 < vertical.size() && vertical[v + 1] < gamma) ++v;
      while (h + 2 < horizontal.size() && horizontal[h + 1] < c) ++h;
      const double s = (gamma - vertical[v]) / (vertical[v + 1] - vertical[v]);
      const double t = (c - horizontal[h]) / (horizontal[h + 1] - horizontal[h]);
      const auto at = [&](std::size_t hi, std::size_t vi) { return candela[hi * vertical.size() + vi]; };
      const double expected =
          (1 - t) * ((1 - s) * at(h, v) + s * at(h, v + 1)) + t * ((1 - s) * at(h + 1, v) + s * at(h + 1, v + 1));
      EXPECT_NEAR(light->intensity_cd(direction(gamma, c)), expected, 1e-6);
    }
  }
}

struct BadText {
  const char* what;  ///< part of the message
  int line, column;
  std::string text;
};

TEST(Ies, ReportsWhereAndWhatIsWrong) {
  const std::string head = "IESNA:LM-63-2002\nTILT=NONE\n";
  const BadText bad[] = {
      {"no TILT= line", 1, 1, ""},
      {"no TILT= line", 1, 1, "IESNA91\n[TEST] nothing follows\n"},
      {"TILT factors in another file", 2, 1, "IESNA91\nTILT=lamp.tlt\n1"},
      {"the file ends before the number of lamps", 3, 1, head},
      {"candela value 3 of 4", 8, 1, head + "1 -1 1 2 2 1 2 0 0 0\n1 1 1\n0 90\n0 90\n1 2\n"},
      {"number of lamps 'x' is not a number", 3, 1, head + "x -1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n1 1\n"},
      {"candela value 'nan'", 6, 5, head + "1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0 1 nan\n"},
      {"candela value 'inf'", 6, 5, head + "1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0 1 inf\n"},
      {"candela value '-5'", 7, 3, head + "1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n1 -5\n"},
      {"vertical angles do not ascend: 45 follows 90", 5, 1, head + "1 -1 1 3 1 1 2 0 0 0\n1 1 1\n0 90 45\n0\n1 1 1\n"},
      {"vertical angle '190'", 5, 3, head + "1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 190\n0\n1 1\n"},
      {"number of vertical angles '20000'", 3, 8, head + "1 -1 1 20000 1 1 2 0 0 0\n1 1 1\n"},
      {"more than 4 million", 3, 8, head + "1 -1 1 9999 9999 1 2 0 0 0\n1 1 1\n"},
      {"number of vertical angles is not a whole number", 3, 8, head + "1 -1 1 2.5 1 1 2 0 0 0\n1 1 1\n0 90 0 1 1"},
      {"one vertical angle", 3, 8, head + "1 -1 1 1 1 1 2 0 0 0\n1 1 1\n0 0 1"},
      {"fit no symmetry of type A", 5, 1, head + "1 -1 1 2 2 3 2 0 0 0\n1 1 1\n10 90\n0 90\n1 1 1 1\n"},
      {"fit no symmetry of type B", 6, 1, head + "1 -1 1 2 2 2 2 0 0 0\n1 1 1\n0 90\n10 90\n1 1 1 1\n"},
      {"vertical angle '100'", 5, 3, head + "1 -1 1 2 2 2 2 0 0 0\n1 1 1\n0 100\n0 90\n1 1 1 1\n"},
      {"one horizontal angle, and vertical", 5, 1, head + "1 -1 1 2 1 2 2 0 0 0\n1 1 1\n-90 90\n0\n1 1\n"},
      {"tilt angles do not ascend", 5, 1, "IESNA91\nTILT=INCLUDE\n1\n2\n90 0\n1 1\n"},
      {"lamp-to-luminaire geometry '4'", 3, 1, "IESNA91\nTILT=INCLUDE\n4\n2\n0 90\n1 1\n"},
      {"tilt factor '0' is out of range", 6, 1, "IESNA91\nTILT=INCLUDE\n1\n2\n0 90\n0 1\n"},
      {"photometric type '7'", 3, 12, head + "1 -1 1 2 1 7 2 0 0 0\n1 1 1\n0 90\n0\n1 1\n"},
      {"lumens per lamp", 3, 3, head + "1 -0.5 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n1 1\n"},
      {"a multiplier or ballast factor is 0", 3, 6, head + "1 -1 0 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n1 1\n"},
      {"gives no light", 7, 1, head + "1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n0 0\n"},
      {"fit no symmetry", 6, 1, head + "1 -1 1 2 2 1 2 0 0 0\n1 1 1\n0 90\n0 100\n1 1 1 1\n"},
      {"number '0,5' has a decimal comma", 3, 16, head + "1 -1 1 2 1 1 2 0,5 0 0\n1 1 1\n0 90\n0\n1 1\n"},
      {"number '1,5' has a decimal comma", 7, 3, head + "1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n1 1,5\n"},
      {"number '1,0' has a decimal comma", 3, 6, head + "1 -1 1,0 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n1 1\n"},
  };
  for (const BadText& one : bad) {
    const auto file = parse_ies(one.text, "lamp.ies");
    ASSERT_FALSE(file.has_value()) << one.what;
    const Problem& problem = file.error().front();
    EXPECT_NE(problem.what.find(one.what), std::string::npos) << problem.text();
    EXPECT_EQ(problem.file, "lamp.ies");
    EXPECT_EQ(problem.line, one.line) << problem.text();
    EXPECT_EQ(problem.column, one.column) << problem.text();
    EXPECT_FALSE(problem.mend.empty());
  }
}

TEST(Ies, ReadsNumbersSeparatedByCommas) {
  const auto file = parse_ies("IESNA91\nTILT=NONE\n1,-1,1,2,2,1,2,0,0,0\n1,1,1\n0,90\n0, 90\n100,0,100,0\n", "f");
  ASSERT_TRUE(file.has_value()) << file.error().front().text();
  EXPECT_EQ(file->candela, (std::vector<double>{100, 0, 100, 0}));
  EXPECT_TRUE(file->warnings.empty());
}

TEST(Ies, WarnsOfValuesAfterItsEnd) {
  const std::string whole = "IESNA91\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n100 0\n";
  for (const char* nothing : {"", "\n \n", "\x1a", ","}) EXPECT_TRUE(parse_ies(whole + nothing, "f")->warnings.empty());
  const auto more = parse_ies(whole + "\n7 8 9\n", "f");
  ASSERT_TRUE(more.has_value());
  ASSERT_EQ(more->warnings.size(), 1u);
  EXPECT_EQ(more->warnings[0], "from line 9 on, 3 values after the last candela value are not read: '7' …");
}

TEST(Ies, ReadsUtf16AndByteOrderMarks) {
  const std::string text = "IESNA91\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n100 0\n";
  std::string little, big;
  for (const char c : text) {
    little += {c, '\0'};
    big += {'\0', c};
  }
  for (const std::string& one : {text, "\xEF\xBB\xBF" + text, little, big, "\xFF\xFE" + little, "\xFE\xFF" + big}) {
    const auto file = parse_ies(one, "f");
    ASSERT_TRUE(file.has_value()) << file.error().front().text();
    EXPECT_EQ(file->edition, "IESNA91");
    EXPECT_EQ(file->candela, (std::vector<double>{100, 0}));
  }
}

TEST(Ies, ReportsEveryBadValueUpToALimit) {
  const auto two = parse_ies(file_text({0, 45, 90}, {0}, {-1, 5, -2}), "f");
  ASSERT_FALSE(two.has_value());
  EXPECT_EQ(two.error().size(), 2u);
  const auto many = parse_ies(file_text({0, 90}, std::vector<double>(500, 0.0), std::vector<double>(1000, -1.0)), "f");
  ASSERT_FALSE(many.has_value());
  EXPECT_LE(many.error().size(), 20u);
}

TEST(Ies, RefusesAFileTruncatedAnywhereBeforeItsLastNumber) {
  std::ifstream in(data_file("comet.ies"), std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  ASSERT_FALSE(text.empty());
  const std::size_t last_number = text.find_last_of(' ') + 1;
  for (std::size_t length = 0; length <= last_number; ++length) {
    EXPECT_FALSE(parse_ies(std::string_view(text).substr(0, length), "f").has_value()) << length;
  }
  EXPECT_TRUE(parse_ies(text, "f").has_value());
}

TEST(Ies, RefusesAPathThatIsNotAFile) {
  EXPECT_FALSE(load_ies(data_file("missing.ies")).has_value());
  EXPECT_FALSE(load_ies(data_file("")).has_value());
  EXPECT_FALSE(load_ies("/dev/zero").has_value());
}

}  // namespace
}  // namespace luxrig
