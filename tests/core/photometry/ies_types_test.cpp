// IES files beyond type C: types A and B, tilt, shapes of luminous openings.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "core/photometry/files/ies.h"
#include "tests/core/photometry/load_files.h"

namespace luxrig {
namespace {

IesFile parsed(const std::string& text) {
  const auto file = parse_ies(text, "test.ies");
  if (!file) {
    ADD_FAILURE() << file.error().front().text();
    return {};
  }
  return *file;
}

std::string joined_numbers(const std::vector<double>& values) {
  std::ostringstream text;
  for (const double value : values) text << value << " ";
  return text.str() + "\n";
}

/// type: 2 = B, 3 = A; candela [horizontal][vertical]
IesFile grid_file(int type, const std::vector<double>& vertical, const std::vector<double>& horizontal,
                  const std::vector<double>& candela) {
  return parsed("IES:LM-63-2019\nTILT=NONE\n1 -1 1 " + std::to_string(vertical.size()) + " " +
                std::to_string(horizontal.size()) + " " + std::to_string(type) + " 2 0 0 0\n1 1 9\n" +
                joined_numbers(vertical) + joined_numbers(horizontal) + joined_numbers(candela));
}

/// The header's formulas, written independently.
Vec3 direction_b(double v_deg, double h_deg) {
  const double v = rad_from_deg(v_deg), h = rad_from_deg(h_deg);
  return {std::cos(h) * std::sin(v), -std::sin(h), -std::cos(h) * std::cos(v)};
}
Vec3 direction_a(double y_deg, double x_deg) {
  const double y = rad_from_deg(y_deg), x = rad_from_deg(x_deg);
  return {std::cos(y) * std::sin(x), std::sin(y), -std::cos(y) * std::cos(x)};
}

TEST(IesTypeB, HasItsBeamAtTheNadirWithVerticalTowardsXAndHorizontalClockwise) {
  const std::vector<double> angles{-90, -45, 0, 45, 90};
  std::vector<double> candela(25, 0.0);
  for (std::size_t i = 0; i < 25; ++i) candela[i] = 100.0 + static_cast<double>(i);
  const Intensity light = make_intensity(grid_file(2, angles, angles, candela));
  EXPECT_NEAR(light->intensity_cd(-Vec3::UnitZ()), 112, 1e-9);                // (0, 0)
  EXPECT_NEAR(light->intensity_cd(Vec3(1, 0, -1).normalized()), 113, 1e-9);   // V = 45
  EXPECT_NEAR(light->intensity_cd(Vec3(0, -1, -1).normalized()), 117, 1e-9);  // H = 45
  EXPECT_NEAR(light->intensity_cd(Vec3(0, 1, -1).normalized()), 107, 1e-9);   // H = -45
  EXPECT_EQ(light->intensity_cd(Vec3::UnitZ()), 0);
  for (std::size_t h = 0; h < 5; ++h) {
    for (std::size_t v = 0; v < 5; ++v) {
      if (std::abs(angles[h]) == 90) continue;  // all planes meet there
      EXPECT_NEAR(light->intensity_cd(direction_b(angles[v], angles[h])), candela[h * 5 + v], 1e-9);
    }
  }
}

TEST(IesTypeA, HasItsBeamOnTheLampAxisWithVerticalAlongYAndHorizontalAlongX) {
  const std::vector<double> vertical{-90, -30, 0, 30, 90};
  const std::vector<double> horizontal{-90, 0, 60, 90};
  std::vector<double> candela(20);
  for (std::size_t i = 0; i < 20; ++i) candela[i] = 50.0 + static_cast<double>(i);
  const Intensity light = make_intensity(grid_file(3, vertical, horizontal, candela));
  EXPECT_NEAR(light->intensity_cd(-Vec3::UnitZ()), 57, 1e-9);
  EXPECT_NEAR(light->intensity_cd(Vec3::UnitX()), 67, 1e-9);   // X = 90
  EXPECT_NEAR(light->intensity_cd(-Vec3::UnitX()), 52, 1e-9);  // X = -90
  EXPECT_EQ(light->intensity_cd(Vec3::UnitZ()), 0);
  for (std::size_t h = 0; h < 4; ++h) {
    for (std::size_t v = 1; v < 4; ++v) {
      EXPECT_NEAR(light->intensity_cd(direction_a(vertical[v], horizontal[h])), candela[h * 5 + v], 1e-9);
    }
  }
}

TEST(IesTypesAAndB, HaveTheFluxOfTheirInterpolant) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const int type : {2, 3}) {
    std::vector<double> candela(25);
    for (double& value : candela) value = std::round(1000 * unit(random));
    const std::vector<double> angles{-90, -50, 0, 20, 90};
    const Intensity light = make_intensity(grid_file(type, angles, angles, candela));
    // Midpoint rule in the type's own angles: solid angle is cos(latitude) times the product of its angle steps.
    constexpr int kSteps = 900;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      for (int j = 0; j < kSteps; ++j) {
        const double latitude = -90 + 180 * (i + 0.5) / kSteps;
        const double longitude = -90 + 180 * (j + 0.5) / kSteps;
        const Vec3 d = type == 2 ? direction_b(longitude, latitude) : direction_a(latitude, longitude);
        sum += light->intensity_cd(d) * std::cos(rad_from_deg(latitude));
      }
    }
    EXPECT_NEAR(sum * (kPi / kSteps) * (kPi / kSteps) / light->flux_lm(), 1, 1e-5) << type;
    EXPECT_NEAR(light->emission_cone_rad(), kPi, 1e-9) << type;
  }
}

