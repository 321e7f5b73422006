/// sky_openings: accuracy over many samples.
#include <gtest/gtest.h>

#include <random>

#include "core/transport/sky/sky_openings.h"
#include "tests/core/transport/closed_forms.h"
#include "tests/core/transport/sky/room_with_windows.h"
#include "tests/core/transport/sky/sky_openings_fixture.h"

namespace luxrig {
namespace {

using namespace sky_openings_fixture;

// ∫ cosθ dω over the openings: by their samples, and on a fine grid of directions.
TEST(SkyOpenings, SamplesWithTheirDensityGiveTheFormFactor) {
  SkyOpening other = window();
  other.centre_world_m = {-1.7, 0.2, 1.9};
  const SkyOpenings openings({window(), other}, 0);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const Vec3& at_m : {Vec3(0, 2, 0.2), Vec3(-1, 0.7, 0.9), Vec3(1, 2.5, 1.0)}) {
    const Vec3 normal = Vec3(0.1, -0.5, 1).normalized();
    SkyOpenings::View view;
    openings.view(at_m, normal, view);
    ASSERT_TRUE(view.within);
    double sum = 0, squares = 0;
    constexpr int kSamples = 200'000;
    for (int i = 0; i < kSamples; ++i) {
      const DirectionSample drawn = openings.sample(view, at_m, unit(random), unit(random), unit(random));
      ASSERT_NEAR(openings.density_per_sr(view, at_m, drawn.direction), drawn.density_per_sr,
                  1e-6 * drawn.density_per_sr);
      // A direction that passes both openings counts once; its density includes both.
      const double value = std::max(0.0, normal.dot(drawn.direction)) / drawn.density_per_sr;
      sum += value, squares += value * value;
    }
    const double mean = sum / kSamples, error = std::sqrt((squares / kSamples - mean * mean) / kSamples);
    double expected = 0;  // midpoint rule over the directions of a fine grid
    constexpr int kZ = 1200, kTurn = 2400;
    for (int i = 0; i < kZ; ++i)
      for (int j = 0; j < kTurn; ++j) {
        const double height = (i + 0.5) / kZ, angle = 2 * kPi * (j + 0.5) / kTurn,
                     level = std::sqrt(1 - height * height);
        const Vec3 d(level * std::cos(angle), level * std::sin(angle), height);
        const bool passes = d.y() < 0 && (window().passed_by(at_m, d) || other.passed_by(at_m, d));
        if (passes) expected += std::max(0.0, normal.dot(d)) * 2 * kPi / kZ / kTurn;
      }
    EXPECT_NEAR(mean, expected, 4 * error + 1e-3 * expected);
  }
}

}  // namespace
}  // namespace luxrig
