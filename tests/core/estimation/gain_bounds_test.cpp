// A lamp that gives more, or less, than its stated error and the rig's bounds let the estimator believe.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/estimation/gain_estimator.h"

namespace luxrig {
namespace {

using Eigen::MatrixXd;

Time at_s(double seconds) { return Time{} + from_seconds(seconds); }

/// One lamp, two places; the first has a luxmeter.
struct OneLamp {
  Rig rig;
  LightModel model;
  OneLamp() {
    rig.fixtures.resize(1);
    rig.luxmeters.resize(1);
    rig.points.resize(2);
    rig.luxmeters[0].point = 0;
    rig.luxmeters[0].tolerance = 0.03;
    rig.control.gain_min = 0.6;
    rig.control.gain_max = 1.15;
    rig.limits.open_loop_margin = 0.1;
    model.meter_lux_per_level = MatrixXd::Constant(1, 1, 200.0);
    model.point_lux_per_level = MatrixXd::Constant(2, 1, 200.0);
    // As after a calibration: known well, and wrong.
    model.gain_sd = model.local_sd = Eigen::VectorXd::Constant(1, 0.02);
  }
};

TEST(GainBounds, WhatReadingsAskForAndAreNotGivenIsStatedAsAnError) {
  for (const double output : {0.4, 0.55, 0.7, 0.9, 1.0, 1.1, 1.25, 1.7}) {
    OneLamp lamp;
    GainEstimator estimator(lamp.rig, lamp.model);
    const std::vector<double> level{0.5};
    const double before_lx = estimator.at_point(1, level).standard_error_lx;
    // It has crept there, so that no reading was a jump.
    bool believed = false;
    for (int k = 1; k <= 40; ++k) {
      const LuxReading reading{0, 100 * (1 + (output - 1) * k / 40.0) + 1e-3 * k, at_s(k)};
      believed = estimator.update(at_s(k), std::span(&reading, 1), level).front().believed;
    }
    const double truth_lx = 100 * output;
    EXPECT_EQ(believed, output > 0.5 && output < 1.3) << "what is farther off is an alarm";
    if (!believed) continue;
    for (const std::size_t point : {0u, 1u}) {
      const Prediction said = estimator.at_point(point, level);
      EXPECT_LT(std::abs(said.lux - truth_lx), 3 * said.standard_error_lx + 0.02 * truth_lx)
          << output << ", point " << point << ": " << said.lux << " ± " << said.standard_error_lx;
    }
    if (output == 1.0) {
      EXPECT_LT(estimator.at_point(1, level).standard_error_lx, before_lx) << "within the bounds it costs nothing";
    }
  }
}

}  // namespace
}  // namespace luxrig