TEST(IesTypesAAndB, MirrorAnglesThatStartAtZero) {
  // Four values for (V, H) in {0, 90}². Each of the four quadrants sees them.
  for (const int type : {2, 3}) {
    const Intensity light = make_intensity(grid_file(type, {0, 45, 90}, {0, 45, 90}, {9, 8, 7, 6, 5, 4, 3, 2, 1}));
    for (const double v : {-45.0, 45.0}) {
      for (const double h : {-45.0, 45.0}) {
        EXPECT_NEAR(light->intensity_cd(type == 2 ? direction_b(v, h) : direction_a(v, h)), 5, 1e-9);
      }
    }
  }
}

TEST(IesTypesAAndB, AreRoundAboutTheirBeamWithOneHorizontalAngle) {
  const Intensity b = make_intensity(grid_file(2, {0, 30, 90}, {0}, {100, 40, 0}));
  EXPECT_NEAR(b->intensity_cd(direction_b(30, 0)), 40, 1e-9);
  EXPECT_NEAR(b->intensity_cd(direction_b(0, -30)), 40, 1e-9);
  const Intensity a = make_intensity(grid_file(3, {0, 30, 90}, {0}, {100, 40, 0}));
  EXPECT_NEAR(a->intensity_cd(-Vec3::UnitZ()), 100, 1e-9);
  EXPECT_NEAR(a->intensity_cd(direction_a(30, 0)), 40, 1e-9);
  EXPECT_NEAR(a->intensity_cd(direction_a(0, 30)), 40, 1e-9);
  EXPECT_NEAR(a->flux_lm(), b->flux_lm(), 1e-9);
}

TEST(IesTypesAAndB, AreDarkBeyondTheirStatedAnglesWithAWarning) {
  const IesFile file = grid_file(2, {-20, 0, 20}, {-10, 0, 10}, {1, 1, 1, 1, 5, 1, 1, 1, 1});
  EXPECT_EQ(file.warnings.size(), 2u);
  const Intensity light = make_intensity(file);
  EXPECT_EQ(light->intensity_cd(direction_b(21, 0)), 0);
  EXPECT_EQ(light->intensity_cd(direction_b(0, 11)), 0);
  EXPECT_GT(light->intensity_cd(direction_b(19, 9)), 0);
  const double corner = std::acos(std::cos(rad_from_deg(20)) * std::cos(rad_from_deg(10)));
  EXPECT_NEAR(light->emission_cone_rad(), 2 * corner, 1e-9);
}

TEST(IesTypesAAndB, SampleDirectionsByTheirIntensity) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const int type : {2, 3}) {
    const Intensity light = make_intensity(
        grid_file(type, {-90, -45, 0, 30, 90}, {0, 20, 90}, {0, 5, 90, 30, 2, 1, 0, 70, 3, 0, 0, 0, 9, 0, 0}));
    for (int i = 0; i < 20'000; ++i) {
      const DirectionSample drawn = light->sample(unit(random), unit(random));
      ASSERT_GT(drawn.density_per_sr, 0);
      ASSERT_NEAR(light->intensity_cd(drawn.direction) / drawn.density_per_sr / light->flux_lm(), 1, 1e-9);
    }
  }
}

TEST(IesTilt, IsLinearBetweenItsAnglesRelativeToTheUprightLamp) {
  const IesFile file = parsed(
      "IESNA:LM-63-2002\nTILT=INCLUDE\n3\n3\n0 45 90\n0.8 0.6 0.4\n1 -1 1 2 1 1 2 0 0 0\n1 1 5\n0 90\n0\n100 100\n");
  ASSERT_TRUE(file.tilt.has_value());
  EXPECT_EQ(file.tilt->geometry, 3);
  EXPECT_DOUBLE_EQ(file.candela.front(), 80);
  EXPECT_DOUBLE_EQ(file.tilt->over_upright(0), 1);
  EXPECT_NEAR(file.tilt->over_upright(rad_from_deg(22.5)), 0.7 / 0.8, 1e-12);
  EXPECT_NEAR(file.tilt->over_upright(rad_from_deg(90)), 0.5, 1e-12);
  EXPECT_NEAR(file.tilt->over_upright(rad_from_deg(135)), 0.75, 1e-12);  // mirrored at 90°
  EXPECT_NEAR(file.tilt->over_upright(rad_from_deg(180)), 1, 1e-12);
  for (const int geometry : {1, 2}) {
    const IesFile other = parsed("IESNA:LM-63-2002\nTILT=INCLUDE\n" + std::to_string(geometry) +
                                 "\n2\n0 180\n1 0.5\n1 -1 1 2 1 1 2 0 0 0\n1 1 5\n0 90\n0\n100 100\n");
    ASSERT_TRUE(other.tilt.has_value());
    EXPECT_EQ(other.tilt->geometry, geometry);
    EXPECT_NEAR(other.tilt->over_upright(rad_from_deg(135)), 0.625, 1e-12);
  }
}

