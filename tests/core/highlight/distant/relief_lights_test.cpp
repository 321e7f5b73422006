#include "core/highlight/distant/relief_lights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/highlight/shadow/relief_contrast.h"
#include "core/highlight/surface/relief_study.h"
#include "tests/core/highlight/distant/relief_lights_fixture.h"
#include "tests/core/highlight/shapes.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

using namespace relief_lights_fixture;

/// Level ground with a straight groove along Y, half a metre wide and half a metre deep.
Scene grooved_ground() {
  return parametric(120, 60, [](double u, double v) {
    const double x = 6 * u - 3;
    return Vec3(x, 6 * v - 3, -0.5 * std::exp(-x * x / (2 * 0.25 * 0.25)));
  });
}

/// A box seen from inside: its triangles face inwards. Each face is split into 12 × 12 squares.
Scene box_from_inside() {
  Scene box;
  const int split = 12;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const Scene face = parametric(split, split, [&](double u, double v) {
        Vec3 p;
        p[axis] = side;
        p[(axis + 1) % 3] = side * (1 - 2 * u);
        p[(axis + 2) % 3] = 2 * v - 1;
        return p;
      });
      const auto first = static_cast<std::uint32_t>(box.vertices_m.size());
      box.vertices_m.insert(box.vertices_m.end(), face.vertices_m.begin(), face.vertices_m.end());
      for (const auto& t : face.triangles) box.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
  }
  return with_one_material(box);
}

TEST(TabledContrast, MatchesContrastByRays) {
  const ReliefStudy study = studied(make_terrain(100, 50), 120);
  const ContrastSamples samples = one_ring_samples(study.surface, study.interest);
  const LitTable table = table_of(study, samples, 8, true);
  const TabledContrast contrast(samples, table, 0);
  Random random(3);
  for (std::size_t lights = 1; lights <= 4; ++lights) {
    std::vector<std::uint32_t> bins;
    std::vector<Vec3> directions;
    while (bins.size() < lights) {
      bins.push_back(static_cast<std::uint32_t>(random.below(table.bins.count())));
      directions.push_back(table.bins.direction_of(bins.back()));
    }
    const double by_rays = contrast_by_rays(study, directions);
    EXPECT_NEAR(contrast.of(bins).local_contrast_lx, by_rays, 1e-5);
    // Add the last bin to the light of the others.
    const std::uint32_t last = bins.back();
    bins.pop_back();
    EXPECT_NEAR(contrast.with_each_bin(contrast.illuminance_lx(bins))[last], by_rays, 1e-5);
  }
  const SampleContrast dark = contrast.of({});
  EXPECT_EQ(dark.local_contrast_lx, 0);
  EXPECT_EQ(dark.exposed_contrast, 0);
}

TEST(TabledContrast, ExposedContrastIsRelativeToTheBrighterOrTheMean) {
  // Two level places, one of them dark, and one that faces sideways, lit at half.
  ContrastSamples samples;
  samples.interest = 1;
  samples.points = {
      {Vec3::Zero(), Vec3::UnitZ()}, {Vec3::UnitX(), Vec3::UnitZ()}, {Vec3::UnitY(), Vec3(std::sqrt(0.75), 0, 0.5)}};
  samples.neighbours = {1, 2};
  samples.begin = {0, 2};
  LitTable table{DirectionBins(1), 1, {1, 0, 1}, 0};  // bin 0 only
  const Vec3 light = table.bins.direction_of(0);
  const double level = light.z(), tilted = std::max(0.0, light.dot(samples.points[2].normal));
  const std::array<std::uint32_t, 1> bins = {0};
  const SampleContrast found = TabledContrast(samples, table, 1).of(bins);
  EXPECT_NEAR(found.local_contrast_lx, std::max(level, std::abs(level - tilted)), 1e-6);
  const double mean = (level + tilted) / 3;
  EXPECT_NEAR(found.exposed_contrast,
              std::max(level / std::max(level, mean), std::abs(level - tilted) / std::max({level, tilted, mean})),
              1e-6);
}

TEST(ReliefLights, ShineAcrossAGroove) {
  const ReliefStudy study = studied(grooved_ground(), 200);
  const auto one = searched(study, {}).lights(1);
  ASSERT_TRUE(one);
  ASSERT_EQ(one->directions.size(), 1u);
  const Vec3& direction = one->directions[0];
  EXPECT_NEAR(direction.norm(), 1, 1e-12);
  EXPECT_LT(std::abs(direction.y()), std::sin(rad_from_deg(8)));
  EXPECT_GT(direction.z(), 0.1);
  EXPECT_GT(std::abs(direction.x()), 0.3);
  // Three times the contrast of an equally steep light along the groove.
  const Vec3 along(0, std::abs(direction.x()), direction.z());
  EXPECT_GT(contrast_by_rays(study, {direction}), 3 * contrast_by_rays(study, {along}));
}

