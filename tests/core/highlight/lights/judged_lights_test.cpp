#include "core/highlight/lights/judged_lights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/highlight/lights/mounted_lights.h"
#include "core/highlight/shadow/relief_contrast.h"
#include "core/highlight/surface/relief_study.h"
#include "tests/core/highlight/lights/judged_lights_fixture.h"
#include "tests/core/highlight/shapes.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

using namespace judged_lights_fixture;

/// Samples in a row: each is an interest point compared with its two neighbours, five in a row are a feature. Random
/// lights each light a stretch of the row.
struct DrawnRow {
  ContrastSamples samples;
  FeatureClusters features;
  std::vector<JudgedLight> lights;

  DrawnRow(std::size_t points, std::size_t count, unsigned seed) {
    Random random(seed);
    samples.interest = points;
    for (std::uint32_t i = 0; i < points; ++i) {
      samples.points.push_back({Vec3::Zero(), Vec3::UnitZ()});
      if (i > 0) samples.neighbours.push_back(i - 1);
      if (i + 1 < points) samples.neighbours.push_back(i + 1);
      samples.begin.push_back(static_cast<std::uint32_t>(samples.neighbours.size()));
      features.cluster_of_point.push_back(i / 5);
      if (i % 5 == 0) features.sizes.push_back(0);
      ++features.sizes.back();
    }
    for (std::size_t l = 0; l < count; ++l) {
      JudgedLight light;
      light.position_world_m = 2 * random.direction();
      light.lux.assign(points, 0);
      const std::size_t from = random.below(points);
      for (std::size_t i = from; i < std::min(points, from + points / 3); ++i)
        if (random.below(3) > 0) light.lux[i] = static_cast<float>(random.between(0, 100));
      lights.push_back(std::move(light));
    }
  }
  [[nodiscard]] JudgedSelection selection(JudgedWishes wishes) const {
    return {samples, features, lights, Vec3::Zero(), std::move(wishes)};
  }

  /// Independent formula: contrast × (1 + weight × share of features with an edge).
  [[nodiscard]] double judged(const std::vector<std::uint32_t>& taken, const JudgedWishes& wishes) const {
    std::vector<double> lux(samples.points.size(), 0);
    std::vector<int> shown(features.sizes.size(), 0);
    for (const std::uint32_t l : taken)
      for (std::size_t i = 0; i < lux.size(); ++i) lux[i] += static_cast<double>(lights[l].lux[i]);
    double contrast = 0;
    for (std::size_t i = 0; i < lux.size(); ++i) {
      double largest = 0;
      for (const std::uint32_t n : samples.of(i)) {
        largest = std::max(largest, std::abs(lux[i] - lux[n]));
        for (const std::uint32_t l : taken) {
          const float a = lights[l].lux[i], b = lights[l].lux[n];
          if ((a > 0) != (b > 0) && static_cast<double>(std::max(a, b)) > wishes.seen_lx) shown[i / 5] = 1;
        }
      }
      contrast += largest / static_cast<double>(lux.size());
    }
    const auto seen = static_cast<double>(std::ranges::count(shown, 1)) / static_cast<double>(shown.size());
    return contrast * (1 + wishes.coverage_weight * seen);
  }
  [[nodiscard]] bool apart(std::uint32_t a, std::uint32_t b, double min_rad) const {
    const Vec3 x = lights[a].position_world_m.normalized(), y = lights[b].position_world_m.normalized();
    return std::atan2(x.cross(y).norm(), x.dot(y)) >= min_rad;
  }
};

std::uint32_t index_of(const DrawnRow& row, const JudgedLight& light) {
  for (std::uint32_t l = 0; l < row.lights.size(); ++l)
    if (row.lights[l].position_world_m == light.position_world_m) return l;
  return ~0u;
}

TEST(NumberAtPeak, IsTheFewestLightsCloseToThePeak) {
  EXPECT_EQ(number_at_peak({}), 0u);
  EXPECT_EQ(number_at_peak(std::vector<double>{0, 0, 0}), 0u);
  EXPECT_EQ(number_at_peak(std::vector<double>{0.28, 0.45, 0.44, 0.41, 0.457}), 1u);
  EXPECT_EQ(number_at_peak(std::vector<double>{0.28, 0.44, 0.44, 0.41, 0.457}), 4u);
  EXPECT_EQ(number_at_peak(std::vector<double>{0.6, 0.5, 0.4}), 0u);
}

