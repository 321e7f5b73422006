#include "tools/bench/cache/cache_ablation.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/tools/bench/cache/cache_rooms.h"

namespace luxrig {
namespace {

/// A clock that advances by a second at each reading.
StopWatch stepped() {
  return [now = 0.0]() mutable { return now += 1; };
}

TEST(CacheAblation, EverySettingRunsAndReportsTimeMemoryAndError) {
  const Scene scene = make_cube(2, 0.5);
  const RayScene rays(scene);
  std::vector<Receiver> receivers;
  for (const WallPoint& p : cube_wall_grid(2, 1)) receivers.push_back({p.position_m, p.normal});
  const std::vector<Emitter> emitters = {bulb_at(Vec3::Zero())};
  auto settings = cache_ablation_settings();
  std::set<std::string> names;
  for (auto& one : settings) {
    EXPECT_TRUE(names.insert(one.name).second) << one.name;
    one.settings.voxels = std::max(16, one.settings.voxels / 8);
    one.settings.gather_rays = one.settings.light_samples = 64;
  }
  const auto rows = run_cache_ablation(scene, rays, receivers, emitters, Eigen::VectorXd::Constant(6, 1000 / 24.0 * 2),
                                       settings, stepped(), {});
  ASSERT_TRUE(rows.has_value());
  ASSERT_EQ(rows->size(), settings.size());
  for (std::size_t i = 0; i < rows->size(); ++i) {
    const AblationRow& row = (*rows)[i];
    EXPECT_EQ(row.setting, settings[i].name);
    EXPECT_EQ(row.build_seconds, 1);
    EXPECT_EQ(row.evaluate_seconds, 1);
    EXPECT_EQ(row.changed_lamp_seconds, 1);
    EXPECT_GT(row.report.bytes, 0u);
    EXPECT_GT(row.report.cells, 0u);
    EXPECT_GE(row.rms_error, std::abs(row.mean_error) - 1e-12);
    EXPECT_LT(row.rms_error, 1);
  }
}

TEST(CacheAblation, AReferenceOfTheWrongLengthIsRefused) {
  const Scene scene = make_cube(2, 0.5);
  const RayScene rays(scene);
  const auto refused = run_cache_ablation(scene, rays, {}, {}, Eigen::VectorXd::Ones(2), {}, stepped(), {});
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().cause, Cause::invalid);
}

TEST(CacheAblation, WalkAndDistanceFieldAgreeAndTheMarchMissesWalls) {
  const Scene scene = two_rooms(0.5);
  const RayScene rays(scene);
  const auto rows = compare_traversals(scene, rays, 128, 4000, 1, stepped());
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(rows[0].name, "exact rays");
  EXPECT_EQ(rows[0].missed + rows[0].invented, 0);
  EXPECT_NEAR(rows[1].missed, rows[2].missed, 1e-3);
  EXPECT_NEAR(rows[1].invented, rows[2].invented, 1e-3);
  EXPECT_LT(rows[1].missed, 0.3);  // walls within a cell of a line's end, which is left out
  EXPECT_GT(rows[3].missed, rows[1].missed + 0.1) << "six looks";
  EXPECT_GT(rows[3].missed, rows[5].missed);
  EXPECT_TRUE(compare_traversals(Scene{}, rays, 64, 100, 1, stepped()).empty());
}

}  // namespace
}  // namespace luxrig
