// When evaluators may stop: the error is small enough in lux, or the user has waited long enough.
#include "core/transport/error_floor.h"

#include <gtest/gtest.h>

#include "core/tasks/rig_transport.h"
#include "tests/core/transport/boxes.h"

namespace luxrig {
namespace {

/// Two rooms of 4 x 4 x 3 m joined by a door that few paths from the lamp in the first pass.
struct TwoRooms {
  TwoRooms() {
    scene.materials.resize(1);
    scene.materials[0].reflectance_rgb.setConstant(0.5);
    add_box(scene, {0, 0, 0}, {8, 4, 3});
    add_box(scene, {4, 0, 0}, {4.1, 3.9, 3});
    rays = std::make_unique<RayScene>(scene);
    emitters.push_back({make_isotropic(1000), {Mat3::Identity(), Vec3(0.5, 0.5, 2.5)}});
    for (int i = 0; i < 6; ++i) receivers.push_back({Vec3(0.5 + 0.5 * i, 2, 0.8), Vec3::UnitZ()});
    receivers.push_back({Vec3(7.5, 0.5, 0.8), Vec3::UnitX()});
    options.threads = 2;
    options.max_rays = 5'000'000;
  }
  Scene scene;
  std::unique_ptr<RayScene> rays;
  std::vector<Emitter> emitters;
  std::vector<Receiver> receivers;
  EvaluateOptions options;
};

TEST(ErrorFloor, IsTheMaximumOfFixedFloorMeanShareAndPeakShare) {
  EvaluateOptions options;
  const std::vector<double> lux = {0, 100, 500};
  EXPECT_DOUBLE_EQ(error_floor_lx(options, lux), 0.5);
  options.floor_of_mean = 0.1;
  EXPECT_DOUBLE_EQ(error_floor_lx(options, lux), 20);
  options.floor_lx = 30;
  EXPECT_DOUBLE_EQ(error_floor_lx(options, lux), 30);
  EXPECT_DOUBLE_EQ(error_floor_lx(options, {}), 30);
}

TEST(ErrorFloor, DerivesFromTheSmallestGoalOrLimitElseTheMean) {
  Rig rig;
  rig.points.resize(3);
  EvaluateOptions options;
  set_error_floor(rig, options);
  EXPECT_EQ(options.floor_lx, 0);
  EXPECT_EQ(options.floor_of_mean, 0.1);
  rig.points[0].goal_lx = 300;
  rig.points[1].max_lx = 50;
  rig.points[2].goal_lx = 0;
  set_error_floor(rig, options);
  EXPECT_EQ(options.floor_lx, 5);
  EXPECT_EQ(options.floor_of_mean, 0);
}

TEST(ErrorFloor, ANearlyDarkPointIsCheapAndWithinTheFloor) {
  TwoRooms rooms;
  const auto path = make_path_evaluator(*rooms.rays);
  const auto without = path->evaluate(rooms.receivers, rooms.emitters, rooms.options);
  rooms.options.floor_lx = 5;
  const auto with = path->evaluate(rooms.receivers, rooms.emitters, rooms.options);
  ASSERT_TRUE(without && with);
  EXPECT_LT(3 * with->rays, without->rays);
  EXPECT_EQ(with->floor_lx, 5);
  EXPECT_LE(with->relative_error, 0.01);
  const Eigen::VectorXd error = with->standard_error_lux(Eigen::VectorXd::Ones(1));
  for (Eigen::Index r = 0; r < 7; ++r) EXPECT_LE(error[r], 0.01 * std::max(5.0, with->lux_per_level(r, 0))) << r;
  EXPECT_GT(error[6], 0.01 * with->lux_per_level(6, 0)) << "it is known less closely, and says so";
}

TEST(Enough, EndsEveryEvaluatorWithItsResultAndThatResultsError) {
  TwoRooms rooms;
  rooms.emitters[0].shape = {LuminousShape::Kind::sphere, Vec3(0.2, 0, 0)};
  std::stop_source enough;
  enough.request_stop();
  rooms.options.enough = enough.get_token();
  rooms.options.wanted_relative_error = 1e-4;
  rooms.options.max_rays = 1'000'000'000'000;
  for (const auto& evaluator :
       {make_direct_evaluator(*rooms.rays), make_path_evaluator(*rooms.rays), make_gather_evaluator(*rooms.rays)}) {
    const auto matrix = evaluator->evaluate(rooms.receivers, rooms.emitters, rooms.options);
    ASSERT_TRUE(matrix) << evaluator->name() << ": " << matrix.error().detail;
    EXPECT_TRUE(matrix->lux_per_level.allFinite());
    EXPECT_GT(matrix->lux_per_level(0, 0), 10) << evaluator->name();
    if (evaluator->name() == "direct") continue;
    EXPECT_GT(matrix->relative_error, 1e-4) << evaluator->name();
    const Eigen::VectorXd error = matrix->standard_error_lux(Eigen::VectorXd::Ones(1));
    EXPECT_GT(error.maxCoeff(), 0) << evaluator->name();
  }
}

TEST(Enough, MidwayGivesAResultThatAgreesWithTheFullOne) {
  TwoRooms rooms;
  const auto path = make_path_evaluator(*rooms.rays);
  rooms.options.floor_lx = 5;
  const auto full = path->evaluate(rooms.receivers, rooms.emitters, rooms.options);
  std::stop_source enough;
  EvaluateOptions halfway = rooms.options;
  halfway.wanted_relative_error = 1e-3;
  halfway.max_rays = 1'000'000'000'000;
  halfway.enough = enough.get_token();
  int reports = 0;
  halfway.watch.progress = [&](double) {
    if (++reports == 3) enough.request_stop();
  };
  const auto part = path->evaluate(rooms.receivers, rooms.emitters, halfway);
  ASSERT_TRUE(full && part);
  EXPECT_GT(part->relative_error, 1e-3);
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  const Eigen::VectorXd difference = (full->lux(one) - part->lux(one)).cwiseAbs();
  const Eigen::VectorXd error = full->standard_error_lux(one) + part->standard_error_lux(one);
  // Far below the floor few paths find light at all, and their spread is a poor estimate of the error.
  const double below_floor_lx = 1e-3 * rooms.options.floor_lx;
  for (Eigen::Index r = 0; r < difference.size(); ++r)
    EXPECT_LT(difference[r], std::max(4 * error[r], below_floor_lx)) << r;
}

}  // namespace
}  // namespace luxrig
