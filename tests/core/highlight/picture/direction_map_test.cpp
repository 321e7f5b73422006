#include "core/highlight/picture/direction_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/random.h"

namespace luxrig {
namespace {

TEST(DirectionMap, IsItsOwnInverse) {
  Random random(3);
  for (int i = 0; i < 500; ++i) {
    const DirectionMap map(i == 0 ? Vec3(Vec3::UnitZ()) : Vec3(3 * random.direction()));
    const Vec3 direction = random.direction();
    const DirectionMap::MapPoint place = map.place_of(2 * direction);
    EXPECT_LE(std::hypot(place.x, place.y), 1 + 1e-12);
    EXPECT_LT((map.direction_at(place) - direction).norm(), 1e-7);
  }
}

TEST(DirectionMap, AreasAreSolidAngles) {
  // A cap of angle θ takes the share 1 - cos θ of a hemisphere, so also of a disc of radius 1.
  Random random(4);
  const Vec3 viewer = random.direction();
  const DirectionMap map(viewer);
  for (const double deg : {0.0, 10.0, 37.0, 60.0, 89.0, 90.0}) {
    const Vec3 around = viewer.cross(random.direction()).normalized();
    for (const double towards : {1.0, -1.0}) {
      const Vec3 direction = towards * (Eigen::AngleAxisd(rad_from_deg(deg), around) * viewer);
      const DirectionMap::MapPoint place = map.place_of(direction);
      EXPECT_NEAR(place.x * place.x + place.y * place.y, 1 - std::cos(rad_from_deg(deg)), 1e-12);
      if (deg < 90) {  // on the rim rounding decides
        EXPECT_EQ(place.behind, towards < 0);
      }
    }
  }
}

TEST(DirectionMap, LeftIsLeftAndUpIsUpOnBothHalves) {
  // A viewer in front of the object at -Y, looking along +Y, has +X to the right.
  const DirectionMap map(-Vec3::UnitY());
  const auto front = map.place_of(Vec3(0.2, -1, 0.1)), back = map.place_of(Vec3(0.2, 1, 0.1));
  EXPECT_FALSE(front.behind);
  EXPECT_TRUE(back.behind);
  for (const DirectionMap::MapPoint& place : {front, back}) {
    EXPECT_GT(place.x, 0.1);
    EXPECT_GT(place.y, 0.05);
  }
  const auto up = map.place_of(Vec3::UnitZ());
  EXPECT_NEAR(up.x, 0, 1e-12);
  EXPECT_NEAR(up.y, 1, 1e-12);
}

TEST(DirectionMap, MapsPointsOutsideTheCircleToItsRim) {
  const DirectionMap map(Vec3::UnitX());
  EXPECT_LT((map.direction_at({false, 3, 0}) - map.direction_at({true, 1, 0})).norm(), 1e-9);
}

}  // namespace
}  // namespace luxrig
