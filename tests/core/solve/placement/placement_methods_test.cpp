#include "core/solve/placement/placement_methods.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/rig/rig.h"
#include "core/solve/placement/methods/anneal_candidates.h"
#include "core/solve/placement/methods/simplex_refine.h"
#include "core/solve/placement/number_of_lights.h"
#include "tests/core/solve/placement/lit_hall.h"
#include "tests/core/solve/placement/placement_methods_fixture.h"
#include "tools/bench/methods/compared_methods.h"

namespace luxrig {
namespace {

using namespace placement_methods_fixture;

TEST(PlacementMethods, AreFoundByName) {
  for (const PlacementMethod& method : compared_methods()) EXPECT_EQ(find_compared_method(method.name), &method);
  EXPECT_EQ(find_compared_method("gpk16"), nullptr);
  for (const PlacementMethod& method : placement_methods()) EXPECT_EQ(find_placement_method(method.name), &method);
  EXPECT_EQ(find_placement_method("lin2013"), nullptr) << "only compared with";
}

TEST(PlacementMethods, ChooseTheNumberOfLightsIfTheyCan) {
  const LitHall hall(make_box_room(3), kHallLattice_m);
  const LightingGoal goal = hall.goal_of({{0.9, 0.8, 2.1}, {3.1, 2.2, 1.9}, {2.2, 1.4, 2.3}}, {800, 500, 300});
  for (const PlacementMethod& method : compared_methods()) {
    PlacementOptions options = options_of(method, 0);
    options.lights = 0;
    options.max_columns = 6000;
    const auto got = method.run(problem_of(hall, goal), options);
    ASSERT_EQ(got.has_value(), method.chooses_number) << method.name;
    if (!got) {
      EXPECT_EQ(got.error().cause, Cause::invalid);
      continue;
    }
    EXPECT_GE(got->lights.size(), 2u) << method.name;
    EXPECT_LE(got->lights.size(), 8u) << method.name;
    EXPECT_LE(got->lights.error(), 0.25) << method.name;
    for (std::size_t i = 1; i < got->tree.size(); ++i) EXPECT_GT(got->tree[i].first, got->tree[i - 1].first);
  }
}

TEST(PlacementMethods, MoreStartsAreNeverWorse) {
  const LitHall hall(make_box_room(1), kHallLattice_m);
  const LightingGoal goal{Eigen::VectorXd::Constant(hall.light->points(), 200), {}};
  for (const char* name : {"gpk15", "annealing"}) {
    PlacementOptions options;
    options.lights = 3;
    options.iterations = 100;
    options.max_columns = 300;
    const auto one = find_compared_method(name)->run(problem_of(hall, goal), options);
    options.starts = 4;
    options.max_columns *= 4;
    const auto four = find_compared_method(name)->run(problem_of(hall, goal), options);
    EXPECT_LE(four->lights.error(), one->lights.error()) << name;
    EXPECT_GT(four->columns, one->columns) << name;
  }
}

TEST(PlacementMethods, ReportImprovementsAndEndWhenStopped) {
  const LitHall hall(make_box_room(1), kHallLattice_m);
  const LightingGoal goal{Eigen::VectorXd::Constant(hall.light->points(), 200), {}};
  for (const PlacementMethod& method : compared_methods()) {
    std::stop_source stop;
    PlacementOptions options = options_of(method, 3);
    options.number.wanted_error = 0;
    options.starts = 1000;  // more than a test has time for
    options.max_columns = 1'000'000'000;
    options.iterations = 100;
    options.watch.stop = stop.get_token();
    double last = std::numeric_limits<double>::infinity();
    int told = 0;
    options.better = [&](const BestSoFar& best) {
      EXPECT_LT(best.error, last);
      EXPECT_EQ(best.levels.size(), static_cast<Eigen::Index>(best.poses.size()));
      last = best.error;
      if (++told == 2) stop.request_stop();
    };
    const auto got = method.run(problem_of(hall, goal), options);
    ASSERT_TRUE(got.has_value()) << method.name;
    EXPECT_GE(told, 2) << method.name;
    EXPECT_LE(got->lights.error(), 1) << method.name;

    options.better = {};  // stopped before it begins
    const auto nothing = method.run(problem_of(hall, goal), options);
    ASSERT_TRUE(nothing.has_value()) << method.name;
    EXPECT_TRUE(nothing->lights.levels().allFinite()) << method.name;
  }
}

TEST(PlacementMethods, HandleExtremeInput) {
  const LitHall hall(make_box_room(1), kHallLattice_m);
  const Eigen::Index points = hall.light->points();
  const LightingGoal uniform{Eigen::VectorXd::Constant(points, 200), {}};
  const LightingGoal zero{Eigen::VectorXd::Zero(points), {}};
  LightingGoal bounded = uniform, too_bright = uniform, nothing_counts = uniform, off = uniform;
  bounded.max_level = 10;
  off.max_level = 0;
  too_bright.fixed_lux = Eigen::VectorXd::Constant(points, 500);
  nothing_counts.row_weight = Eigen::VectorXd::Zero(points);
  // The whole lattice, one candidate, one that lights nothing, the same one five times, none.
  const std::vector<std::uint64_t> dark_begin = {0, 0}, none_begin = {0};
  const std::vector<std::uint32_t> no_rows;
  const std::vector<float> no_lux;
  const auto lit = static_cast<std::size_t>(
      std::max_element(hall.columns.begin.begin() + 1, hall.columns.begin.end(), std::less<>()) -
      hall.columns.begin.begin() - 1);
  Eigen::VectorXd lux;
  const LightPose middle = {{2, 1.5, 2.2}};
  ASSERT_TRUE(hall.light->column(middle, lux, nullptr));
  ASSERT_LT(lit, hall.poses.size());
  const Eigen::MatrixXd one = lux, five = lux.replicate(1, 5);
  const std::vector<std::pair<ColumnsView, std::vector<LightPose>>> sets = {
      {hall.view(), hall.poses},
      {ColumnsView(one), {middle}},
      {ColumnsView(points, dark_begin, no_rows, no_lux), {{{100, 100, 100}}}},
      {ColumnsView(five), std::vector<LightPose>(5, middle)},
      {ColumnsView(points, none_begin, no_rows, no_lux), {}}};
  for (const PlacementMethod& method : compared_methods())
    for (const LightingGoal& goal : {uniform, zero, bounded, too_bright, nothing_counts, off})
      for (const auto& [columns, poses] : sets) {
        PlacementOptions options = options_of(method, 2);
        options.max_columns = 100;
        options.iterations = 50;
        const auto got = method.run({hall.light.get(), &goal, columns, poses, kHallLattice_m}, options);
        ASSERT_TRUE(got.has_value()) << method.name << ": " << got.error().detail;
        const PlacedLights& lights = got->lights;
        EXPECT_TRUE(std::isfinite(lights.error())) << method.name;
        EXPECT_TRUE(lights.levels().allFinite()) << method.name;
        EXPECT_TRUE((lights.levels().array() >= 0).all()) << method.name;
        EXPECT_TRUE((lights.levels().array() <= goal.max_level).all()) << method.name;
        EXPECT_LE(lights.size(), 8u) << method.name;
        if (goal.lux.isZero()) {
          EXPECT_EQ(lights.error(), 0) << method.name;
        }
      }
}

TEST(PlacementMethods, ReportInvalidInput) {
  const LitHall hall(make_box_room(1), 0.5);
  const Eigen::Index points = hall.light->points();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const LightingGoal sound{Eigen::VectorXd::Constant(points, 200), {}};
  LightingGoal not_a_number = sound, too_few = sound, weights_too_few = sound;
  not_a_number.lux[0] = nan;
  too_few.lux.conservativeResize(points - 1);
  weights_too_few.row_weight = Eigen::VectorXd::Ones(points - 1);
  PlacementOptions options;
  options.lights = 2;
  for (const PlacementMethod& method : compared_methods()) {
    for (const LightingGoal& goal : {not_a_number, too_few, weights_too_few}) {
      const auto got = method.run(problem_of(hall, goal), options);
      ASSERT_FALSE(got.has_value()) << method.name;
      EXPECT_EQ(got.error().cause, Cause::invalid);
      EXPECT_FALSE(got.error().detail.empty());
    }
    PlacementProblem lost = problem_of(hall, sound);
    lost.poses.pop_back();
    EXPECT_FALSE(method.run(lost, options).has_value()) << method.name;
    lost = problem_of(hall, sound);
    lost.spacing_m = 0;
    EXPECT_FALSE(method.run(lost, options).has_value()) << method.name;
  }
}

TEST(AnnealCandidates, NeverEndsWorseThanItStarted) {
  const LitHall hall(make_box_room(2), kHallLattice_m);
  const LightingGoal goal{Eigen::VectorXd::Constant(hall.light->points(), 200), {}};
  const PlacementProblem problem = problem_of(hall, goal);
  const auto candidates = *CandidateLights::make(problem);
  for (const std::size_t nearest : {0u, 1u, 12u})
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      std::mt19937_64 random(seed);
      ChosenCandidates start(candidates);
      start.choose(drawn_candidates(*candidates, 3, random));
      AnnealOptions options;
      options.iterations = 60;
      options.nearest = nearest;
      options.hottest = 10;  // accepts nearly every move
      const ChosenCandidates end = anneal(start, options, random);
      EXPECT_LE(end.error(), start.error());
      EXPECT_EQ(end.size(), 3u);
      std::size_t columns = 0;
      EXPECT_NEAR(end.placed(columns).error(), end.error(), 1e-5);  // candidates' columns are floats
      EXPECT_EQ(columns, 3u);
    }
}

TEST(CandidateLights, NearestMatchesAnExhaustiveComparison) {
  const LitHall hall(make_box_room(2), kHallLattice_m);
  LightingGoal goal{Eigen::VectorXd::Constant(hall.light->points(), 200), {}};
  goal.row_weight = Eigen::VectorXd::LinSpaced(goal.lux.size(), 0.5, 2);
  const PlacementProblem problem = problem_of(hall, goal);
  const auto candidates = *CandidateLights::make(problem);
  std::mt19937_64 random(1);
  ChosenCandidates chosen(candidates);
  chosen.choose(drawn_candidates(*candidates, 3, random));
  const Eigen::VectorXd residual = chosen.residual();
  const Eigen::VectorXd unit = goal.weighted(residual).normalized();
  std::vector<std::pair<double, std::size_t>> all;  // by distance between unit vectors
  for (std::size_t c = 0; c < hall.poses.size(); ++c) {
    Eigen::VectorXd lux = Eigen::VectorXd::Zero(residual.size());
    hall.view().add(static_cast<Eigen::Index>(c), 1, lux.data());
    if (lux.norm() > 0) all.emplace_back((goal.weighted(lux).normalized() - unit).norm(), c);
  }
  std::sort(all.begin(), all.end());
  EXPECT_EQ(all.size(), candidates->lit().size());
  const auto found = candidates->nearest(residual, 10);
  ASSERT_EQ(found.size(), 10u);
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i], all[i].second) << i;
}

