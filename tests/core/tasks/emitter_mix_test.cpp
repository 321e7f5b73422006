#include "core/tasks/emitter_mix.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/photometry/light_colour.h"
#include "tests/random.h"

namespace luxrig {
namespace {

Eigen::Vector2d uv_of(const Vec3& rgb) {
  const Chromaticity xy = xy_of_rgb(rgb);
  return Eigen::Vector2d(4 * xy.x(), 9 * xy.y()) / (-2 * xy.x() + 12 * xy.y() + 3);
}

Vec3 light_of(const std::vector<EmitterLight>& emitters, const std::vector<double>& levels) {
  Vec3 light = Vec3::Zero();
  for (std::size_t e = 0; e < emitters.size(); ++e) light += levels[e] * emitters[e].lumens * emitters[e].rgb;
  return light;
}

const std::vector<EmitterLight> kTunableWhite = {{600, rgb_of_cct(2700)}, {800, rgb_of_cct(6500)}};

TEST(EmitterMix, TunableWhiteIsTheNearestOnTheLineBetweenItsWhites) {
  const Vec3 wanted = rgb_of_cct(4000);
  const EmitterMix mix = mix_of_colour(kTunableWhite, wanted);
  double nearest = 1;
  for (double share = 0; share <= 1; share += 1e-4)
    nearest = std::min(nearest, (uv_of(light_of(kTunableWhite, {1 - share, share})) - uv_of(wanted)).norm());
  EXPECT_NEAR(mix.off_uv, nearest, 1e-3) << "least squares of the light, not of u'v'";
  EXPECT_LT(mix.off_uv, 0.01);
  EXPECT_EQ(std::max(mix.levels[0], mix.levels[1]), 1);
  EXPECT_GT(std::min(mix.levels[0], mix.levels[1]), 0.2);
  EXPECT_NEAR(mix.flux_share, (600 * mix.levels[0] + 800 * mix.levels[1]) / 1400, 1e-12);
}

TEST(EmitterMix, TheColourOfOneEmitterIsThatOne) {
  const EmitterMix mix = mix_of_colour(kTunableWhite, rgb_of_cct(2700));
  EXPECT_EQ(mix.levels[0], 1);
  EXPECT_NEAR(mix.levels[1], 0, 1e-9);
  EXPECT_NEAR(mix.flux_share, 600.0 / 1400, 1e-9);
  EXPECT_LT(mix.off_uv, 1e-6);
}

TEST(EmitterMix, WhiteComesFromTheWhiteEmitterAsItIsBrighter) {
  const auto primary = [](const Vec3& rgb) { return *with_luminance_1(rgb); };
  const std::vector<EmitterLight> rgbw = {
      {200, primary({1, 0, 0})}, {500, primary({0, 1, 0})}, {60, primary({0, 0, 1})}, {2000, Vec3::Ones()}};
  const EmitterMix mix = mix_of_colour(rgbw, Vec3::Ones());
  EXPECT_LT(mix.off_uv, 1e-6);
  EXPECT_EQ(mix.levels[3], 1);
  EXPECT_GE(mix.flux_share, 2000.0 / 2760 - 1e-9);
}

TEST(EmitterMix, AnyMixOfAnyEmittersIsReached) {
  Random random(7);
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<EmitterLight> emitters;
    std::vector<double> levels;
    for (int e = 0; e < 2 + trial % 5; ++e) {
      emitters.push_back({std::pow(10, random.between(0, 4)),
                          *with_luminance_1(Vec3(random.between(0, 1), random.between(0, 1), random.between(0, 1)))});
      levels.push_back(random.between(0, 1));
    }
    const Vec3 wanted = *with_luminance_1(light_of(emitters, levels));
    const EmitterMix mix = mix_of_colour(emitters, wanted);
    EXPECT_LT(mix.off_uv, 2e-3) << trial;
    EXPECT_NEAR(*std::max_element(mix.levels.begin(), mix.levels.end()), 1, 1e-12);
    for (const double level : mix.levels) EXPECT_GE(level, 0);
    EXPECT_GT(mix.flux_share, 0);
    EXPECT_LE(mix.flux_share, 1 + 1e-12);
  }
}

TEST(EmitterMix, DegenerateEmittersGiveNoNumberThatIsNone) {
  for (const auto& emitters : std::vector<std::vector<EmitterLight>>{
           {{0, Vec3::Ones()}, {0, Vec3::Ones()}},
           {{0, Vec3::Ones()}, {100, rgb_of_cct(2700)}},
           {{100, rgb_of_cct(2700)}, {100, rgb_of_cct(2700)}, {100, rgb_of_cct(2700)}},
           {{1e-300, rgb_of_cct(2700)}, {1e6, rgb_of_cct(6500)}}}) {
    const EmitterMix mix = mix_of_colour(emitters, rgb_of_cct(4000));
    ASSERT_EQ(mix.levels.size(), emitters.size());
    for (const double level : mix.levels) {
      EXPECT_TRUE(level >= 0 && level <= 1) << level;
    }
    EXPECT_TRUE(mix.flux_share > 0 && mix.flux_share <= 1 + 1e-12) << mix.flux_share;
    EXPECT_TRUE(std::isfinite(mix.off_uv));
  }
}

}  // namespace
}  // namespace luxrig
