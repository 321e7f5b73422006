#include "core/solve/placement/search/refine_lights.h"

#include <gtest/gtest.h>

#include "tests/core/solve/placement/lit_hall.h"
#include "tests/random.h"

namespace luxrig {
namespace {

// Compared with central differences of the columns, without obstacles.
TEST(SceneLight, DerivativesMatchItsColumns) {
  LitRoom empty = make_box_room(1);
  empty.scene = {};
  const Mat3 turned = Eigen::AngleAxisd(0.4, Vec3(1, 2, 0.5).normalized()).toRotationMatrix();
  for (const Intensity& intensity : {make_isotropic(1), make_cosine_power(1, 3)}) {
    const LitHall hall(empty, 10, Emitter{intensity, {turned, Vec3::Zero()}});
    Random random(5);
    for (int trial = 0; trial < 20; ++trial) {
      const Vec3 at_m(random.between(0.5, 3.5), random.between(0.5, 2.5), random.between(1.5, 2.4));
      Eigen::VectorXd lux, ahead, behind;
      Eigen::MatrixXd lux_per_m;
      ASSERT_TRUE(hall.light->column({at_m}, lux, &lux_per_m));
      for (int axis = 0; axis < 3; ++axis) {
        constexpr double kStep_m = 1e-5;
        ASSERT_TRUE(hall.light->column({at_m + kStep_m * Vec3::Unit(axis)}, ahead, nullptr));
        ASSERT_TRUE(hall.light->column({at_m - kStep_m * Vec3::Unit(axis)}, behind, nullptr));
        for (Eigen::Index i = 0; i < lux.size(); ++i) {
          if (lux[i] == 0 || ahead[i] == 0 || behind[i] == 0) continue;
          EXPECT_NEAR(lux_per_m(i, axis), (ahead[i] - behind[i]) / (2 * kStep_m),
                      1e-4 * lux_per_m.cwiseAbs().maxCoeff());
        }
      }
    }
  }
}

TEST(RefineLights, RestoresLightsShiftedByTwentyCentimetresWithoutShadows) {
  LitRoom empty = make_box_room(1);
  empty.scene = {};
  const LitHall hall(empty, 10);
  Random random(7);
  for (int trial = 0; trial < 10; ++trial) {
    std::vector<Vec3> places_m = {{1, 1, 2}, {3, 2, 2.2}};
    const LightingGoal goal = hall.goal_of(places_m, {700, 400});
    PlacedLights lights(*hall.light, goal);
    for (const Vec3& place_m : places_m) ASSERT_TRUE(lights.add({place_m + 0.2 * random.direction()}));
    const double before = lights.error();
    EXPECT_GT(before, 0.005);
    refine_lights(lights);
    EXPECT_LE(lights.error(), 1e-6);
    for (std::size_t k = 0; k < 2; ++k) EXPECT_LE((lights.poses()[k].position_world_m - places_m[k]).norm(), 1e-5);
    EXPECT_NEAR(lights.levels()[0], 700, 0.01);
  }
}

TEST(RefineLights, NeverIncreasesTheErrorAmongShadows) {
  const LitHall hall(make_box_room(2), 10);
  const LightingGoal goal{Eigen::VectorXd::Constant(hall.light->points(), 300)};
  Random random(9);
  for (int trial = 0; trial < 20; ++trial) {
    PlacedLights lights(*hall.light, goal);
    while (lights.size() < 4)
      lights.add({{random.between(0.1, 3.9), random.between(0.1, 2.9), random.between(0.1, 2.4)}});
    const double before = lights.error();
    refine_lights(lights);
    EXPECT_LE(lights.error(), before);
    EXPECT_TRUE(lights.levels().allFinite());
  }
}

// Compared with levels solved again with each candidate added.
TEST(ComplementSearch, RanksCandidatesByTheirErrorReduction) {
  const LitHall hall(make_box_room(1), 0.5);
  Random random(11);
  LightingGoal goal{Eigen::VectorXd(hall.light->points()), Eigen::VectorXd(hall.light->points())};
  for (Eigen::Index i = 0; i < goal.lux.size(); ++i) {
    goal.lux[i] = random.between(100, 500);
    goal.row_weight[i] = random.between(0.2, 2);
  }
  const ComplementSearch search(hall.view(), hall.poses, goal);
  PlacedLights lights(*hall.light, goal);
  for (int chosen = 0; chosen < 4; ++chosen) {
    const auto all = search.best(lights, search.candidates(), 0);
    ASSERT_GT(all.size(), 50u);
    const double squared = lights.residual().squaredNorm();
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i > 0) {
        EXPECT_LE(all[i].gain, all[i - 1].gain);
      }
      PlacedLights with = lights;
      ASSERT_TRUE(with.add(search.pose(all[i].candidate)));
      if ((with.levels().array() <= 0).any()) continue;  // a level met its bound: the formula does not hold
      // Candidates are stored as float.
      EXPECT_NEAR(squared - with.residual().squaredNorm(), all[i].gain, 1e-5 * squared) << chosen << " " << i;
    }
    const auto apart = search.best(lights, 4, 1.0);
    ASSERT_EQ(apart.size(), 4u);
    EXPECT_EQ(apart[0].candidate, all[0].candidate);
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < a; ++b)
        EXPECT_GE((search.pose(apart[a].candidate).position_world_m - search.pose(apart[b].candidate).position_world_m)
                      .norm(),
                  1.0);
    ASSERT_TRUE(lights.add(search.pose(all[0].candidate)));
  }
}