TEST(IesTilt, IsReadOnlyFromAFileBesideIt) {
  const std::string text = "IESNA91\nTILT=my lamp.tlt\n1 -1 1 2 1 1 2 0 0 0\n1 1 5\n0 90\n0\n100 100\n";
  std::string asked;
  const auto file = parse_ies(text, "f", [&](std::string_view name) {
    asked = std::string(name);
    return std::optional<std::string>("1\n2\n0 90\n1 0.5\n");
  });
  ASSERT_TRUE(file.has_value()) << file.error().front().text();
  EXPECT_EQ(asked, "my lamp.tlt");
  EXPECT_DOUBLE_EQ(file->candela.front(), 100);
  EXPECT_NEAR(file->tilt->over_upright(rad_from_deg(45)), 0.75, 1e-12);

  const auto wrong = parse_ies(text, "f", [](std::string_view) { return std::optional<std::string>("1\n2\n0 x\n"); });
  ASSERT_FALSE(wrong.has_value());
  EXPECT_NE(wrong.error().front().what.find("line 3"), std::string::npos) << wrong.error().front().text();

  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "luxrig_tilt";
  std::filesystem::create_directories(folder / "in");
  std::ofstream(folder / "out.tlt") << "1\n2\n0 90\n1 0.5\n";
  std::ofstream(folder / "in/here.tlt") << "1\n2\n0 90\n1 0.5\n";
  const auto with = [&](const std::string& name) {
    std::ofstream(folder / "in/lamp.ies")
        << "IESNA91\nTILT=" << name << "\n1 -1 1 2 1 1 2 0 0 0\n1 1 5\n0 90\n0\n100 100\n";
    return load_ies(folder / "in/lamp.ies").has_value();
  };
  EXPECT_TRUE(with("here.tlt"));
  EXPECT_FALSE(with("../out.tlt"));
  EXPECT_FALSE(with("missing.tlt"));
  std::filesystem::remove_all(folder);
}

struct Opening {
  double length, width, height;
  LuminousShape::Kind kind;
  Vec3 size;
  bool simplified;
};

TEST(IesOpening, HasTheShapeGivenByTheSignsOfItsSizes) {
  using Kind = LuminousShape::Kind;
  const Opening openings[] = {
      {0, 0, 0, Kind::point, {0, 0, 0}, false},
      {1.2, 0.3, 0, Kind::rectangle, {1.2, 0.3, 0}, false},
      {1.2, 0.3, 0.1, Kind::rectangle, {1.2, 0.3, 0}, true},
      {-0.2, -0.2, 0, Kind::disk, {0.2, 0, 0}, false},
      {0, -0.2, 0, Kind::disk, {0.2, 0, 0}, false},  // 1986…1995
      {-0.2, -0.2, 0.5, Kind::cylinder, {0.2, 0, 0.5}, false},
      {0, -0.2, 0.5, Kind::cylinder, {0.2, 0, 0.5}, false},
      {-0.2, -0.2, -0.2, Kind::sphere, {0.2, 0, 0}, false},
      {0, -0.2, -0.2, Kind::sphere, {0.2, 0, 0}, false},
      {-0.4, -0.1, 0, Kind::disk, {0.2, 0, 0}, true},
      {-0.4, -0.1, 0.3, Kind::cylinder, {0.2, 0, 0.3}, true},
      {0.4, -0.1, 0, Kind::disk, {0.2, 0, 0}, true},
      {1.5, -0.04, -0.04, Kind::rectangle, {1.5, 0.04, 0}, true},
      {1.5, 0, -0.04, Kind::rectangle, {1.5, 0.04, 0}, true},
      {-0.04, 1.5, -0.04, Kind::rectangle, {0.04, 1.5, 0}, true},
      {0, 1.5, -0.04, Kind::rectangle, {0.04, 1.5, 0}, true},
      {0, 0.5, 0.5, Kind::point, {0, 0, 0}, true},
      {-0.5, 0, -0.5, Kind::point, {0, 0, 0}, true},
  };
  for (const Opening& expected : openings) {
    IesFile file;
    file.length_m = expected.length;
    file.width_m = expected.width;
    file.height_m = expected.height;
    const LuminousOpening opening = luminous_opening(file);
    const auto text = testing::PrintToString(std::vector<double>{expected.length, expected.width, expected.height});
    EXPECT_EQ(static_cast<int>(opening.shape.kind), static_cast<int>(expected.kind)) << text;
    EXPECT_NEAR((opening.shape.size_m - expected.size).norm(), 0, 1e-12) << text;
    EXPECT_EQ(!opening.note.empty(), expected.simplified) << text << opening.note;
  }
}

}  // namespace
}  // namespace luxrig
