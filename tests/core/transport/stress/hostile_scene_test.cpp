/// Ten thousand hostile scenes: for any mesh an evaluator ends and returns finite numbers.

#include "tests/core/transport/stress/hostile_scene.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>

#include "tests/core/transport/stress/hostile_scene_fixture.h"
#include "tests/sanitized.h"

namespace luxrig {
namespace {

using namespace hostile_scene_fixture;

/// Scenes per share. Sanitizers make each scene many times slower and check every access, so a hundredth is enough; the
/// test reports it. LUXRIG_ALL_SCENES runs all of them.
const int kScenes = test::kSanitized && std::getenv("LUXRIG_ALL_SCENES") == nullptr ? 10 : 1000;

bool fine(const Eigen::MatrixXd& matrix) { return matrix.allFinite() && (matrix.array() >= 0).all(); }

void expect_sound(const TransportMatrix& matrix, const HostileScene& made, const EvaluateOptions& options) {
  const Eigen::VectorXd levels = Eigen::VectorXd::Constant(matrix.emitters(), 0.5);
  ASSERT_EQ(matrix.receivers(), made.receivers.size());
  ASSERT_EQ(matrix.emitters(), made.emitters.size());
  ASSERT_TRUE(fine(matrix.lux_per_level)) << matrix.lux_per_level;
  ASSERT_TRUE(fine(matrix.direct_lux_per_level)) << matrix.direct_lux_per_level;
  for (const auto& replicate : matrix.replicates) ASSERT_TRUE(replicate.allFinite()) << replicate;
  ASSERT_TRUE(fine(matrix.standard_error_lux(levels)));
  ASSERT_TRUE(std::isfinite(matrix.relative_error) && matrix.relative_error >= 0);
  // Direct light is part of the total.
  const double slack = 1e-9 * (matrix.direct_lux_per_level.maxCoeff() + matrix.lux_per_level.maxCoeff());
  ASSERT_GE((matrix.lux_per_level - matrix.direct_lux_per_level).minCoeff(), -slack);
  if (options.colour && !matrix.rgb_per_level.empty()) {
    const Eigen::MatrixXd sum =
        0.2126 * matrix.rgb_per_level[0] + 0.7152 * matrix.rgb_per_level[1] + 0.0722 * matrix.rgb_per_level[2];
    for (const auto& channel : matrix.rgb_per_level) ASSERT_TRUE(channel.allFinite());
    ASSERT_LE((sum - matrix.lux_per_level).cwiseAbs().maxCoeff(), 1e-6 * matrix.lux_per_level.maxCoeff());
  }
}

/// One share of the scenes, so that several processors can work in parallel.
class HostileShare : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(OfTen, HostileShare, testing::Range(0, 10));

TEST_P(HostileShare, OfScenesGivesNoNaNNegativeOrInfiniteLight) {
  if (kScenes < 1000) std::cout << kScenes << " of 1000 scenes, as sanitizers slow them\n";
  int asked = 0, refused = 0;
  for (int i = 0; i < kScenes; ++i) {
    const auto seed = static_cast<std::uint64_t>(GetParam() * 1000 + i);
    SCOPED_TRACE("seed " + std::to_string(seed));
    const HostileScene made = HostileScenes(seed).next();
    const RayScene rays(made.scene);
    const EvaluateOptions options = few_rays(made, seed, 1);
    std::optional<Eigen::MatrixXd> direct_lx;
    for (const Entry& entry : kEvaluators) {
      // Direct light runs on every scene, path and gather on alternate ones: they take 5 ms each.
      if (entry.make != make_direct_evaluator && (entry.make == make_path_evaluator) != (i % 2 == 0)) continue;
      SCOPED_TRACE(entry.name);
      ++asked;
      const auto matrix = entry.make(rays)->evaluate(made.receivers, made.emitters, options);
      if (!matrix) {
        ASSERT_EQ(matrix.error().cause, Cause::invalid) << matrix.error().detail;
        ASSERT_TRUE(made.may_be_refused) << matrix.error().detail;
        ++refused;
        continue;
      }
      expect_sound(*matrix, made, options);
      if (HasFatalFailure()) return;
      // Direct light of a point lamp is the same from any evaluator.
      if (made.sized) continue;
      if (!direct_lx) direct_lx = matrix->direct_lux_per_level;
      ASSERT_LE((*direct_lx - matrix->direct_lux_per_level).cwiseAbs().maxCoeff(), 1e-9 * direct_lx->maxCoeff());
    }
  }
  // At most a quarter of a thousand scenes may be refused, or the test would prove little. With ten scenes at least one
  // result is required.
  if (kScenes == 1000) {
    EXPECT_LE(refused, asked / 4);
  }
  EXPECT_LT(refused, asked);
}

}  // namespace
}  // namespace luxrig
