#include "core/rig/zoom.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/rig/housing.h"
#include "core/rig/rig_file.h"

namespace luxrig {
namespace {

constexpr const char* kRig = R"(
[rig]
name = "zoom"
[[luminaire]]
name = "spot"
model = "spot"
beam_angle_deg = 20
field_angle_deg = 36
zoom_deg = [6, 60]
emitters = [{ name = "warm", lumens = 600 }, { name = "cold", lumens = 300 }]
[[bus]]
name = "dmx"
driver = "sacn"
[[fixture]]
name = "head"
luminaire = "spot"
position_m = [0, 0, 3]
bus = "dmx"
address = 1
slots = ["pan", "tilt", "zoom", "emitter:warm", "emitter:cold"]
[[fixture]]
name = "by hand"
luminaire = "spot/warm"
position_m = [1, 0, 3]
bus = "dmx"
address = 10
)";

Vec3 aside(double gamma_deg) { return {std::sin(rad_from_deg(gamma_deg)), 0, -std::cos(rad_from_deg(gamma_deg))}; }

TEST(Zoom, KeepsTheFluxAndTheRatioOfFieldToBeam) {
  const Checked<Rig> rig = parse_rig(kRig, "rig.toml", ".");
  ASSERT_TRUE(rig) << rig.error().front().text();
  const Luminaire& spot = rig->luminaires[0];
  for (const double beam_deg : {6.0, 13.0, 20.0, 60.0}) {
    const Intensity zoomed = intensity_at_beam(spot, rad_from_deg(beam_deg));
    EXPECT_NEAR(zoomed->flux_lm(), 900, 1e-9) << beam_deg;
    const double peak_cd = zoomed->intensity_cd(aside(0));
    EXPECT_NEAR(zoomed->intensity_cd(aside(beam_deg / 2)) / peak_cd, 0.5, 1e-9) << beam_deg;
    EXPECT_NEAR(zoomed->intensity_cd(aside(beam_deg * 0.9)) / peak_cd, 0.1, 1e-9) << beam_deg;
  }
  EXPECT_EQ(intensity_at_beam(spot, 0), spot.intensity);
  EXPECT_EQ(intensity_at_beam(spot, spot.beam_angle_rad), spot.intensity);
}

TEST(Zoom, IsLimitedToFixturesWithASlotForIt) {
  const Checked<Rig> rig = parse_rig(kRig, "rig.toml", ".");
  ASSERT_TRUE(rig) << rig.error().front().text();
  ASSERT_EQ(rig->fixtures.size(), 3u);
  for (const std::size_t emitter : {0u, 1u}) {
    const Fixture& head = rig->fixtures[emitter];
    EXPECT_TRUE(head.range.zooms());
    EXPECT_NEAR(deg_from_rad(head.range.beam_min_rad), 6, 1e-9);
    EXPECT_NEAR(deg_from_rad(head.range.beam_max_rad), 60, 1e-9);
    EXPECT_NEAR(deg_from_rad(head.joints.beam_rad), 20, 1e-9);
    EXPECT_NEAR(deg_from_rad(head.zoom_speed_rad_s), 30, 1e-9);
  }
  EXPECT_FALSE(rig->fixtures[2].range.zooms());
  EXPECT_EQ(rig->fixtures[2].joints.beam_rad, 0);
}

TEST(Housing, HasTheNameOfTheRigFile) {
  const Checked<Rig> rig = parse_rig(kRig, "rig.toml", ".");
  ASSERT_TRUE(rig) << rig.error().front().text();
  EXPECT_EQ(housing_name(*rig, 0), "head");
  EXPECT_EQ(housing_name(*rig, 1), "head");
  EXPECT_EQ(housing_of(*rig, 1), (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(housing_luminaire(*rig, 1).name, "spot");
  // A single emitter is a luminaire like any other.
  EXPECT_EQ(housing_of(*rig, 2), std::vector<std::size_t>{2});
}

}  // namespace
}  // namespace luxrig
