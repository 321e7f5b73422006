#include "core/highlight/seen/seen_contrast.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/highlight/seen/seen_fixture.h"
#include "tests/random.h"

namespace luxrig {
namespace {

using namespace seen_fixture;

const Vec3 kEyeAbove{0, 0, 3};

SeenContrast contrast_of_scene(const RayScene& object, const Vec3& eye_m) {
  return SeenContrast({view_on(object, object, eye_m)}, {});
}

Scene flat_square() {
  return parametric(8, 8, [](double u, double v) { return Vec3(u - 0.5, v - 0.5, 0); });
}

// A plane has no form, so nothing of it is read: neither the gradient of a near lamp nor the edge of a beam.
TEST(SeenContrast, FlatPlaneHasNoneInAnyLight) {
  const RayScene plane(flat_square());
  const SeenContrast seen = contrast_of_scene(plane, kEyeAbove);
  std::vector<float> even, gradient, beam;
  for (const OrientedPoint& at : seen.samples()) {
    even.push_back(200);
    gradient.push_back(static_cast<float>(200 + 300 * at.position_world_m.x()));
    beam.push_back(at.position_world_m.x() > 0.1 ? 500.0f : 20.0f);
  }
  for (const auto& lux : {even, gradient, beam}) {
    const SeenScore score = seen.score(lux);
    EXPECT_EQ(score.fine, 0);
    EXPECT_EQ(score.form, 0);
  }
  const SeenScore score = seen.score(even);
  EXPECT_EQ(score.lit_share, 1);
  EXPECT_EQ(score.burnt_share + score.crushed_share, 0);
  EXPECT_NEAR(score.mean_lx, 200, 1e-3);
  // Beside black, an evenly lit edge has a response of 1/2: 0.5 / (0.5 + 0.1).
  EXPECT_NEAR(score.edge, 0.5 / 0.6, 1e-5);
}

// Lit by a distant lamp at phase angle α, seen from afar: the share of the disc that it lights is (1 + cos α) / 2, and
// the mean illuminance over the disc is (2 / 3π) (sin α + (π - α) cos α) (the phase function of a matt sphere).
TEST(SeenContrast, SphereUnderOneDistantLightAsInClosedForm) {
  const RayScene sphere(uv_sphere(0.5, 128));
  const SeenContrast seen = contrast_of_scene(sphere, {0, -200, 0});
  for (const double alpha_deg : {0.0, 30.0, 60.0, 90.0, 120.0}) {
    const double alpha = rad_from_deg(alpha_deg);
    const SeenScore score = seen.score(distant_lux(sphere, seen.samples(), {std::sin(alpha), -std::cos(alpha), 0}));
    const double mean = 2 / (3 * kPi) * (std::sin(alpha) + (kPi - alpha) * std::cos(alpha));
    EXPECT_NEAR(score.mean_lx, mean, 0.015 * mean + 0.002) << alpha_deg;
    if (kBurntOverMean * mean > 1) {
      EXPECT_EQ(score.burnt_share, 0) << alpha_deg;
    }
    // The part that no light reaches is crushed, and a rim where it grazes.
    const double dark = (1 - std::cos(alpha)) / 2;
    EXPECT_GE(score.crushed_share, dark - 0.01) << alpha_deg;
    EXPECT_LE(score.crushed_share, dark + 0.05) << alpha_deg;
    EXPECT_LE(score.lit_share, 1 - dark + 0.01) << alpha_deg;
    EXPECT_GE(score.lit_share, 0.85 * (1 - dark)) << alpha_deg;
  }
}

// cos θ > c over the disc seen from the light's own side: 1 - c². The mean there is 2/3.
TEST(SeenContrast, LitShareOfASphereFromTheFrontAsInClosedForm) {
  const RayScene sphere(uv_sphere(0.5, 128));
  const SeenContrast seen = contrast_of_scene(sphere, {0, -200, 0});
  const SeenScore score = seen.score(distant_lux(sphere, seen.samples(), -Vec3::UnitY()));
  const double low = kCrushedOverMean * 2 / 3, high = kLitOverMean * 2 / 3;
  EXPECT_NEAR(score.crushed_share, low * low, 0.005);
  // Below `high` the ramp (c - low) / (high - low) is lost from 1, over 2c dc.
  const double lost =
      high * high - (2.0 / 3 * (std::pow(high, 3) - std::pow(low, 3)) - low * (high * high - low * low)) / (high - low);
  EXPECT_NEAR(score.lit_share, 1 - lost, 0.005);
}

// Two lights on a square of 1 m; the shadow of each is 0.1 by 0.4 m, and they share a long side. Edges of one: 1 m, of
// which 0.4 m divide one light from the other (contrast 1/2) and 0.6 m one from both (1/3).
TEST(SeenContrast, SecondShadowsAreAsLongAsTheirEdges) {
  const RayScene plane(flat_square());
  const SeenContrast seen = contrast_of_scene(plane, kEyeAbove);
  std::vector<std::vector<float>> lights(2);
  std::vector<float> lux;
  for (const OrientedPoint& at : seen.samples()) {
    const double x = at.position_world_m.x();
    const bool beside = std::abs(at.position_world_m.y()) < 0.2;
    lights[0].push_back(beside && x > 0 && x < 0.1 ? 0.0f : 1.0f);
    lights[1].push_back(beside && x < 0 && x > -0.1 ? 0.0f : 1.0f);
    lux.push_back(lights[0].back() + lights[1].back());
  }
  const double third = 1.0 / 3, expected = 0.4 * 0.5 / 0.6 + 0.6 * third / (third + 0.1);
  EXPECT_NEAR(seen.second_shadows(lux, lights), expected, 0.05 * expected);
  EXPECT_EQ(seen.second_shadows(lights[0], {lights.data(), 1}), 0) << "one light draws one set of shadows";
  // A light that is hardly seen beside the other draws shadows that are hardly seen.
  std::vector<float> unlike = lights[0];
  for (float& lx : lights[1]) lx *= 0.01f;
  for (std::size_t i = 0; i < unlike.size(); ++i) unlike[i] += lights[1][i];
  EXPECT_LT(seen.second_shadows(unlike, lights), 0.15 * expected);
}

TEST(SeenContrast, ASurfaceThatTurnsAwayDrawsNoSecondShadow) {
  const RayScene sphere(uv_sphere(0.5, 128));
  const SeenContrast seen = contrast_of_scene(sphere, {0, -200, 0});
  std::vector<std::vector<float>> lights;
  for (const double side : {-1.0, 1.0})
    lights.push_back(distant_lux(sphere, seen.samples(), Vec3(side, -0.2, 0).normalized()));
  std::vector<float> lux = lights[0];
  for (std::size_t i = 0; i < lux.size(); ++i) lux[i] += lights[1][i];
  EXPECT_LT(seen.second_shadows(lux, lights), 0.02);
}

// Half of a plane at 1, half at 3: the mean is 2, so (2/3 + 6/5) / 2.
TEST(SeenContrast, EvennessIsAsInClosedForm) {
  const RayScene plane(flat_square());
  const SeenContrast seen = contrast_of_scene(plane, kEyeAbove);
  std::vector<float> lux;
  for (const OrientedPoint& at : seen.samples()) lux.push_back(at.position_world_m.x() > 0 ? 1.0f : 3.0f);
  EXPECT_NEAR(seen.score(lux).even, (2.0 / 3 + 6.0 / 5) / 2, 0.003);
  for (float& lx : lux) lx = 7;
  EXPECT_NEAR(seen.score(lux).even, 1, 1e-5);
  for (float& lx : lux) lx = 0;
  EXPECT_EQ(seen.score(lux).even, 0);
}

TEST(SeenContrast, ScalingAllLightsChangesNothing) {
  const RayScene object(ridges(6, 0.02));
  const SeenContrast seen = contrast_of_scene(object, kEyeAbove);
  const std::vector<float> lux = distant_lux(object, seen.samples(), at_height(30));
  const SeenScore one = seen.score(lux);
  for (const float factor : {1e-3f, 0.25f, 3e4f}) {
    std::vector<float> scaled = lux;
    for (float& lx : scaled) lx *= factor;
    const SeenScore score = seen.score(scaled);
    EXPECT_NEAR(score.objective, one.objective, 1e-4) << factor;
    EXPECT_NEAR(score.fine, one.fine, 1e-5) << factor;
    EXPECT_NEAR(score.mean_lx, factor * one.mean_lx, 1e-4 * factor * one.mean_lx) << factor;
  }
}

// An eye that does not adapt any further sees less and less.
TEST(SeenContrast, BelowTheDarkestAdaptationLessIsSeen) {
  const RayScene object(ridges(6, 0.02));
  const SeenContrast seen = contrast_of_scene(object, kEyeAbove);
  double last = 2;
  for (const float factor : {1.0f, 0.1f, 0.01f, 0.0f}) {
    std::vector<float> lux = distant_lux(object, seen.samples(), at_height(30));
    for (float& lx : lux) lx *= factor;
    const SeenScore score = seen.score(lux, 1);
    EXPECT_LT(score.fine + score.form, last) << factor;
    last = score.fine + score.form;
  }
  EXPECT_EQ(last, 0);
}

// 4 % at fifty times the rest: the mean is 0.96 + 2 = 2.96, white is at 16.4, black at 0.185.
TEST(SeenContrast, BurntAndCrushedPartsAreCounted) {
  const RayScene plane(flat_square());
  const SeenContrast seen = contrast_of_scene(plane, kEyeAbove);
  const auto painted = [&](float low, float high) {
    std::vector<float> lux;
    for (const OrientedPoint& at : seen.samples())
      lux.push_back(std::abs(at.position_world_m.x()) < 0.1 && std::abs(at.position_world_m.y()) < 0.1 ? high : low);
    return seen.score(lux);
  };
  const SeenScore burnt = painted(1, 50);
  EXPECT_NEAR(burnt.burnt_share, 0.04, 0.003);
  EXPECT_EQ(burnt.crushed_share, 0);
  const SeenScore crushed = painted(1, 0.05f);
  EXPECT_EQ(crushed.burnt_share, 0);
  EXPECT_NEAR(crushed.crushed_share, 0.04, 0.003);
  EXPECT_NEAR(crushed.lit_share, 0.96, 0.003);
  // A black shadow is black only if the room is.
  const SeenScore filled = painted(1, 0.3f);
  EXPECT_EQ(filled.crushed_share, 0);
  EXPECT_EQ(filled.lit_share, 1);
  EXPECT_GT(filled.objective, crushed.objective);
  EXPECT_GT(painted(1, 1).objective, burnt.objective);
}

TEST(SeenContrast, RidgeUnderRakingLightBeatsFrontalLightAndLightAlongIt) {
  for (const int count : {3, 8}) {
    const RayScene object(ridges(count, 0.06 / count));
    const SeenContrast seen = contrast_of_scene(object, kEyeAbove);
    const auto relief = [&](const Vec3& towards) {
      const SeenScore score = seen.score(distant_lux(object, seen.samples(), towards));
      return score.fine + score.form;
    };
    const double raking = relief(at_height(25)), frontal = relief(Vec3::UnitZ()),
                 along = relief({0, std::cos(rad_from_deg(25)), std::sin(rad_from_deg(25))});
    EXPECT_GT(raking, 3 * frontal) << count;
    EXPECT_GT(raking, 3 * along) << count;
  }
}

// The outline of a white ball is lost before a wall of the same luminance, and found before a black one.
TEST(SeenContrast, OutlineIsReadAgainstWhatIsBehind) {
  const Scene ball = uv_sphere(0.5, 64);
  const Scene wall = parametric(1, 1, [](double u, double v) { return Vec3(8 * (u - 0.5), 1, 8 * (v - 0.5)); });
  const RayScene room(joined(ball, wall)), object(ball);
  const SeenContrast seen({view_on(room, object, {0, -3, 0})}, {});
  std::vector<float> same, black;
  for (const OrientedPoint& at : seen.samples()) {
    const bool on_wall = at.position_world_m.y() > 0.9;
    same.push_back(100);
    black.push_back(on_wall ? 0.0f : 100.0f);
  }
  EXPECT_NEAR(seen.score(same).edge, 0, 1e-6);
  EXPECT_NEAR(seen.score(black).edge, 0.5 / 0.6, 1e-5);
}

TEST(SeenContrast, TermsStayWithinTheirRangeInAnyLight) {
  const RayScene object(torus(0.5, 0.2, 60, 30));
  std::vector<SeenView> views;
  for (const Vec3& eye_m : eyes_around(object, {1, -2, 1})) views.push_back(view_on(object, object, eye_m, 32));
  const SeenContrast seen(std::move(views), {});
  Random random(7);
  for (int round = 0; round < 200; ++round) {
    std::vector<float> lux;
    const double most = std::pow(10, random.between(-6, 6)), lit = random.between(0, 1);
    for (std::size_t i = 0; i < seen.samples().size(); ++i)
      lux.push_back(random.between(0, 1) < lit ? static_cast<float>(random.between(0, most)) : 0.0f);
    const SeenScore score = seen.score(lux);
    for (const double term : {score.fine, score.form, score.lit_share, score.edge, score.burnt_share,
                              score.crushed_share, score.burnt_share + score.crushed_share, score.even}) {
      EXPECT_GE(term, 0);
      EXPECT_LE(term, 1 + 1e-6);
    }
    EXPECT_TRUE(std::isfinite(score.objective));
  }
  const SeenScore dark = seen.score(std::vector<float>(seen.samples().size(), 0.0f));
  EXPECT_EQ(dark.crushed_share, 1);
  EXPECT_EQ(dark.fine + dark.form + dark.lit_share + dark.edge, 0);
}

}  // namespace
}  // namespace luxrig
