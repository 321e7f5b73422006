/// Options of a goal beyond the lux of one light: colours, existing light, a highest level; aimed lights.

#include "core/solve/placement/lighting_goal.h"

#include <gtest/gtest.h>

#include "core/photometry/intensity.h"
#include "core/solve/placement/energy_front.h"
#include "core/solve/placement/place_lights.h"
#include "tests/core/solve/placement/lit_hall.h"
#include "tests/random.h"

namespace luxrig {
namespace {

LitRoom empty_room() {
  LitRoom room = make_box_room(1);
  room.scene = {};
  return room;
}

PlaceOptions place_count(std::size_t lights) {
  PlaceOptions options;
  options.lights = lights;
  options.max_columns = 20'000;
  return options;
}

TEST(LightPose, MovesByItsStep) {
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const LightPose pose{{1, 2, 3}, trial == 0 ? Vec3(0, 0, -1) : trial == 1 ? Vec3(0, 0, 1) : random.direction()};
    const Mat3 basis = basis_about(pose.aim_world);
    EXPECT_TRUE((basis.transpose() * basis).isIdentity(1e-12));
    EXPECT_NEAR(basis.determinant(), 1, 1e-12);
    Eigen::VectorXd step(5);
    for (double& v : step) v = random.between(-0.5, 0.5);
    const LightPose to = moved(pose, step);
    EXPECT_NEAR((to.position_world_m - pose.position_world_m - step.head<3>()).norm(), 0, 1e-12);
    EXPECT_NEAR(std::acos(to.aim_world.dot(pose.aim_world)), step.tail<2>().norm(), 1e-7);
    EXPECT_NEAR(to.aim_world.norm(), 1, 1e-12);
  }
}

// Compared with central differences of the columns.
TEST(SceneLight, SlopesOfAnAimedSpotMatchItsColumns) {
  const LitHall hall(empty_room(), 10);
  const SceneLight spot(*hall.transport, hall.room.receivers, {make_cosine_power(1, 6), {}}, {.aimed = true});
  Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    LightPose pose{{random.between(0.5, 3.5), random.between(0.5, 2.5), random.between(1.5, 2.4)}, random.direction()};
    pose.aim_world.z() = -std::abs(pose.aim_world.z());
    Eigen::VectorXd lux, ahead, behind;
    Eigen::MatrixXd slopes;
    ASSERT_TRUE(spot.column(pose, lux, &slopes));
    ASSERT_EQ(slopes.cols(), 5);
    for (Eigen::Index i = 0; i < 5; ++i) {
      constexpr double kStep = 1e-5;
      ASSERT_TRUE(spot.column(moved(pose, kStep * Eigen::VectorXd::Unit(5, i)), ahead, nullptr));
      ASSERT_TRUE(spot.column(moved(pose, -kStep * Eigen::VectorXd::Unit(5, i)), behind, nullptr));
      for (Eigen::Index r = 0; r < lux.size(); ++r) {
        if (!(lux[r] > 0 && ahead[r] > 0 && behind[r] > 0)) continue;
        EXPECT_NEAR(slopes(r, i), (ahead[r] - behind[r]) / (2 * kStep), 1e-4 * slopes.cwiseAbs().maxCoeff());
      }
    }
  }
}