TEST(PlacementMethods, OfARigFileAllExist) {
  for (int i = 0; i <= static_cast<int>(PlacementSearch::gp16); ++i) {
    const char* name = name_of(static_cast<PlacementSearch>(i));
    EXPECT_NE(find_placement_method(name), nullptr) << name;
  }
}

TEST(NumberOfLights, IsTheFewestThatSufficeOrBeyondWhichMoreHardlyHelp) {
  const auto chosen = [](const std::vector<double>& errors, double coarse_error) {
    return fewest_worth_it(errors.size(), [&](std::size_t k) { return errors[k]; }, {1e-3, 0.1, coarse_error});
  };
  EXPECT_EQ(chosen({}, 1), 0u);
  EXPECT_EQ(chosen({1}, 1), 0u);
  EXPECT_EQ(chosen({1, 0.5, 1e-3, 1e-5}, 1), 2u);
  EXPECT_EQ(chosen({1, 0.5, 0.48, 0.47, 0.1}, 1), 1u);
  EXPECT_EQ(chosen({1, 0.5, 0.48, 0.3, 0.29, 0.28}, 1), 3u) << "one of the next two helps";
  EXPECT_EQ(chosen({1, 0.95, 0.9, 0.2, 0.19, 0.185}, 0.3), 3u) << "little is enough where the error is coarse";
}

