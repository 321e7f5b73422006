/// The shortest rotation between two directions, also for those that are nearly parallel or nearly opposite.

#include "core/geometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace luxrig {
namespace {

TEST(ShortestRotation, TurnsOneDirectionToTheOtherHoweverCloseOrOppositeTheyAre) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return Vec3(normal(random), normal(random), normal(random)).normalized(); };
  double max_miss = 0, max_skew = 0;
  for (int i = 0; i < 100'000; ++i) {
    const Vec3 from = direction(), aside = direction();
    const double offset = std::pow(10.0, -17.0 * (i % 100) / 99.0);
    const Vec3 to = ((i % 2 ? 1 : -1) * from + offset * aside).normalized();
    const Mat3 turn = shortest_rotation(from, to);
    max_miss = std::max(max_miss, (turn * from - to).norm());
    max_skew = std::max(max_skew, (turn.transpose() * turn - Mat3::Identity()).norm());
    EXPECT_GT(turn.determinant(), 0);
    // The trace of a rotation by angle a is 1 + 2 cos a. No other rotation that maps `from` to `to` has a greater one.
    EXPECT_NEAR(turn.trace(), 1 + 2 * from.dot(to), 1e-14);
  }
  EXPECT_LT(max_miss, 3e-15);
  EXPECT_LT(max_skew, 3e-15);
}

TEST(ShortestRotation, IsNoneForTheSameDirectionAndAHalfTurnForOppositeOnes) {
  EXPECT_EQ(shortest_rotation(Vec3::UnitX(), Vec3::UnitX()), Mat3(Mat3::Identity()));
  for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())}) {
    const Mat3 turn = shortest_rotation(axis, -axis);
    EXPECT_EQ(Vec3(turn * axis), Vec3(-axis));
    EXPECT_NEAR(turn.trace(), -1, 1e-15);
  }
}

}  // namespace
}  // namespace luxrig