TEST(PlaceLights, FindsThePlacesAndAimsOfSpots) {
  const LitHall hall(make_box_room(3), 0.5);
  const Emitter luminaire{make_cosine_power(1, 6), {}};
  const SceneLight spot(*hall.transport, hall.room.receivers, luminaire, {.aimed = true});
  const std::vector<LightPose> known = {{{0.9, 0.8, 2.2}, Vec3(0.3, 0.2, -1).normalized()},
                                        {{3.1, 2.2, 2.2}, Vec3(-0.5, 0, -1).normalized()}};
  LightingGoal goal;
  goal.lux = Eigen::VectorXd::Zero(spot.points());
  Eigen::VectorXd lux;
  for (const LightPose& pose : known) {
    ASSERT_TRUE(spot.column(pose, lux, nullptr));
    goal.lux += 500 * lux;
  }
  // Candidates: each place with several aims.
  CandidateSet set{hall.set.positions_world_m, {}};
  std::vector<LightPose> poses;
  std::vector<Vec3> aims = {-Vec3::UnitZ()};
  for (int i = 0; i < 6; ++i) aims.push_back(Vec3(std::cos(i * kPi / 3), std::sin(i * kPi / 3), -0.8).normalized());
  for (const Vec3& aim : aims) set.luminaires.push_back(spot.hung({Vec3::Zero(), aim}));
  for (const Vec3& position_m : set.positions_world_m)
    for (const Vec3& aim : aims) poses.push_back({position_m, aim});
  CandidateOptions direct_only;
  direct_only.indirect = false;
  const auto columns = candidate_transport(hall.room.scene, hall.rays, hall.room.receivers, set, direct_only)->matrix;
  const ComplementSearch candidates(ColumnsView(spot.points(), columns.begin, columns.receiver, columns.total_lux),
                                    poses, goal);
  const Placement got = place_lights(spot, goal, candidates, place_count(2));
  EXPECT_LE(got.lights.error(), 1e-3);
  for (const LightPose& pose : known) {
    const bool first = (got.lights.poses()[0].position_world_m - pose.position_world_m).norm() < 1;
    const LightPose& found = got.lights.poses()[first ? 0 : 1];
    EXPECT_LE((found.position_world_m - pose.position_world_m).norm(), 0.03);
    EXPECT_GE(found.aim_world.dot(pose.aim_world), std::cos(rad_from_deg(1)));
  }
}

TEST(PlaceLights, FindsColouredLights) {
  const LitHall hall(make_box_room(3), 0.25);
  const Eigen::Index points = hall.light->points();
  const std::vector<Vec3> places_m = {{0.9, 0.8, 2.1}, {3.1, 2.2, 1.9}};
  const Eigen::Vector3d colours[] = {{900, 300, 0}, {0, 200, 700}};
  // Emitters equal to the primaries, and emitters that each feed two primaries.
  Eigen::Matrix3d mixed;
  mixed << 1, 0.2, 0, 0.3, 1, 0.1, 0, 0, 1;
  for (const Eigen::Matrix3d& emitters : {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), mixed}) {
    LightingGoal goal;
    goal.emitters = emitters;
    goal.lux = Eigen::VectorXd::Zero(3 * points);
    Eigen::VectorXd lux;
    for (int k = 0; k < 2; ++k) {
      ASSERT_TRUE(hall.light->column({places_m[static_cast<std::size_t>(k)]}, lux, nullptr));
      for (int c = 0; c < 3; ++c) goal.lux.segment(c * points, points) += (emitters * colours[k])[c] * lux;
    }
    const ComplementSearch candidates(hall.view(), hall.poses, goal);
    const Placement got = place_lights(*hall.light, goal, candidates, place_count(2));
    EXPECT_LE(got.lights.error(), 1e-4);
    ASSERT_EQ(got.lights.levels().size(), 6);
    for (int k = 0; k < 2; ++k) {
      const bool first = (got.lights.poses()[0].position_world_m - places_m[static_cast<std::size_t>(k)]).norm() < 0.1;
      EXPECT_LE((got.lights.levels().segment(first ? 0 : 3, 3) - colours[k]).norm(), 2);
    }
  }
}

