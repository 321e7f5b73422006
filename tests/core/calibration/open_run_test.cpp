#include "core/calibration/open_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kLamps = 12, kMeters = 4;

Rig rig_of() {
  Rig rig;
  rig.fixtures.resize(kLamps);
  rig.luxmeters.resize(kMeters);
  rig.points.resize(3);
  return rig;
}

/// Runs it under clouds and noise; somebody shades meter 1 now and then.
std::vector<LightReading> measured(const Rig& rig, const std::vector<double>& look, const MatrixXd& light, int rounds,
                                   double noise, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  OpenRun run(rig, look, rounds);
  for (std::size_t step = 0; step < run.plan().size(); ++step) {
    const std::vector<double>& level = run.plan()[step];
    const double cloud_lx = 80 + 40 * std::sin(0.002 * static_cast<double>(step));
    VectorXd lux = light * Eigen::Map<const VectorXd>(level.data(), kLamps);
    std::vector<std::optional<SteadyReading>> readings;
    for (std::size_t m = 0; m < kMeters; ++m) {
      const double shade = m == 1 && step % 37 == 5 ? 0.6 : 1;
      const double shown = shade * lux[static_cast<Index>(m)] + cloud_lx;
      readings.push_back(SteadyReading{shown * (1 + noise * normal(random)), noise * shown});
    }
    if (step % 50 == 7) readings[2].reset();
    run.take(level, readings);
  }
  return run.readings(std::vector<LampCurve>(kLamps));
}

MatrixXd some_light(unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit;
  MatrixXd light(kMeters, kLamps);
  for (double& lux : light.reshaped()) lux = 10 + 20 * unit(random);
  for (Index j = 0; j < static_cast<Index>(kLamps); ++j) light(j % static_cast<Index>(kMeters), j) += 300;
  return light;
}

TEST(OpenRun, NoLampChangesByMoreThanAHairAndNoneThatIsOffLights) {
  Rig rig = rig_of();
  rig.fixtures[3].max_level = 0.5;
  rig.fixtures[4].switched = true;
  std::vector<double> look(kLamps, 0.6);
  look[3] = 0.5;
  look[4] = 1;
  look[7] = 0;
  const OpenRun run(rig, look, 2);
  EXPECT_EQ(run.period(), 16u);
  ASSERT_EQ(run.plan().size(), 32u);
  for (std::size_t step = 0; step < run.plan().size(); ++step)
    for (std::size_t f = 0; f < kLamps; ++f) {
      const double level = run.plan()[step][f], before = step > 0 ? run.plan()[step - 1][f] : look[f];
      EXPECT_LE(std::abs(level - before), OpenRun::kLargestStep * 1.001 * look[f]);
      EXPECT_LE(level, rig.max_level(rig.fixtures[f]) + 1e-12);
      if (f == 4 || f == 7) {
        EXPECT_EQ(level, look[f]);
      }
    }
}

TEST(OpenRun, WithoutNoiseItFindsEachLampsLightExactly) {
  const Rig rig = rig_of();
  const MatrixXd light = some_light(1);
  std::vector<double> look(kLamps, 0.5);
  OpenRun run(rig, look, 2);
  for (const auto& level : run.plan()) {
    const VectorXd lux = light * Eigen::Map<const VectorXd>(level.data(), kLamps);
    std::vector<std::optional<SteadyReading>> readings;
    for (std::size_t m = 0; m < kMeters; ++m) readings.push_back(SteadyReading{lux[static_cast<Index>(m)] + 70, 0.1});
    run.take(level, readings);
  }
  const auto found = run.readings(std::vector<LampCurve>(kLamps));
  ASSERT_EQ(found.size(), kLamps * kMeters);
  for (const LightReading& reading : found) {
    Index lamp = 0;
    EXPECT_NEAR(reading.level.maxCoeff(&lamp), 0.5, 1e-12);
    EXPECT_NEAR(reading.lux, 0.5 * light(static_cast<Index>(reading.meter), lamp), 1e-6);
  }
}

TEST(OpenRun, HalfAnHourIsEnoughThroughCloudsAndPeopleAndItsErrorsAreTrue) {
  const Rig rig = rig_of();
  double chi_squared = 0, worst = 0;
  int count = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const MatrixXd light = some_light(seed);
    const std::vector<double> look(kLamps, 0.5);
    // 40 rounds of 16 steps of 2.8 s; a reading of a meter that scatters by 0.3 %.
    for (const LightReading& reading : measured(rig, look, light, 40, 0.003, seed)) {
      Index lamp = 0;
      reading.level.maxCoeff(&lamp);
      const double truth = 0.5 * light(static_cast<Index>(reading.meter), lamp);
      chi_squared += std::pow((reading.lux - truth) / reading.standard_error_lx, 2);
      ++count;
      if (truth > 100) worst = std::max(worst, std::abs(reading.lux / truth - 1));
    }
  }
  EXPECT_EQ(count, static_cast<int>(20 * kLamps * kMeters));
  EXPECT_NEAR(chi_squared / count, 1, 0.25);
  EXPECT_LT(worst, 0.15);
}

TEST(OpenRun, OfNothingItSaysNothing) {
  const Rig rig = rig_of();
  const std::vector<double> dark(kLamps, 0.0);
  EXPECT_TRUE(OpenRun(rig, dark, 4).plan().empty());
  EXPECT_TRUE(OpenRun(rig, dark, 4).readings(std::vector<LampCurve>(kLamps)).empty());
  const std::vector<double> look(kLamps, 0.5);
  OpenRun gone(rig, look, 2);
  const std::vector<std::optional<SteadyReading>> none(kMeters);
  for (const auto& level : gone.plan()) gone.take(level, none);
  EXPECT_TRUE(gone.readings(std::vector<LampCurve>(kLamps)).empty());
}

}  // namespace
}  // namespace luxrig
