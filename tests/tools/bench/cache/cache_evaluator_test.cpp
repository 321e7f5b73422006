// The cache as an Evaluator: the conformance tests, and when it stops.
#include "tests/core/transport/evaluator_conformance.h"
#include "tests/tools/bench/cache/cache_rooms.h"

namespace luxrig::conformance {
namespace {

constexpr Entry kCache = {"cache",
                          [](const Scene& scene, const RayScene& rays) { return make_cache_evaluator(scene, rays); }};

INSTANTIATE_TEST_SUITE_P(Bench, EvaluatorConformance, testing::Values(kCache), name_of);

TEST(CacheEvaluator, EndsEarlyWithItsResultAndThatResultsError) {
  const Scene scene = two_rooms(0.5);
  const RayScene rays(scene);
  Emitter ball = bulb_at({0.5, 0.5, 1.5});
  ball.shape = {LuminousShape::Kind::sphere, Vec3(0.2, 0, 0)};
  const std::vector<Receiver> receivers = {{{0.5, 1, 0.8}, Vec3::UnitZ()}, {{1.5, 1, 0.8}, Vec3::UnitX()}};
  std::stop_source enough;
  enough.request_stop();
  EvaluateOptions options;
  options.threads = 2;
  options.enough = enough.get_token();
  options.wanted_relative_error = 1e-4;
  options.max_rays = 1'000'000'000'000;
  const auto matrix = make_cache_evaluator(scene, rays)->evaluate(receivers, {&ball, 1}, options);
  ASSERT_TRUE(matrix) << matrix.error().detail;
  EXPECT_TRUE(matrix->lux_per_level.allFinite());
  EXPECT_GT(matrix->lux_per_level(0, 0), 10);
  EXPECT_GT(matrix->relative_error, 1e-4);
  EXPECT_GT(matrix->standard_error_lux(Eigen::VectorXd::Ones(1)).maxCoeff(), 0);
}

}  // namespace
}  // namespace luxrig::conformance