TEST(ReliefLights, KeepTheirDistanceAndImproveOnTheirStart) {
  const ReliefStudy study = studied(make_terrain(100, 60), 200);
  ReliefLightOptions options;
  options.min_angle_rad = rad_from_deg(40);
  const ReliefLightSearch search = searched(study, options);
  const std::vector<Vec3> start = {Vec3(0.1, 0, 1), Vec3(-1, 0.2, 0.1), Vec3(0, -0.3, 1)};
  const auto from_start = search.lights(3, start), greedy = search.lights(3);
  ASSERT_TRUE(from_start && greedy);
  for (const auto* lights : {&*from_start, &*greedy}) {
    ASSERT_EQ(lights->directions.size(), 3u);
    // 40° holds between bins; a peak may lie a bin's width beside its bin.
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_LT(lights->directions[i].dot(lights->directions[j]), std::cos(rad_from_deg(40 - 2 * 3.7)));
    EXPECT_GT(lights->local_contrast_lx,
              contrast_by_rays(study, {start[0].normalized(), start[1].normalized(), start[2].normalized()}));
    EXPECT_NEAR(lights->local_contrast_lx, contrast_by_rays(study, lights->directions),
                0.1 * lights->local_contrast_lx);
  }
}

TEST(ReliefLights, TheirNumberIsAtThePeakOfExposedContrast) {
  const ReliefStudy study = studied(make_terrain(100, 50), 150);
  const auto count = searched(study, {}).count_lights(6);
  ASSERT_TRUE(count);
  ASSERT_EQ(count->by_number.size(), 6u);
  ASSERT_EQ(count->exposed_contrast.size(), 6u);
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_EQ(count->by_number[k].directions.size(), k + 1);
    EXPECT_LE(0.98 * count->exposed_contrast[k], count->exposed_contrast[count->best]);
  }
  EXPECT_LT(count->exposed_contrast[5], count->exposed_contrast[count->best]);
}

TEST(ReliefStudy, ReportsWhatATargetLacks) {
  const auto why = [](const Scene& scene) {
    const auto study = study_relief(scene, {});
    return study ? std::string("nothing") : study.error().detail;
  };
  EXPECT_NE(why(uv_sphere(1, 40)).find("no recessed places"), std::string::npos);
  Scene cloud = uv_sphere(1, 10);
  cloud.triangles.clear();
  EXPECT_NE(why(with_one_material(cloud)).find("no triangles"), std::string::npos);
  EXPECT_NE(why(Scene{}).find("no triangles"), std::string::npos);
  Scene flat = uv_sphere(1, 10);
  for (auto& t : flat.triangles) t[2] = t[1];
  EXPECT_NE(why(flat).find("any area"), std::string::npos);
  Scene broken = uv_sphere(1, 10);
  broken.vertices_m[3].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(why(broken).find("not finite"), std::string::npos);
  EXPECT_EQ(why(make_terrain(100, 30)), "nothing");
}

TEST(ReliefLights, RefuseTheInsideOfAClosedBox) {
  const ReliefStudy study = studied(box_from_inside(), 100);  // its corners are recessed
  ASSERT_FALSE(study.interest.empty());
  const auto search = ReliefLightSearch::make(study.surface, study.rays, study.interest, {});
  ASSERT_FALSE(search);
  EXPECT_NE(search.error().detail.find("closed hull"), std::string::npos);
}

TEST(ReliefLights, RefuseInvalidOptions) {
  const ReliefStudy study = studied(make_terrain(100, 30), 20);
  const auto made = [&](const ReliefLightOptions& options) {
    return ReliefLightSearch::make(study.surface, study.rays, study.interest, options).has_value();
  };
  ReliefLightOptions options;
  EXPECT_TRUE(made(options));
  EXPECT_FALSE(ReliefLightSearch::make(study.surface, study.rays, {}, options));
  options.side = 0;
  EXPECT_FALSE(made(options));
  options = {};
  options.preferred = Vec3(std::nan(""), 0, 0);
  EXPECT_FALSE(made(options));
  options.preferred = Vec3::UnitX();
  options.preference = 1.5;
  EXPECT_FALSE(made(options));
  options = {};
  options.min_angle_rad = -1;
  EXPECT_FALSE(made(options));
  options = {};
  options.spread_rad = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(made(options));
  options = {};
  std::stop_source stop;
  stop.request_stop();
  options.watch.stop = stop.get_token();
  EXPECT_FALSE(made(options));
  const ReliefLightSearch search = searched(study, {});
  EXPECT_FALSE(search.lights(0));
  EXPECT_FALSE(search.lights(65));
  const std::vector<Vec3> two = {Vec3::UnitX(), Vec3::UnitZ()}, none = {Vec3::Zero()};
  EXPECT_FALSE(search.lights(1, two));
  EXPECT_FALSE(search.lights(1, none));
  EXPECT_FALSE(search.count_lights(0));
}

}  // namespace
}  // namespace luxrig
