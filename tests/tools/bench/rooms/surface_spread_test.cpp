#include "tools/bench/rooms/surface_spread.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/bench/rooms/room_plan.h"

namespace luxrig {
namespace {

/// A closed room of 6 × 4 × 3 m with a block that stands on its floor and a board 0.5 m above it.
struct SpreadRoom {
  SpreadRoom() {
    const auto grey = model.material("grey", Vec3::Constant(0.5));
    model.begin_object("room");
    model.shell(Vec3::Zero(), {6, 4, 3}, 0.3, grey, grey, {grey, grey, grey, grey});
    model.begin_object("block");
    model.box({1, 1, -0.05}, {2, 3, 0.5}, grey);
    model.begin_object("board");
    model.box({4, 1, 0.5}, {5, 3, 0.52}, grey);
    scene = model.scene();
    floor.objects = {"room"};
    floor.box_world_m = Eigen::AlignedBox3d(Vec3(0, 0, -0.1), Vec3(6, 4, 0.1));
  }
  SolidModel model;
  Scene scene;
  SurfacePart floor;
};

TEST(SurfaceSpread, LiesOnlyOnTheFreeFloorAMillimetreOffIt) {
  SpreadRoom room;
  const RayScene rays(room.scene);
  const SurfaceSpread spread(room.scene, rays, {3, 2, 1.5});
  EXPECT_FALSE(spread.in_air({1.5, 2, 0.2}));
  EXPECT_TRUE(spread.in_air({1.5, 2, 0.7}));
  room.floor.headroom_m = 1;
  const auto receivers = spread.over(room.floor, 200, 1);
  ASSERT_EQ(receivers.size(), 200u);
  const auto in = [](const Vec3& p, double x0, double x1, double y0, double y1) {
    return p.x() > x0 && p.x() < x1 && p.y() > y0 && p.y() < y1;
  };
  for (const Receiver& r : receivers) {
    EXPECT_NEAR(r.position_world_m.z(), kOffSurface_m, 1e-6);
    EXPECT_TRUE(r.normal_world.isApprox(Vec3::UnitZ()));
    EXPECT_TRUE(in(r.position_world_m, 0.029, 5.971, 0.029, 3.971));
    EXPECT_FALSE(in(r.position_world_m, 0.971, 2.029, 0.971, 3.029)) << "in the block, or by its side";
    EXPECT_FALSE(in(r.position_world_m, 4, 5, 1, 3)) << "below the board";
  }
  // With less headroom, receivers also lie below the board.
  room.floor.headroom_m = 0.4;
  int below = 0;
  for (const Receiver& r : spread.over(room.floor, 200, 1)) below += in(r.position_world_m, 4, 5, 1, 3);
  EXPECT_NEAR(below, 200.0 * 2 / 22, 4);
}

TEST(SurfaceSpread, KeepsReceiversApartAndCoversTheFloor) {
  SpreadRoom room;
  const RayScene rays(room.scene);
  const auto receivers = SurfaceSpread(room.scene, rays, {3, 2, 1.5}).over(room.floor, 200, 3);
  double nearest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < receivers.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      nearest_m = std::min(nearest_m, (receivers[i].position_world_m - receivers[j].position_world_m).norm());
  // The distance in the densest packing of 200 on 22 m²; random points come as near as a tenth of it.
  const double packed_m = std::sqrt(2 / std::sqrt(3.0) * 22 / 200);
  EXPECT_GT(nearest_m, 0.55 * packed_m);
  for (double x = 0.1; x < 6; x += 0.2)
    for (double y = 0.1; y < 4; y += 0.2) {
      if (x > 0.9 && x < 2.1 && y > 0.9 && y < 3.1) continue;
      const bool near = std::any_of(receivers.begin(), receivers.end(), [&](const Receiver& r) {
        return (r.position_world_m - Vec3(x, y, 0)).norm() < 1.2 * packed_m;
      });
      EXPECT_TRUE(near) << x << ' ' << y;
    }
}

TEST(SurfaceSpread, IsTheSameForASeedAndDiffersForTwo) {
  SpreadRoom room;
  const RayScene rays(room.scene);
  const SurfaceSpread spread(room.scene, rays, {3, 2, 1.5});
  const auto a = spread.over(room.floor, 50, 7), b = spread.over(room.floor, 50, 7), c = spread.over(room.floor, 50, 8);
  bool differ = false;
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(a[i].position_world_m, b[i].position_world_m);
    differ |= a[i].position_world_m != c[i].position_world_m;
  }
  EXPECT_TRUE(differ);
}

TEST(SurfaceSpread, UsesEitherSideOnRequestAndGivesNothingWhereNothingFits) {
  SpreadRoom room;
  for (auto& t : room.scene.triangles) std::swap(t[0], t[1]);
  const RayScene rays(room.scene);
  const SurfaceSpread spread(room.scene, rays, {3, 2, 1.5});
  EXPECT_TRUE(spread.over(room.floor, 50, 1).empty());
  room.floor.either_side = true;
  EXPECT_EQ(spread.over(room.floor, 50, 1).size(), 50u);
  EXPECT_TRUE(spread.over(room.floor, 0, 1).empty());
  room.floor.objects = {"no such object"};
  EXPECT_TRUE(spread.over(room.floor, 50, 1).empty());
  room.floor.objects.clear();
  room.floor.headroom_m = 10;
  EXPECT_TRUE(spread.over(room.floor, 50, 1).empty());
}

}  // namespace
}  // namespace luxrig