TEST(ComplementSearch, GivesTheErrorReductionForIndependentPrimaries) {
  const LitHall hall(make_box_room(1), 0.6);
  const Eigen::Index points = hall.light->points();
  Random random(4);
  LightingGoal goal;
  goal.emitters = Eigen::Matrix3d::Identity();
  goal.lux = Eigen::VectorXd(3 * points);
  goal.row_weight = Eigen::VectorXd(3 * points);
  for (double& v : goal.lux) v = random.between(100, 500);
  for (double& v : goal.row_weight) v = random.between(0.2, 2);
  const ComplementSearch search(hall.view(), hall.poses, goal);
  PlacedLights lights(*hall.light, goal);
  for (int chosen = 0; chosen < 3; ++chosen) {
    const auto all = search.best(lights, search.candidates(), 0);
    const double squared = lights.residual().squaredNorm();
    int compared = 0;
    for (const Complement& c : all) {
      PlacedLights with = lights;
      ASSERT_TRUE(with.add(search.pose(c.candidate)));
      if ((with.levels().array() <= 0).any()) continue;  // a level met its bound: the formula does not hold
      EXPECT_NEAR(squared - with.residual().squaredNorm(), c.gain, 1e-5 * squared);
      ++compared;
    }
    EXPECT_GT(compared, 10);
    ASSERT_TRUE(lights.add(search.pose(all[0].candidate)));
  }
}

TEST(PlacedLights, AddToExistingLightAndKeepTheLargestLevel) {
  const LitHall hall(empty_room(), 0.5);
  const std::vector<LightPose> poses = {{{1, 1, 2.2}}, {{3, 2, 2.2}}};
  LightingGoal goal = hall.goal_of({poses[0].position_world_m, poses[1].position_world_m}, {700, 400});
  Eigen::VectorXd lux;
  ASSERT_TRUE(hall.light->column(poses[0], lux, nullptr));
  goal.fixed_lux = 300 * lux;
  PlacedLights lights(*hall.light, goal);
  EXPECT_NEAR(lights.error(), (goal.lux - goal.fixed_lux).norm() / goal.lux.norm(), 1e-12);
  for (const LightPose& pose : poses) ASSERT_TRUE(lights.add(pose));
  EXPECT_NEAR(lights.levels()[0], 400, 1e-6);
  EXPECT_NEAR(lights.levels()[1], 400, 1e-6);
  goal.max_level = 350;
  lights.move(poses);
  EXPECT_LE(lights.levels().maxCoeff(), 350);
  EXPECT_EQ(lights.levels()[0], 350);
}

TEST(PlacedLights, KeepLuxAndPowerLimitsOptimally) {
  const LitHall hall(make_box_room(2), 0.5);
  Random random(8);
  for (int trial = 0; trial < 30; ++trial) {
    LightingGoal goal;
    goal.lux = Eigen::VectorXd::Constant(hall.light->points(), 300);
    goal.watts = Eigen::VectorXd::Constant(1, 0.01);
    PlacedLights free(*hall.light, goal);
    while (free.size() < 3) free.add({{random.between(0.3, 3.7), random.between(0.3, 2.7), random.between(1.5, 2.4)}});
    LightingGoal limited = goal;
    limited.max_lux = Eigen::VectorXd::Constant(goal.lux.size(), random.between(250, 900));
    limited.max_watts = random.between(0.5, 1.2) * free.watts();
    limited.fixed_lux = Eigen::VectorXd::Constant(goal.lux.size(), 20);
    PlacedLights lights(*hall.light, limited);
    for (const LightPose& pose : free.poses()) ASSERT_TRUE(lights.add(pose));
    const Eigen::VectorXd lux = lights.columns() * lights.levels() + limited.fixed_lux;
    EXPECT_LE((lux - limited.max_lux).maxCoeff(), 0);
    EXPECT_LE(lights.watts(), limited.max_watts);
    // No single level can change without breaking a limit or raising the error.
    for (Eigen::Index k = 0; k < lights.levels().size(); ++k)
      for (const double by : {-1e-3, 1e-3}) {
        Eigen::VectorXd other = lights.levels();
        other[k] = std::max(0.0, other[k] * (1 + by));
        const Eigen::VectorXd lit = lights.columns() * other + limited.fixed_lux;
        if ((lit - limited.max_lux).maxCoeff() > 0 || 0.01 * other.sum() > limited.max_watts) continue;
        EXPECT_GE((lit - limited.lux).norm(), (lux - limited.lux).norm() * (1 - 1e-9));
      }
  }
  // Existing light alone breaks the limit: nothing is added.
  LightingGoal broken;
  broken.lux = Eigen::VectorXd::Constant(hall.light->points(), 300);
  broken.fixed_lux = Eigen::VectorXd::Constant(hall.light->points(), 120);
  broken.max_lux = Eigen::VectorXd::Constant(hall.light->points(), 100);
  PlacedLights none(*hall.light, broken);
  ASSERT_TRUE(none.add({{2, 1.5, 2}}));
  EXPECT_EQ(none.levels().maxCoeff(), 0);
}