TEST(SimplexRefine, StaysWithinACellAndLowersTheError) {
  const LitHall hall(make_box_room(3), kHallLattice_m);
  const Vec3 place_m(2.2, 1.4, 2.2);
  const LightingGoal goal = hall.goal_of({place_m}, {500});
  PlacedLights start(*hall.light, goal);
  ASSERT_TRUE(start.add({place_m + Vec3(0.1, -0.07, 0.05)}));
  SimplexOptions options;
  options.cell_m = 0.2;
  options.wanted_error = 1e-3;
  PlacedLights hybrid = start, joint = start, by_subplex = start;
  EXPECT_GT(refine_by_simplex(hybrid, options), 0u);
  EXPECT_GT(refine_with_levels_by_simplex(joint, *hall.light, goal, options), 0u);
  options.subplex = true;
  EXPECT_GT(refine_by_simplex(by_subplex, options), 0u);
  for (const PlacedLights& lights : {hybrid, joint, by_subplex}) {
    EXPECT_LE(lights.error(), 0.01);
    EXPECT_LE((lights.poses()[0].position_world_m - place_m).norm(), 0.01);
  }
  options.cell_m = 0.02;  // too small to reach it
  PlacedLights held = start;
  refine_by_simplex(held, options);
  EXPECT_LT(held.error(), start.error());
  EXPECT_LE((held.poses()[0].position_world_m - start.poses()[0].position_world_m).cwiseAbs().maxCoeff(), 0.02 + 1e-12);
}

}  // namespace
}  // namespace luxrig
