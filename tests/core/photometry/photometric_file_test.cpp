// All real files of this repository: each loads with the flux its catalogue states, or is refused with a reason.
#include "core/photometry/files/photometric_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "tests/core/photometry/load_files.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

std::filesystem::path folder() { return test::source_folder() / "tests/data/photometry"; }

/// Flux [lm] by zones, or the reason for a refusal.
struct Expected {
  double flux_lm;
  const char* refused;
};
const std::map<std::string, Expected> kCatalogue = {
    {"007cfb11e343e2f42e3b476be4ab684e.ies", {321.2, ""}},
    {"02a7562c650498ebb301153dbbf59207.ies", {9600.1, ""}},
    {"06b4cfdc8805709e767b5e2e904be8ad.ies", {1224.6, ""}},
    {"B1 module.ies", {0, "radiometric"}},
    {"LLIA001477-002.ies", {0, "radiometric"}},
    {"LightProfile.ies", {8749.7, ""}},
    {"aerolamp.ies", {0, "radiometric"}},
    {"area_light.ies", {28338.1, ""}},
    {"comet.ies", {16073.7, ""}},
    {"cylinder_narrow.ies", {2976.5, ""}},
    {"defined.ies", {13148.3, ""}},
    {"defined_diffuse.ies", {1305.2, ""}},
    {"display.ies", {4055.8, ""}},
    {"jelly_fish.ies", {6484.4, ""}},
    {"overhead.ies", {37030.9, ""}},
    {"parallel_beam.ies", {3259.8, ""}},
    {"sample1.ldt", {1983.3, ""}},
    {"sample2.ldt", {4604.0, ""}},
    {"sample3.ldt", {12800.3, ""}},
    {"sample5.ldt", {611.9, ""}},
    {"sample6.ldt", {1799.1, ""}},
    {"sample9.ldt", {10002.8, ""}},
    {"sample_01.ldt", {4836.0, ""}},
    {"sample_05.ldt", {11446.8, ""}},
    {"soft_arrow.ies", {796.5, ""}},
    {"three_lobe_umbrella.ies", {1005.1, ""}},
    {"tilt_include_geometry2.ies", {13227.6, ""}},
    {"trapezoid.ies", {14428.9, ""}},
    {"type_b_full.ies", {60462.4, ""}},  // no figure in the catalogue: checked only against the integral
    {"x_arrow.ies", {524.6, ""}},
};

/// Independent of the tables: Gauss points in rings of half a degree, midpoints in azimuth.
double integrated_lm(const IntensityDistribution& of) {
  constexpr double kNode[] = {-0.5773502691896258, 0.5773502691896258};
  constexpr int kRings = 720, kSpokes = 288;
  double sum = 0;
  for (int i = 0; i < kRings; ++i) {
    for (const double node : kNode) {
      const double gamma = kPi * (i + 0.5 + 0.5 * node) / kRings;
      double ring = 0;
      for (int j = 0; j < kSpokes; ++j) {
        const double c = 2 * kPi * (j + 0.5) / kSpokes;
        ring += of.intensity_cd({std::sin(gamma) * std::cos(c), std::sin(gamma) * std::sin(c), -std::cos(gamma)});
      }
      sum += 0.5 * ring * std::sin(gamma);
    }
  }
  return sum * (kPi / kRings) * (2 * kPi / kSpokes);
}

TEST(PhotometricFiles, LoadWithTheirCatalogueFluxOrAreRefusedWithAReason) {
  std::set<std::string> seen;
  for (const auto& entry : std::filesystem::directory_iterator(folder())) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() == ".md") continue;
    ASSERT_EQ(kCatalogue.count(name), 1u) << name << " is not in the catalogue";
    seen.insert(name);
    const Expected& expected = kCatalogue.at(name);
    const Checked<PhotometricFile> file = load_photometric_file(entry.path());
    if (*expected.refused) {
      ASSERT_FALSE(file.has_value()) << name;
      EXPECT_NE(file.error().front().what.find(expected.refused), std::string::npos) << file.error().front().text();
      continue;
    }
    ASSERT_TRUE(file.has_value()) << file.error().front().text();
    EXPECT_NEAR(file->intensity->flux_lm(), expected.flux_lm, 0.06) << name;
    // Cells of type B cross the rings, and defined.ies has angles between the half degrees.
    const bool off_the_rings = name == "type_b_full.ies" || name == "defined.ies";
    EXPECT_NEAR(integrated_lm(*file->intensity) / file->intensity->flux_lm(), 1, off_the_rings ? 1e-4 : 1e-6) << name;
  }
  EXPECT_EQ(seen.size(), kCatalogue.size());
}

class NamedWrongly : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  Checked<PhotometricFile> loaded_as(const char* of, const char* name) const {
    std::filesystem::copy_file(folder() / of, folder_ / name, std::filesystem::copy_options::overwrite_existing);
    return load_photometric_file(folder_ / name);
  }
  const std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / "luxrig_named_wrongly";
};

TEST_F(NamedWrongly, FilesAreReadByTheirContentWithAWarning) {
  const auto ldt = loaded_as("sample9.ldt", "x.ies");
  ASSERT_TRUE(ldt.has_value()) << ldt.error().front().text();
  EXPECT_NEAR(ldt->intensity->flux_lm(), 10002.8, 0.06);
  EXPECT_EQ(ldt->warnings.back(), "named .ies, but its content is EULUMDAT: read as that");
  const auto ies = loaded_as("comet.ies", "x.LDT");
  ASSERT_TRUE(ies.has_value()) << ies.error().front().text();
  EXPECT_NEAR(ies->intensity->flux_lm(), 16073.7, 0.06);
  EXPECT_EQ(ies->warnings.back(), "named .ldt, but its content is IES LM-63: read as that");
}

TEST_F(NamedWrongly, CapitalsInAnExtensionAreAccepted) {
  for (const auto& [of, name] : {std::pair{"sample9.ldt", "x.LDT"}, {"comet.ies", "x.IES"}}) {
    const auto there = load_photometric_file(folder() / of), capitals = loaded_as(of, name);
    ASSERT_TRUE(there.has_value() && capitals.has_value());
    EXPECT_EQ(there->warnings, capitals->warnings);
    EXPECT_EQ(there->intensity->flux_lm(), capitals->intensity->flux_lm());
  }
}

TEST(PhotometricFiles, LoadInBothFormatsAndRefuseOthers) {
  const auto ldt = load_photometric_file(folder() / "sample9.ldt");
  ASSERT_TRUE(ldt.has_value());
  EXPECT_DOUBLE_EQ(ldt->input_w, 75);
  EXPECT_EQ(static_cast<int>(ldt->opening.shape.kind), static_cast<int>(LuminousShape::Kind::rectangle));
  const auto ies = load_photometric_file(folder() / "tilt_include_geometry2.ies");
  ASSERT_TRUE(ies.has_value());
  EXPECT_TRUE(ies->tilt.has_value());
  EXPECT_FALSE(load_photometric_file(folder() / "nothing.ldt").has_value());
  EXPECT_FALSE(load_photometric_file(folder() / "README.md").has_value());
}

}  // namespace
}  // namespace luxrig
