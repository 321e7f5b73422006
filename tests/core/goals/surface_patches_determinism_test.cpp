#include <gtest/gtest.h>

#include "core/goals/surface_patches.h"
#include "tests/core/goals/built_scene.h"

namespace luxrig {
namespace {

TEST(SurfacePatchesDeterminism, TheNumberOfThreadsChangesNothing) {
  Random random(7);
  BuiltScene built;
  built.clutter(random, 6000, 2).sheet({-2, -2, -1}, {4, 0, 0}, {0, 4, 0}, 30, 30).column({0, 0, -1}, 0.5, 2, 100);
  const RayScene rays(built.scene());
  const auto one = make_surface_patches(built.scene(), rays, {0.1, 1});
  const auto many = make_surface_patches(built.scene(), rays, {0.1, 5});
  ASSERT_TRUE(one && many);
  ASSERT_GT(one->size(), 10000u);  // several blocks of work
  ASSERT_EQ(one->size(), many->size());
  for (std::size_t p = 0; p < one->size(); ++p) {
    EXPECT_EQ(one->patches[p].position_m, many->patches[p].position_m);
    EXPECT_EQ(one->patches[p].normal, many->patches[p].normal);
    EXPECT_EQ(one->patches[p].area_m2, many->patches[p].area_m2);
  }
  EXPECT_EQ(one->cells, many->cells);
  EXPECT_EQ(one->first_link, many->first_link);
  EXPECT_EQ(one->group_of_patch, many->group_of_patch);
  for (std::size_t i = 0; i < one->links.size(); ++i) {
    EXPECT_EQ(one->links[i].patch, many->links[i].patch);
    EXPECT_EQ(one->links[i].length, many->links[i].length);
  }
}

}  // namespace
}  // namespace luxrig
