/// even_surface: the same for any number of threads.
#include <gtest/gtest.h>

#include "core/highlight/surface/even_surface.h"
#include "tests/core/highlight/surface/even_surface_fixture.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

using namespace even_surface_fixture;

TEST(EvenSurface, IsTheSameForAnyNumberOfThreads) {
  const TargetSurface mesh = mesh_of(make_terrain(100, 60));
  const EvenSurface one = even_of(mesh, 4, 1), three = even_of(mesh, 4, 3);
  EXPECT_EQ(one.surface.points_m, three.surface.points_m);
  EXPECT_EQ(one.surface.rings_, three.surface.rings_);
  EXPECT_EQ(one.surface.ring_begin_, three.surface.ring_begin_);
}

}  // namespace
}  // namespace luxrig