TEST(JudgedSelection, FindsTheBestSingleLightAndALocallyOptimalPair) {
  double found = 0, best_of_all = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const DrawnRow row(60, 30, seed);
    JudgedWishes wishes;
    wishes.coverage_weight = seed % 2 == 0 ? 0.1 : 0.5;
    wishes.seen_lx = 10;
    JudgedSelection selection = row.selection(wishes);
    double best = 0;
    for (std::uint32_t l = 0; l < 30; ++l) best = std::max(best, row.judged({l}, wishes));
    ASSERT_TRUE(selection.add());
    EXPECT_NEAR(selection.score().judged / best, 1, 1e-5);

    ASSERT_TRUE(selection.add());
    selection.settle();
    const std::uint32_t a = index_of(row, selection.taken()[0]), b = index_of(row, selection.taken()[1]);
    const double pair = row.judged({a, b}, wishes);
    EXPECT_TRUE(row.apart(a, b, wishes.min_angle_rad));
    EXPECT_NEAR(selection.score().judged / pair, 1, 1e-5);
    double best_pair = 0;
    for (std::uint32_t i = 0; i < 30; ++i) {
      for (const std::uint32_t kept : {a, b}) {
        const bool allowed = i != kept && row.apart(i, kept, wishes.min_angle_rad);
        EXPECT_LE(allowed ? row.judged({i, kept}, wishes) : 0, pair * (1 + 1e-5));
      }
      for (std::uint32_t j = 0; j < i; ++j)
        if (row.apart(i, j, wishes.min_angle_rad)) best_pair = std::max(best_pair, row.judged({i, j}, wishes));
    }
    EXPECT_LE(pair, best_pair * (1 + 1e-5));
    EXPECT_GT(pair, 0.9 * best_pair);
    found += pair;
    best_of_all += best_pair;
  }
  EXPECT_GT(found, 0.985 * best_of_all);
}

TEST(JudgedSelection, SkipsCandidatesThatCannotMatter) {
  DrawnRow row(200, 300, 5);
  for (std::size_t l = 10; l < row.lights.size(); ++l)
    for (float& lux : row.lights[l].lux) lux *= 0.01f;
  JudgedSelection selection = row.selection({});
  selection.add();
  selection.add();
  EXPECT_LE(selection.added_up(), 20u);
}

