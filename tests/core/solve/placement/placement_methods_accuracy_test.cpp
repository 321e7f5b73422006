/// placement_methods: accuracy over many samples.
#include <gtest/gtest.h>

#include <string>

#include "tests/core/solve/placement/lit_hall.h"
#include "tests/core/solve/placement/placement_methods_fixture.h"
#include "tools/bench/methods/compared_methods.h"

namespace luxrig {
namespace {

using namespace placement_methods_fixture;

/// ‖A x + f − b‖ / ‖b‖, computed only from the poses and levels.
double error_from_scratch(const LitHall& hall, const LightingGoal& goal, const PlacedLights& lights) {
  Eigen::VectorXd rest = goal.lux, lux;
  if (goal.fixed_lux.size() > 0) rest -= goal.fixed_lux;
  for (std::size_t k = 0; k < lights.size(); ++k) {
    EXPECT_TRUE(hall.light->column(lights.poses()[k], lux, nullptr));
    const auto emitters = goal.emitters.cols();
    for (Eigen::Index e = 0; e < emitters; ++e)
      for (Eigen::Index c = 0; c < goal.channels(); ++c)
        rest.segment(c * lux.size(), lux.size()) -=
            lights.levels()[static_cast<Eigen::Index>(k) * emitters + e] * goal.emitters(c, e) * lux;
  }
  return rest.norm() / goal.lux.norm();
}

TEST(PlacementMethods, FindKnownLightsWithinTheirStatedErrors) {
  const LitHall hall(make_box_room(3), kHallLattice_m);
  const LightingGoal goal = hall.goal_of({{0.9, 0.8, 2.1}, {3.1, 2.2, 1.9}, {2.2, 1.4, 2.3}}, {800, 500, 300});
  // Annealing runs from one start: draws differ between compilers, and some end higher. No light is at a candidate:
  // methods that move lights come near, the others stay on the lattice.
  const std::vector<std::pair<std::string, double>> reached = {
      {"luxrig", 1e-4},       {"gpk15", 0.06},   {"gp16", 0.06},      {"gpk15-subplex", 0.06},
      {"gp16-subplex", 0.06}, {"lin2013", 0.15}, {"annealing", 0.06}, {"pursuit", 0.2}};
  ASSERT_EQ(reached.size(), compared_methods().size());
  for (const auto& [name, error] : reached) {
    const PlacementMethod& method = *find_compared_method(name);
    const auto got = method.run(problem_of(hall, goal), options_of(method, 3));
    ASSERT_TRUE(got.has_value()) << name;
    EXPECT_EQ(got->lights.size(), 3u) << name;
    EXPECT_LE(got->lights.error(), error) << name;
    EXPECT_NEAR(got->lights.error(), error_from_scratch(hall, goal, got->lights), 1e-9) << name;
  }
}

TEST(PlacementMethods, ReachColourGoals) {
  // Red, green and blue emitters in each light, some existing light.
  const LitHall hall(make_box_room(3), kHallLattice_m);
  const Eigen::Index points = hall.light->points();
  LightingGoal goal;
  goal.emitters = Eigen::Matrix3d::Identity();
  goal.lux = Eigen::VectorXd::Zero(3 * points);
  Eigen::VectorXd lux;
  ASSERT_TRUE(hall.light->column({{0.9, 0.8, 2.1}}, lux, nullptr));
  goal.lux.head(points) = 300 * lux;
  goal.lux.segment(points, points) = 100 * lux;
  ASSERT_TRUE(hall.light->column({{3.1, 2.2, 1.9}}, lux, nullptr));
  goal.lux.tail(points) = 200 * lux;
  goal.fixed_lux = Eigen::VectorXd::Constant(3 * points, 1);
  for (const PlacementMethod& method : compared_methods()) {
    PlacementOptions options = options_of(method, 2);
    options.max_columns = 1000;
    options.iterations = 300;
    const auto got = method.run(problem_of(hall, goal), options);
    ASSERT_TRUE(got.has_value()) << method.name;
    EXPECT_LE(got->lights.error(), 0.3) << method.name;
    EXPECT_NEAR(got->lights.error(), error_from_scratch(hall, goal, got->lights), 1e-9) << method.name;
    EXPECT_TRUE((got->lights.levels().array() >= 0).all()) << method.name;
  }
}

}  // namespace
}  // namespace luxrig
