#include "core/goals/painting.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "tests/core/goals/built_scene.h"

namespace luxrig {
namespace {

struct Painted {
  explicit Painted(const BuiltScene& built, double cell_m = 0.1)
      : scene(built.scene()),
        rays(scene),
        surface(*make_surface_patches(scene, rays, {cell_m, 1})),
        painting(surface, rays) {}
  Scene scene;
  RayScene rays;
  SurfacePatches surface;
  Painting painting;

  [[nodiscard]] double painted_m2() const {
    double sum = 0;
    for (std::size_t p = 0; p < surface.size(); ++p)
      if (!std::isnan(painting.lux()[p])) sum += surface.patches[p].area_m2;
    return sum;
  }
};

const Vec3 kUp = Vec3::UnitZ();

Stroke bucket(const Vec3& at, double lux, const Vec3& normal = kUp) {
  return {StrokeKind::bucket, {{at, normal}}, lux, 0, 0};
}
Stroke selective(const Vec3& at, double lux) { return {StrokeKind::selective, {{at, kUp}}, lux, 0, 0}; }
Stroke brush(std::vector<SurfacePlace> path, double lux, double radius_m, double falloff = 0) {
  return {StrokeKind::brush, std::move(path), lux, radius_m, falloff};
}
Stroke eraser(const Vec3& at) { return {StrokeKind::eraser, {{at, kUp}}, 0, 0, 0}; }

std::vector<float> copy_of(std::span<const float> lux) { return {lux.begin(), lux.end()}; }
bool same(std::span<const float> a, std::span<const float> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](float x, float y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

/// A floor of 6 x 4 m with a table on it and a thin wall that ends 1 m short of the far side.
BuiltScene room() {
  BuiltScene built;
  built.sheet({0, 0, 0}, {6, 0, 0}, {0, 4, 0}).box({1, 1, 0.7}, {2, 2, 0.74});
  return built.box({3, -0.1, -0.1}, {3.05, 3, 2.5});
}

Stroke any_stroke(Random& random) {
  const Vec3 at(random.between(-0.2, 6.2), random.between(-0.2, 4.2), random.below(6) == 0 ? 0.74 : 0);
  const double lux = std::floor(random.between(0, 500));
  switch (random.below(5)) {
    case 0:
      return bucket(at, lux);
    case 1:
      return selective(at, lux);
    case 2:
      return eraser(at);
    default:
      break;
  }
  std::vector<SurfacePlace> path;
  for (std::size_t i = 0, n = 1 + random.below(4); i < n; ++i) path.push_back({at + Vec3(0.3 * double(i), 0, 0), kUp});
  return brush(path, lux, random.between(0, 1), random.below(2) ? random.between(0, 1) : 0);
}

TEST(Painting, UndoOfRedoIsIdentityAndEveryStateIsWhatPaintingAfreshGives) {
  Painted state(room(), 0.2);
  for (unsigned seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    Painting painting(state.surface, state.rays);
    for (int i = 0; i < 40; ++i) {
      const std::vector<float> before = copy_of(painting.lux());
      const std::size_t strokes = painting.strokes().size();
      switch (random.below(5)) {
        case 0:
          if (painting.undo()) {
            const std::vector<float> undone = copy_of(painting.lux());
            ASSERT_TRUE(painting.redo());
            EXPECT_TRUE(same(painting.lux(), before));
            ASSERT_TRUE(painting.undo());
            EXPECT_TRUE(same(painting.lux(), undone));
          }
          break;
        case 1:
          (void)painting.redo();
          break;
        case 2:
          painting.extend({{random.between(0, 6), random.between(0, 4), 0}, kUp});
          break;
        default:
          painting.add(any_stroke(random));
          EXPECT_EQ(painting.strokes().size(), strokes + 1);
      }
      // What it says changed is what changed, but for the moves back and forth above.
      Painting afresh(state.surface, state.rays);
      for (const Stroke& stroke : painting.strokes()) afresh.add(stroke);
      ASSERT_TRUE(same(painting.lux(), afresh.lux())) << "seed " << seed << " step " << i;
    }
    while (painting.undo()) continue;
    for (const float lux : painting.lux()) EXPECT_TRUE(std::isnan(lux));
  }
}

TEST(Painting, ItSaysWhichPatchesChanged) {
  Painted state(room(), 0.2);
  Random random(99);
  for (int i = 0; i < 60; ++i) {
    const std::vector<float> before = copy_of(state.painting.lux());
    if (random.below(3) == 0)
      (void)state.painting.undo();
    else
      state.painting.add(any_stroke(random));
    std::vector<std::uint32_t> changed(state.painting.changed().begin(), state.painting.changed().end()), expected;
    std::sort(changed.begin(), changed.end());
    for (std::uint32_t p = 0; p < state.surface.size(); ++p)
      if (!same({&before[p], 1}, {&state.painting.lux()[p], 1})) expected.push_back(p);
    EXPECT_EQ(changed, expected);
  }
}

TEST(Painting, ABucketFillsItsGroupAndNothingElse) {
  Painted state(room());
  state.painting.add(bucket({1.5, 1.5, 0.74}, 750));
  EXPECT_NEAR(state.painted_m2(), 2, 0.05) << "the table top, which also stands for the inside of its lower side";
  EXPECT_EQ(state.painting.lux_at({{1.2, 1.8, 0.74}, kUp}), 750);
  EXPECT_FALSE(state.painting.lux_at({{1.2, 1.8, 0.7}, -kUp}));
  EXPECT_FALSE(state.painting.lux_at({{1.2, 1.8, 0}, kUp})) << "the floor below it";
  EXPECT_FALSE(state.painting.lux_at({{1.2, 1.8, 5}, kUp}));
  state.painting.add(bucket({3, 1, 1}, 100, -Vec3::UnitX()));
  EXPECT_EQ(state.painting.lux_at({{3, 2, 2}, -Vec3::UnitX()}), 100);
  EXPECT_FALSE(state.painting.lux_at({{3.05, 2, 2}, Vec3::UnitX()})) << "the other side of the thin wall";
}

TEST(Painting, ABrushKeepsToItsRadiusAndToItsSideOfAWall) {
  Painted state(room());
  const Vec3 at(2.9, 1, 0);
  state.painting.add(brush({{at, kUp}}, 300, 0.8));
  double area = 0;
  for (std::uint32_t p = 0; p < state.surface.size(); ++p) {
    const Vec3 there = state.surface.position_world_m(p);
    const bool painted = !std::isnan(state.painting.lux()[p]);
    if (painted) {
      EXPECT_LT((there - at).norm(), 0.8);
      EXPECT_LT(there.x(), 3.0) << "not beyond the wall";
      EXPECT_NEAR(there.z(), 0, 1e-6);
      area += state.surface.patches[p].area_m2;
    }
  }
  // The part of a disk on this side of a line 0.1 m from its middle.
  const double r = 0.8, d = 0.1, wanted = kPi * r * r - (r * r * std::acos(d / r) - d * std::sqrt(r * r - d * d));
  EXPECT_NEAR(area, wanted, 0.15) << "within half a row of patches along the rim";
  // A radius of 0 is one patch.
  Painting one(state.surface, state.rays);
  one.add(brush({{at, kUp}}, 300, 0));
  EXPECT_EQ(one.changed().size(), 1u);
}

TEST(Painting, ASoftBrushFadesIntoWhatIsBelowIt) {
  Painted state(BuiltScene().sheet({0, 0, 0}, {4, 0, 0}, {0, 4, 0}), 0.05);
  const Vec3 at(2, 2, 0);
  state.painting.add(bucket(at, 100));
  state.painting.add(brush({{at, kUp}}, 500, 1, 1));
  for (std::uint32_t p = 0; p < state.surface.size(); ++p) {
    if (state.surface.patches[p].normal.z() < 0) continue;
    const double d = (state.surface.position_world_m(p) - at).norm(), t = std::max(0.0, 1 - d);
    if (d < 0.05) continue;  // the patch below the brush counts as wholly covered
    EXPECT_NEAR(state.painting.lux()[p], 100 + 400 * t * t * (3 - 2 * t), 0.01);
  }
  Painting bare(state.surface, state.rays);
  bare.add(brush({{at, kUp}}, 500, 1, 1));
  for (const float lux : bare.lux()) EXPECT_TRUE(std::isnan(lux) || lux == 500);
}

TEST(Painting, ThreeSelectiveFillsShareOutTheFloorByDistanceAlongIt) {
  Painted state(room());
  const Vec3 seeds[] = {{0.5, 0.5, 0}, {2.5, 0.5, 0}, {4, 0.5, 0}};
  for (int i = 0; i < 3; ++i) state.painting.add(selective(seeds[i], 100 * (i + 1)));
  // Independent: shortest ways along links from every seed by relaxing until nothing changes.
  const std::uint32_t floor = state.surface.group_of_patch[*patch_at(state.surface, state.rays, {seeds[0], kUp})];
  std::vector<std::vector<double>> ways;
  for (const Vec3& seed : seeds) {
    std::vector<double> way(state.surface.size(), std::numeric_limits<double>::infinity());
    way[*patch_at(state.surface, state.rays, {seed, kUp})] = 0;
    for (bool better = true; better;) {
      better = false;
      for (const std::uint32_t p : state.surface.patches_of_group(floor))
        for (const PatchLink& link : state.surface.links_of(p))
          if (way[p] + link.length < way[link.patch]) {
            way[link.patch] = way[p] + link.length;
            better = true;
          }
    }
    ways.push_back(std::move(way));
  }
  for (std::uint32_t p = 0; p < state.surface.size(); ++p) {
    const float lux = state.painting.lux()[p];
    if (state.surface.group_of_patch[p] != floor) {
      EXPECT_TRUE(std::isnan(lux)) << "islands stay as they are";
      continue;
    }
    ASSERT_FALSE(std::isnan(lux));
    const auto owner = static_cast<std::size_t>(lux / 100) - 1;
    for (const auto& way : ways) EXPECT_LE(ways[owner][p], way[p]);
  }
  // In a straight line (3.1, 1) is 1.0 m from the third seed and 0.8 m from the second, but that is behind the wall.
  EXPECT_EQ(state.painting.lux_at({{3.15, 1, 0}, kUp}), 300);
  EXPECT_EQ(state.painting.lux_at({{2.9, 1, 0}, kUp}), 200);
  // Erasing the middle one shares its part out between the others.
  state.painting.add(eraser({2.5, 0.6, 0}));
  Painting two(state.surface, state.rays);
  two.add(selective(seeds[0], 100));
  two.add(selective(seeds[2], 300));
  EXPECT_TRUE(same(state.painting.lux(), two.lux()));
}

TEST(Painting, ASecondSelectiveClickOnAPatchCountsInsteadOfTheFirst) {
  Painted state(room());
  state.painting.add(selective({1, 3, 0}, 100));
  state.painting.add(selective({1, 3, 0}, 250));
  EXPECT_EQ(state.painting.lux_at({{2, 3, 0}, kUp}), 250);
  state.painting.add(eraser({2, 3, 0}));
  EXPECT_EQ(state.painting.lux_at({{2, 3, 0}, kUp}), 100);
}

TEST(Painting, AnEraserTakesTheUppermostStrokeOnly) {
  Painted state(room());
  state.painting.add(bucket({1, 3, 0}, 100));
  state.painting.add(brush({{{1, 3, 0}, kUp}}, 300, 0.5));
  state.painting.add(eraser({1, 3, 0}));
  EXPECT_EQ(state.painting.lux_at({{1, 3, 0}, kUp}), 100);
  state.painting.add(eraser({1, 3, 0}));
  EXPECT_FALSE(state.painting.lux_at({{1, 3, 0}, kUp}));
  state.painting.add(eraser({1, 3, 0}));
  EXPECT_TRUE(state.painting.changed().empty());
  EXPECT_TRUE(state.painting.undo());
  EXPECT_TRUE(state.painting.undo());
  EXPECT_EQ(state.painting.lux_at({{1, 3, 0}, kUp}), 100);
}

TEST(Painting, StrokesThatMakeNoSenseChangeNothing) {
  Painted state(room());
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const Vec3 at(1, 3, 0);
  const std::vector<Stroke> bad{bucket(at, nan),
                                bucket(at, -1),
                                bucket(at, infinity),
                                bucket({nan, 0, 0}, 1),
                                {StrokeKind::bucket, {}, 100, 0, 0},
                                brush({}, 100, 1),
                                brush({{at, kUp}}, 100, -1),
                                brush({{at, kUp}}, 100, nan),
                                brush({{at, kUp}}, 100, 1, 1.5),
                                brush({{at, kUp}}, 100, 1, nan),
                                eraser({nan, nan, nan}),
                                selective({9, 9, 9}, 100)};
  for (const Stroke& stroke : bad) {
    state.painting.add(stroke);
    EXPECT_TRUE(state.painting.changed().empty());
  }
  EXPECT_EQ(state.painting.strokes().size(), bad.size());
  for (std::size_t i = 0; i < bad.size(); ++i) EXPECT_TRUE(state.painting.undo());
  EXPECT_FALSE(state.painting.undo());
  Painted none{BuiltScene()};
  none.painting.add(bucket(at, 100));
  none.painting.extend({at, kUp});
  EXPECT_TRUE(none.painting.lux().empty());
}

}  // namespace
}  // namespace luxrig