TEST(JudgedSelection, RemovingAnAddedLightRestoresTheScore) {
  const DrawnRow row(80, 25, 9);
  JudgedSelection selection = row.selection({});
  selection.add();
  selection.add();
  const JudgedScore before = selection.score();
  const auto third = selection.add();
  ASSERT_TRUE(third);
  EXPECT_GT(selection.score().judged, before.judged);
  selection.remove(2);
  EXPECT_EQ(selection.score().judged, before.judged);
  EXPECT_EQ(selection.add(), third);
  // Adds one light after the other until none keeps its distance.
  while (selection.add()) {
  }
  for (std::size_t i = 0; i < selection.taken().size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_TRUE(row.apart(index_of(row, selection.taken()[i]), index_of(row, selection.taken()[j]),
                            selection.wishes().min_angle_rad));
  EXPECT_LT(selection.taken().size(), 25u);
}

TEST(JudgedSelection, CountsFixedLightAndTakesNoDarkCandidate) {
  DrawnRow row(40, 6, 2);
  JudgedWishes wishes;
  wishes.fixed_lux.assign(40, 0);
  wishes.fixed_lux[3] = 50;
  JudgedSelection selection = row.selection(wishes);
  EXPECT_NEAR(selection.score().local_contrast_lx, 3 * 50.0 / 40, 1e-6);  // it and its neighbours
  for (JudgedLight& light : row.lights) std::fill(light.lux.begin(), light.lux.end(), 0.0f);
  JudgedSelection dark = row.selection({});
  EXPECT_FALSE(dark.add());
  EXPECT_FALSE(dark.settle());
  EXPECT_EQ(dark.score().local_contrast_lx, 0);
  const DrawnRow none(40, 0, 1);
  JudgedSelection empty = none.selection({});
  EXPECT_FALSE(empty.add());
}

TEST(JudgedLights, MatchRaysAndNoOtherPlaceIsBetter) {
  const ReliefStudy study = studied_for_lights(make_carved_relief(0.02));
  const std::vector<Vec3> places = places_around(study, 3);
  const Intensity spot = make_spot(1000, rad_from_deg(20), rad_from_deg(40));
  const auto judged = JudgedLights::make(study.surface, study.rays, study.interest, study.features, places, {}, spot,
                                         JudgedLightOptions{});
  ASSERT_TRUE(judged);
  const auto by_rays = [&](const std::vector<std::pair<Vec3, Vec3>>& lights) {
    std::vector<MountedBeam> beams;
    for (const auto& [place, direction] : lights) beams.push_back(aimed_beam(place, direction, spot));
    return relief_contrast(study.surface, study.rays, {}, study.interest, beams, 0, 0).local_contrast_lx;
  };
  for (const int count : {1, 3}) {
    const auto chosen = judged->lights(count);
    ASSERT_TRUE(chosen);
    ASSERT_EQ(chosen->lights.size(), static_cast<std::size_t>(count));
    std::vector<std::pair<Vec3, Vec3>> lights;
    for (const JudgedLight& light : chosen->lights) lights.emplace_back(light.position_world_m, light.direction);
    EXPECT_NEAR(chosen->score.local_contrast_lx / by_rays(lights), 1, 1e-4);
    EXPECT_GT(chosen->score.coverage, 0);
  }
  // One light is tested against every place, aimed at every twentieth interest point.
  double best_lx = 0;
  for (const Vec3& place : places)
    for (std::size_t i = 0; i < study.points.size(); i += 20)
      best_lx = std::max(best_lx, by_rays({{place, (study.points[i].position_world_m - place).normalized()}}));
  EXPECT_GT(judged->lights(1)->score.local_contrast_lx, 0.95 * best_lx);
}

TEST(JudgedLights, RefuseInvalidCountsAndPlaces) {
  const ReliefStudy study = studied_for_lights(make_terrain(100, 40));
  const Intensity spot = make_spot(1000, rad_from_deg(20), rad_from_deg(40));
  const std::vector<Vec3> above = {Vec3(0, 0, 80)}, below = {Vec3(0, 0, -80)}, nowhere = {Vec3(0, 0, std::nan(""))};
  const auto made = [&](std::span<const Vec3> places, const JudgedLightOptions& options) {
    return JudgedLights::make(study.surface, study.rays, study.interest, study.features, places, {}, spot, options);
  };
  ASSERT_TRUE(made(above, {}));
  EXPECT_EQ(made(above, {})->lights(3)->lights.size(), 1u);  // two lights there would be one brighter light
  EXPECT_FALSE(made(above, {})->lights(0));
  EXPECT_FALSE(made(above, {})->lights(65));
  EXPECT_FALSE(made(below, {}));  // open ground, from behind
  EXPECT_FALSE(made(nowhere, {}));
  EXPECT_FALSE(made({}, {}));
  JudgedLightOptions options;
  options.min_angle_rad = -1;
  EXPECT_FALSE(made(above, options));
  options = {};
  options.first_points = 0;
  EXPECT_FALSE(made(above, options));
  const RayScene lid(parametric(1, 1, [](double u, double v) { return Vec3(400 * u - 200, 400 * v - 200, 60); }));
  options = {};
  options.surroundings.environment = &lid;
  EXPECT_FALSE(made(above, options));
  EXPECT_FALSE(
      JudgedLights::make(study.surface, study.rays, {}, FeatureClusters{}, above, {}, spot, JudgedLightOptions{}));
  EXPECT_FALSE(JudgedLights::make(study.surface, study.rays, study.interest, study.features, above, {}, nullptr,
                                  JudgedLightOptions{}));
}

}  // namespace
}  // namespace luxrig