TEST(EnergyFront, ErrorsRiseAsPowerFallsAndEveryLimitIsKept) {
  const LitHall hall(make_box_room(2), 0.4);
  LightingGoal goal;
  goal.lux = Eigen::VectorXd::Constant(hall.light->points(), 300);
  goal.watts = Eigen::VectorXd::Constant(1, 0.01);
  const ComplementSearch candidates(hall.view(), hall.poses, goal);
  const Placement placed = place_lights(*hall.light, goal, candidates, place_count(3));
  const ExchangeOptions options;
  LightExchange exchange(candidates, options);
  std::vector<double> watts;
  for (const double share : {1.0, 0.8, 0.6, 0.4, 0.2, 0.0}) watts.push_back(share * placed.lights.watts());
  const auto front = energy_front(*hall.light, goal, placed.lights, watts, exchange, 2, 1);
  ASSERT_EQ(front.size(), watts.size());
  for (std::size_t i = 0; i < front.size(); ++i) {
    EXPECT_LE(front[i].lights.watts(), watts[i]);
    if (i > 0) {
      EXPECT_GE(front[i].lights.error(), front[i - 1].lights.error());
    }
  }
  EXPECT_LE(front[0].lights.error(), placed.lights.error() * (1 + 1e-9));
  EXPECT_EQ(front.back().lights.error(), 1);
  // Moving the lights pays: only dimming the placed ones is worse.
  LightingGoal dimmed = goal;
  dimmed.max_watts = watts[2];
  PlacedLights still(*hall.light, dimmed);
  for (const LightPose& pose : placed.lights.poses()) ASSERT_TRUE(still.add(pose));
  EXPECT_LT(front[2].lights.error(), still.error());
}

TEST(SceneLight, APanelActsAsAPointFromAfarAndAsASurfaceNearby) {
  const LitHall hall(empty_room(), 0.5);
  Emitter panel{make_cosine_power(1, 1), {}};
  const SceneLight point(*hall.transport, hall.room.receivers, panel);
  panel.shape = {LuminousShape::Kind::rectangle, {0.6, 0.6, 0}};
  SceneLightOptions options;
  options.rays = &hall.rays;
  const SceneLight surface(*hall.transport, hall.room.receivers, panel, options);
  Eigen::VectorXd of_point, of_surface;
  Eigen::MatrixXd slopes;
  ASSERT_TRUE(point.column({{2, 1.5, 40}}, of_point, nullptr));
  ASSERT_TRUE(surface.column({{2, 1.5, 40}}, of_surface, &slopes));
  EXPECT_LE((of_point - of_surface).norm(), 2e-3 * of_point.norm());
  ASSERT_TRUE(point.column({{2, 1.5, 2.3}}, of_point, nullptr));
  ASSERT_TRUE(surface.column({{2, 1.5, 2.3}}, of_surface, nullptr));
  EXPECT_GE((of_point - of_surface).norm(), 1e-3 * of_point.norm());
}

}  // namespace
}  // namespace luxrig
