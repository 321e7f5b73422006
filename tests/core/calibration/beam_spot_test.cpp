#include "core/calibration/beam_spot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/core/calibration/beam_room.h"

namespace luxrig {
namespace {

const Vec3 kLamp_m(4, 3, 3.2);
const Vec3 kOnFloor_m(5, 4, 0), kOnWall_m(8, 4.5, 1.2);

double off_rad(const SpotCentre& centre, const Vec3& beam) {
  const Vec3 seen = centre.position_world_m - kLamp_m;
  return std::atan2(seen.cross(beam).norm(), seen.dot(beam));
}

void add_noise(Picture& picture, double cd_m2, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<float> normal(0, static_cast<float>(cd_m2));
  for (Vec3f& pixel : picture.luminance_cd_m2) pixel.array() += normal(random);
}

TEST(SeenSurface, IsTheRoomPixelByPixel) {
  const BeamRoom room;
  double floor_m2 = 0;
  for (const SurfacePixel& pixel : room.surface.pixels) {
    ASSERT_TRUE(pixel.seen() || pixel.area_m2 == 0);
    if (!pixel.seen()) continue;
    EXPECT_TRUE(BeamRoom::walls().materials.size() > pixel.material);
    if (pixel.normal.z() > 0.99F) floor_m2 += static_cast<double>(pixel.area_m2);
  }
  // The whole floor but for what lies below and beside the picture.
  EXPECT_LT(floor_m2, 56.01);
  EXPECT_GT(floor_m2, 30);
  EXPECT_LE(room.surface.plane_pixels.size(), 6U + std::count_if(room.surface.pixels.begin(), room.surface.pixels.end(),
                                                                 [](const SurfacePixel& p) { return !p.seen(); }));
}

/// Slant, distance and picture do not pull the middle.
TEST(BeamSpot, LiesOnTheAxis) {
  const BeamRoom room;
  for (const Vec3& at_m : {kOnFloor_m, Vec3(6.5, 2.5, 0), kOnWall_m}) {
    const Vec3 beam = (at_m - kLamp_m).normalized();
    const auto spot = beam_spot(room.surface, room.lit(kLamp_m, beam), room.dark(), kLamp_m);
    ASSERT_TRUE(spot) << words_of(spot.error());
    EXPECT_LT(off_rad(centre_of(*spot, kLamp_m), beam), rad_from_deg(0.01));
    EXPECT_TRUE(vanished(*spot, room.dark(), room.dark()));
  }
}

TEST(BeamSpot, IsStillThereIfItIsFoundFromALampADecimetreOff) {
  const BeamRoom room;
  const Vec3 beam = (kOnFloor_m - kLamp_m).normalized();
  const auto spot = beam_spot(room.surface, room.lit(kLamp_m, beam), room.dark(), kLamp_m + Vec3(0.08, -0.05, 0.06));
  ASSERT_TRUE(spot);
  EXPECT_LT(off_rad(centre_of(*spot, kLamp_m), beam), rad_from_deg(0.01));
}

TEST(BeamSpot, ItsErrorIsNotLessThanWhatNoiseDoes) {
  const BeamRoom room;
  const Vec3 beam = (kOnFloor_m - kLamp_m).normalized();
  double squares = 0, stated = 0;
  constexpr int kPictures = 24;
  for (std::uint64_t k = 0; k < kPictures; ++k) {
    Picture lit = room.lit(kLamp_m, beam), dark = room.dark();
    add_noise(lit, 12, 2 * k);
    add_noise(dark, 12, 2 * k + 1);
    const auto spot = beam_spot(room.surface, lit, dark, kLamp_m);
    ASSERT_TRUE(spot) << words_of(spot.error());
    const SpotCentre centre = centre_of(*spot, kLamp_m);
    squares += std::pow(off_rad(centre, beam), 2) / kPictures;
    stated += 2 * std::pow(centre.standard_error_rad, 2) / kPictures;
  }
  EXPECT_GT(stated, 0.7 * squares);
  EXPECT_LT(stated, 8 * squares) << "uneven paint, which is not in this room, is in the stated error";
}

TEST(BeamSpot, RefusesWhatIsNoBeam) {
  const BeamRoom room;
  const auto why = [&](const Picture& lit) { return beam_spot(room.surface, lit, room.dark(), kLamp_m); };
  const Vec3 beam = (kOnFloor_m - kLamp_m).normalized();
  EXPECT_EQ(why(room.dark()).error(), NoBeam::dark);
  EXPECT_EQ(why(room.lit(kLamp_m, (Vec3(0.2, 1.5, 0) - kLamp_m).normalized())).error(), NoBeam::cut)
      << "it falls below the picture's edge";
  Picture two = room.lit(kLamp_m, beam);
  room.add_beam(two, kLamp_m, (Vec3(7.5, 1.5, 0.2) - kLamp_m).normalized());
  EXPECT_EQ(why(two).error(), NoBeam::several);
  Picture clipped = room.lit(kLamp_m, beam);
  float most = 0;
  for (const Vec3f& pixel : clipped.luminance_cd_m2) most = std::max(most, pixel.maxCoeff());
  for (Vec3f& pixel : clipped.luminance_cd_m2) pixel = pixel.cwiseMin(0.7F * most);
  EXPECT_EQ(why(clipped).error(), NoBeam::clipped);
  Picture speck = room.dark();
  speck.luminance_cd_m2[static_cast<std::size_t>(120 * speck.width_px + 160)].setConstant(5000);
  EXPECT_EQ(why(speck).error(), NoBeam::small);
}

TEST(BeamSpot, AFaintReflectionBesideItIsNotTaken) {
  const BeamRoom room;
  const Vec3 beam = (kOnFloor_m - kLamp_m).normalized();
  Picture lit = room.lit(kLamp_m, beam);
  room.add_beam(lit, kLamp_m, (Vec3(7.8, 2, 0.5) - kLamp_m).normalized(), 3e3);
  const auto spot = beam_spot(room.surface, lit, room.dark(), kLamp_m);
  ASSERT_TRUE(spot) << words_of(spot.error());
  EXPECT_LT(off_rad(centre_of(*spot, kLamp_m), beam), rad_from_deg(0.05));
}

TEST(BeamSpot, DoesNotVanishIfItIsSomebodyElses) {
  const BeamRoom room;
  const Picture lit = room.lit(kLamp_m, (kOnFloor_m - kLamp_m).normalized());
  const auto spot = beam_spot(room.surface, lit, room.dark(), kLamp_m);
  ASSERT_TRUE(spot);
  EXPECT_FALSE(vanished(*spot, room.dark(), lit));
}

TEST(BeamSpot, StandsAnyPicture) {
  const BeamRoom room;
  std::mt19937_64 random(3);
  for (int k = 0; k < 12; ++k) {
    Picture lit = room.dark(), dark = room.dark();
    for (Vec3f& pixel : lit.luminance_cd_m2) {
      const auto what = random() % 4000;
      if (what == 0) pixel.setConstant(std::numeric_limits<float>::quiet_NaN());
      if (what == 1) pixel.setConstant(std::numeric_limits<float>::infinity());
      if (what == 2) pixel.setConstant(-1e6F);
      if (what < 40 && k % 2) pixel.setConstant(1e4F);
    }
    const Vec3 lamp_m = k % 3 == 0 ? room.surface.position_world_m(room.surface.at(100, 100)) : kLamp_m;
    if (const auto spot = beam_spot(room.surface, lit, dark, lamp_m)) {
      EXPECT_TRUE(centre_of(*spot, lamp_m).position_world_m.allFinite());
    }
  }
}

}  // namespace
}  // namespace luxrig
