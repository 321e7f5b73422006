#pragma once
/// Shared by the tests of gain_estimator.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>

#include "core/estimation/gain_estimator.h"
#include "core/output/output_program.h"

namespace luxrig::gain_estimator_fixture {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

inline constexpr double kTolerance = 0.04;

inline Time at_s(double seconds) { return Time{} + from_seconds(seconds); }

/// Twelve spots over a wall with six metered points and three unmetered ones. Points 0 and 1 have a limit. The truth
/// differs from the model: output −20…+5 %, exponent of the dimmer's curve 1.8…2.2 instead of the stated 2, every entry
/// of the matrix ±15 % (poses), meters off by up to their tolerance and 0.3 % of noise.
struct World {
  Rig rig;
  LightModel model;
  MatrixXd truth;
  VectorXd output, exponent, meter_scale;
  std::vector<double> plan;
  std::mt19937 random;

  VectorXd daylight_truth;  ///< per point [lx]

  /// daylight_share: largest daylight at a point, as a share of the light that the lights give there. The true daylight
  /// is 20 % less to 5 % more overall; single entries are off by wrong_entries, as for the lights.
  explicit World(unsigned seed, double wrong_entries = 0.15, double daylight_share = 0) : random(seed) {
    std::uniform_real_distribution<double> uniform;
    const Index fixtures = 12, meters = 6, points = 9;
    model.point_lux_per_level.resize(points, fixtures);
    for (Index j = 0; j < fixtures; ++j)
      for (Index i = 0; i < points; ++i) {
        const double metres = static_cast<double>(i) - (static_cast<double>(j) + uniform(random) - 0.5) * 0.75;
        model.point_lux_per_level(i, j) = 250 * std::exp(-metres * metres) + 5 * uniform(random);
      }
    model.meter_lux_per_level = model.point_lux_per_level.topRows(meters);
    truth = model.point_lux_per_level;
    for (double& entry : truth.reshaped()) entry *= 1 + wrong_entries * (2 * uniform(random) - 1);
    output.resize(fixtures);
    exponent.resize(fixtures);
    meter_scale.resize(meters);
    for (double& value : output) value = 0.8 + 0.25 * uniform(random);
    for (double& value : exponent) value = 0.9 + 0.2 * uniform(random);
    for (double& value : meter_scale) value = 1 + 0.95 * kTolerance * (2 * uniform(random) - 1);
    rig.fixtures.resize(static_cast<std::size_t>(fixtures));
    for (std::size_t j = 0; j < rig.fixtures.size(); ++j) rig.fixtures[j].name = "spot-" + std::to_string(j);
    rig.luxmeters.resize(static_cast<std::size_t>(meters));
    rig.points.resize(static_cast<std::size_t>(points));
    rig.control.gain_min = 0.6;
    rig.control.gain_max = 1.15;
    rig.limits.open_loop_margin = 0.25;
    VectorXd level(fixtures);
    for (double& value : level) value = 0.2 + 0.4 * uniform(random);
    VectorXd goal = model.point_lux_per_level * level;
    daylight_truth = VectorXd::Zero(points);
    if (daylight_share > 0) {
      const double overall = 0.8 + 0.25 * uniform(random);
      model.point_fixed_lx.resize(points);
      for (Index i = 0; i < points; ++i) {
        model.point_fixed_lx[i] = daylight_share * uniform(random) * goal[i];
        daylight_truth[i] = model.point_fixed_lx[i] * overall * (1 + wrong_entries * (2 * uniform(random) - 1));
      }
      model.meter_fixed_lx = model.point_fixed_lx.head(meters);
      goal += model.point_fixed_lx;
    }
    for (std::size_t i = 0; i < rig.points.size(); ++i) {
      rig.points[i].name = "p" + std::to_string(i);
      rig.points[i].goal_lx = goal[static_cast<Index>(i)];
      if (i < rig.luxmeters.size()) {
        rig.luxmeters[i].point = i;
        rig.luxmeters[i].tolerance = kTolerance;
      }
      if (i < 2) rig.points[i].max_lx = *rig.points[i].goal_lx / 0.9;
    }
    rig.points[8].max_lx = *rig.points[8].goal_lx * 1.1;
    plan.assign(level.data(), level.data() + fixtures);
  }

