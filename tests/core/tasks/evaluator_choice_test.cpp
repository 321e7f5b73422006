#include "core/tasks/evaluator_choice.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tools/bench/rooms/enclosures.h"

namespace luxrig {
namespace {

std::vector<Receiver> receivers_in_cube(std::size_t count) {
  std::vector<Receiver> receivers;
  for (const WallPoint& p : spread_over_walls(make_cube(2, 0.5), count, Vec3::Zero()))
    receivers.push_back({p.position_m, p.normal});
  return receivers;
}

const std::vector<Emitter> kBulb = {{make_isotropic(1000), {Mat3::Identity(), {0.2, 0.1, 0.3}}}};

/// Name of the evaluator chosen in a cube of one reflectance. The reason goes to the test's log.
std::string chosen(double reflectance, std::size_t receivers, double wanted) {
  const RayScene scene(make_cube(2, reflectance));
  EvaluateOptions options;
  options.wanted_relative_error = wanted;
  const auto choice = choose_evaluator(scene, receivers_in_cube(receivers), kBulb, options);
  EXPECT_TRUE(choice.has_value());
  if (!choice) return "";
  EXPECT_FALSE(choice->reason.empty());
  return std::string(choice->evaluator->name());
}

TEST(EvaluatorChoice, ABlackSceneNeedsNoPaths) {
  EXPECT_EQ(chosen(0, 5, 0.01), "direct");
  const RayScene open_air{Scene{}};
  EXPECT_EQ(choose_evaluator(open_air, receivers_in_cube(5), kBulb, {})->evaluator->name(), "direct");
}

TEST(EvaluatorChoice, ReflectedLightBelowTheWantedErrorIsIgnored) {
  EXPECT_EQ(chosen(0.002, 30, 0.05), "direct");
  EXPECT_NE(chosen(0.09, 30, 0.01), "direct") << "a tenth of the light is not below one per cent";
}

TEST(EvaluatorChoice, ManyPointsSharePathsUnlessTheErrorIsTooFine) {
  EXPECT_EQ(chosen(0.5, 100, 0.01), "gather");
  EXPECT_EQ(chosen(0.5, 100, 0.003), "gather") << "a standard error of 0.0012";
  EXPECT_EQ(chosen(0.5, 100, 0.001), "path");
  EXPECT_EQ(chosen(0.5, 3, 0.01), "path");
}

TEST(EvaluatorChoice, TheChosenEvaluatorKeepsTheWantedError) {
  const RayScene scene(make_cube(2, 0.05));
  const auto receivers = receivers_in_cube(40);
  EvaluateOptions reference;
  reference.wanted_relative_error = 0.002;
  const auto truth = make_path_evaluator(scene)->evaluate(receivers, kBulb, reference);
  ASSERT_TRUE(truth.has_value());
  for (const double wanted : {0.3, 0.03}) {
    EvaluateOptions options;
    options.wanted_relative_error = wanted;
    const auto choice = choose_evaluator(scene, receivers, kBulb, options);
    ASSERT_TRUE(choice.has_value());
    const auto matrix = choice->evaluator->evaluate(receivers, kBulb, options);
    ASSERT_TRUE(matrix.has_value());
    for (Eigen::Index r = 0; r < matrix->receivers(); ++r)
      EXPECT_NEAR(matrix->lux_per_level(r, 0), truth->lux_per_level(r, 0), wanted * truth->lux_per_level(r, 0));
  }
}

// Few rays decide whether reflected light matters, however small the final error over all receivers is to be.
TEST(EvaluatorChoice, NeedsOnlyAFewRaysEvenForASmallRmsError) {
  const RayScene scene(make_cube(2, 0.05));
  EvaluateOptions options;
  options.wanted_rms_error = 1e-7;
  std::stop_source soon;
  options.watch.stop = soon.get_token();
  std::jthread impatient([&](const std::stop_token& done) {
    for (int i = 0; i < 200 && !done.stop_requested(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    if (!done.stop_requested()) soon.request_stop();
  });
  EXPECT_TRUE(choose_evaluator(scene, receivers_in_cube(40), kBulb, options).has_value()) << "still at it after 10 s";
}

TEST(EvaluatorChoice, PassesFaultsOn) {
  const RayScene scene(make_cube(2, 0.05));
  EXPECT_FALSE(choose_evaluator(scene, std::vector<Receiver>{{{0.2, 0.1, 0.3}, Vec3::UnitZ()}}, kBulb, {}).has_value());
}

}  // namespace
}  // namespace luxrig
