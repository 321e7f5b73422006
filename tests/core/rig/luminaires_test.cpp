// What [[luminaire]] becomes: distribution, shape and colour.
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

TEST(Luminaires, OfARectangleOrDiskAreLambertianAndFaceDown) {
  using Kind = LuminousShape::Kind;
  const Luminaire panel = luminaire_of("model = \"rectangle\"\nlength_m = 1.2\nwidth_m = 0.3\nlumens = 3600\n");
  EXPECT_EQ(panel.shape, (LuminousShape{Kind::rectangle, Vec3(1.2, 0.3, 0)}));
  EXPECT_NEAR(panel.intensity->intensity_cd(at(60)), 3600 / kPi * 0.5, 1e-9);
  EXPECT_EQ(panel.intensity->intensity_cd(at(100)), 0);
  const Luminaire downlight = luminaire_of("model = \"disk\"\ndiameter_m = 0.2\nlumens = 900\n");
  EXPECT_EQ(downlight.shape, (LuminousShape{Kind::disk, Vec3(0.2, 0, 0)}));
  EXPECT_NEAR(downlight.intensity->max_intensity_cd(), 900 / kPi, 1e-9);
}

TEST(Luminaires, OfASphereOrCylinderHaveOneLuminanceAllOver) {
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

TEST(Luminaires, TakeTheFileOfEitherFormat) {
  const Luminaire ldt = luminaire_of("model = \"ies\"\nfile = \"sample9.ldt\"\n");
  EXPECT_NEAR(ldt.lumens, 10002.8, 0.1);
  const Luminaire ies = luminaire_of("model = \"ies\"\nfile = \"type_b_full.ies\"\nlumens = 1000\n");
  EXPECT_NEAR(ies.intensity->flux_lm(), 1000, 1e-9);
  EXPECT_TRUE(luminaire_of("model = \"ies\"\nfile = \"tilt_include_geometry2.ies\"\n").tilt.has_value());
}

TEST(Luminaires, ShineFromTheFilesOpeningOnlyWhenAskedTo) {
  EXPECT_EQ(luminaire_of("model = \"ies\"\nfile = \"sample9.ldt\"\n").shape, LuminousShape{});
  const Luminaire near = luminaire_of("model = \"ies\"\nfile = \"sample9.ldt\"\nnear_field = true\n");
  EXPECT_EQ(near.shape, (LuminousShape{LuminousShape::Kind::rectangle, Vec3(0.065, 1.75, 0)}));
  const auto notes = [](const std::string& file) {
    const Checked<Rig> rig = parse_rig("[rig]\nname = \"r\"\n[[luminaire]]\nname = \"l\"\nmodel = \"ies\"\nfile = \"" +
                                           file + "\"\nnear_field = true\n",
                                       "rig.toml", kData);
    return rig && !rig->notes.empty() ? rig->notes.back().what : std::string();
  };
  EXPECT_NE(notes("sample9.ldt").find("a box"), std::string::npos);  // said, since simplified
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

}  // namespace
}  // namespace luxrig