// One pass over all lights also serves those left after some are removed: same result as a pass over these.
TEST(ComplementSearch, OverAllLightsServesAnyRemainingSubset) {
  const LitHall hall(make_box_room(1), 0.5);
  Random random(12);
  LightingGoal goal{Eigen::VectorXd(hall.light->points()), {}};
  for (Eigen::Index i = 0; i < goal.lux.size(); ++i) goal.lux[i] = random.between(100, 500);
  const ComplementSearch search(hall.view(), hall.poses, goal);
  PlacedLights lights(*hall.light, goal);
  // The second hangs at the place of the first.
  for (const Vec3& place : {Vec3(1, 1, 2), Vec3(1, 1, 2), Vec3(3, 1, 2), Vec3(2, 2, 1)})
    ASSERT_TRUE(lights.add({place}));
  const auto about = search.about(lights);
  const auto expect_same = [](const std::vector<Complement>& shared, const std::vector<Complement>& alone) {
    ASSERT_EQ(shared.size(), alone.size());
    ASSERT_FALSE(alone.empty());
    for (std::size_t i = 0; i < alone.size(); ++i)
      EXPECT_NEAR(shared[i].gain, alone[i].gain, 1e-9 * alone[0].gain) << i;
    EXPECT_EQ(shared[0].candidate, alone[0].candidate);
  };
  for (std::size_t one = 0; one < lights.size(); ++one) {
    PlacedLights others = lights;
    others.drop(one);
    expect_same(search.best(about, {one}, others, 50, 0), search.best(others, 50, 0));
    for (std::size_t two = 0; two < one; ++two) {
      PlacedLights fewer = others;
      fewer.drop(two);
      expect_same(search.best(about, {two, one}, fewer, 50, 0), search.best(fewer, 50, 0));
    }
  }
  const PlacedLights none(*hall.light, goal);
  EXPECT_FALSE(search.best(none, 5, 0.3).empty());
  PlacedLights two(*hall.light, goal);
  ASSERT_TRUE(two.add({Vec3(1, 1, 2)}) && two.add({Vec3(3, 1, 2)}));
  expect_same(search.best(search.about(two), {0, 1}, none, 20, 0), search.best(none, 20, 0));
}

}  // namespace
}  // namespace luxrig