  [[nodiscard]] VectorXd true_lux(const std::vector<double>& level) const {
    VectorXd light(output.size());
    for (Index j = 0; j < output.size(); ++j)
      light[j] = output[j] * std::pow(level[static_cast<std::size_t>(j)], exponent[j]);
    return truth * light + daylight_truth;
  }

  std::vector<LuxReading> readings(const std::vector<double>& level, Time taken) {
    std::normal_distribution<double> noise(1, 0.003);
    const VectorXd lux = true_lux(level);
    std::vector<LuxReading> all;
    for (std::size_t i = 0; i < rig.luxmeters.size(); ++i) {
      const auto at = static_cast<Index>(i);
      all.push_back({i, std::round(lux[at] * meter_scale[at] * noise(random) * 1000) / 1000, taken});
    }
    return all;
  }

  /// Largest ratio of true lux to limit during the fade between two looks, as the output thread would send it.
  [[nodiscard]] double worst_share_of_limit(const GainEstimator& estimator, const std::vector<double>& from,
                                            const std::vector<double>& to, Time now, std::size_t points) const {
    const WorstCase worst = estimator.worst_case(from, to, now);
    double share = 0;
    for (int s = 0; s <= 20; ++s) {
      std::vector<double> level(from.size());
      for (std::size_t j = 0; j < level.size(); ++j) level[j] = from[j] + (to[j] - from[j]) * s / 20;
      scale_to_limits(worst.worst_lux_per_level, worst.max_lx, level);
      const VectorXd lux = true_lux(level);
      for (std::size_t i = 0; i < points; ++i)
        if (rig.points[i].max_lx) share = std::max(share, lux[static_cast<Index>(i)] / *rig.points[i].max_lx);
    }
    return share;
  }
};

struct Outcome {
  double worst_error = 0;        ///< of a metered reading against its goal
  double worst_error_aimed = 0;  ///< the same, but against the aimed value where a reason was given
  double max_share_metered = 0, max_share = 0;
  int rejected = 0;
};

using Spoil = std::function<void(int round, std::vector<LuxReading>&)>;

/// Fades up from dark, then reads and corrects `rounds` times.
inline Outcome run(World& world, int rounds, const Spoil& spoil = nullptr) {
  GainEstimator estimator(world.rig, world.model);
  Outcome outcome;
  double now_s = 0;
  const auto fade = [&](const std::vector<double>& from, const std::vector<double>& to) {
    for (const std::size_t points : {world.rig.luxmeters.size(), world.rig.points.size()}) {
      double& share = points == world.rig.points.size() ? outcome.max_share : outcome.max_share_metered;
      share = std::max(share, world.worst_share_of_limit(estimator, from, to, at_s(now_s), points));
    }
  };
  std::vector<double> level = estimator.within_limits(world.plan, at_s(0));
  fade(std::vector<double>(level.size(), 0), level);
  Correction last;
  for (int round = 0; round < rounds; ++round) {
    now_s += 2;
    std::vector<LuxReading> readings = world.readings(level, at_s(now_s));
    if (spoil) spoil(round, readings);
    for (const LuxReading& reading : readings) estimator.shows(reading, level);
    for (const Judgement& judgement : estimator.update(at_s(now_s), readings, level)) {
      outcome.rejected += !judgement.believed;
      EXPECT_EQ(judgement.believed, judgement.why.empty());
    }
    const Correction correction = estimator.correct(level, at_s(now_s));
    fade(level, correction.level);
    level = correction.level;
    last = correction;
  }
  const VectorXd lux = world.true_lux(level);
  for (std::size_t i = 0; i < world.rig.luxmeters.size(); ++i) {
    const auto at = static_cast<Index>(i);
    const double goal = *world.rig.points[i].goal_lx;
    const double error = std::abs(lux[at] * world.meter_scale[at] / goal - 1);
    outcome.worst_error = std::max(outcome.worst_error, error);
    const double aimed = last.why[i].empty() ? goal : last.aimed_lx[i];
    outcome.worst_error_aimed =
        std::max(outcome.worst_error_aimed, std::abs(lux[at] * world.meter_scale[at] / aimed - 1));
  }
  return outcome;
}

}  // namespace luxrig::gain_estimator_fixture
