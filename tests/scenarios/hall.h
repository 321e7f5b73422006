#pragma once
/// A synthetic hall: 12 fixtures, 36 points, 6 luxmeters, 4 works with a conservation limit. The transport is given,
/// not traced, so a show of a minute takes milliseconds. Tests with real rigs cover the real chain.

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "core/rig/rig.h"
#include "core/show/show_controller.h"

namespace luxrig::scenarios {

struct Hall {
  Rig rig;
  LightModel model;
  Eigen::MatrixXd truth;     ///< (points, then luxmeters) × fixtures: the model with errors of a few percent
  std::vector<double> plan;  ///< levels that reach the goals in the model
};

inline constexpr std::size_t kWorks = 4;  ///< points 0…3, each with a luxmeter, max_lx 50

struct HallOptions {
  double work_goal_lx = 45;
  double model_error = 0.03;  ///< standard deviation of the error in each entry of T
};

/// Fixtures hang in 4 × 3 over a floor of 12 m × 9 m. Each lights mainly the area below it, and the room a little.
inline Hall make_hall(std::uint64_t seed, const HallOptions& options = {}) {
  std::mt19937_64 random(seed);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const auto normal = [&] {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += unit();  // close to Gaussian, bounded, and the same on every machine
    return sum;
  };
  Hall hall;
  Rig& rig = hall.rig;
  rig.name = "hall";
  rig.buses.resize(3);
  const char* names[] = {"track", "dimmers", "meters"};
  for (std::size_t b = 0; b < 3; ++b) rig.buses[b].name = names[b];
  const DimmerCurve curves[] = {DimmerCurve::square, DimmerCurve::linear, DimmerCurve::s_curve};
  for (std::size_t i = 0; i < 12; ++i) {
    Fixture fixture;
    fixture.name = "spot-" + std::to_string(i + 1);
    fixture.world_from_mount.translation_m =
        Vec3(1.5 + 3 * static_cast<double>(i % 4), 1.5 + 3 * static_cast<double>(i / 4), 3.0);
    fixture.bus = i < 8 ? 0 : 1;
    if (i >= 8) fixture.patch = ModbusPatch{};
    fixture.dimmer_curve = curves[i % 3];
    rig.fixtures.push_back(fixture);
  }
  for (std::size_t p = 0; p < 36; ++p) {
    Point point;
    point.name = p < kWorks ? "work-" + std::to_string(p + 1) : "place-" + std::to_string(p + 1 - kWorks);
    point.position_world_m = Vec3(12 * unit(), 9 * unit(), 0.8);
    // Each work hangs below its own fixture, far from the others; two more meters stand below other fixtures.
    const std::size_t below[] = {0, 3, 5, 10, 8, 7};
    if (p < 6) {
      point.position_world_m =
          rig.fixtures[below[p]].world_from_mount.translation_m + Vec3(unit() - 0.5, unit() - 0.5, -2.2);
    }
    if (p < kWorks) point.max_lx = 50;
    rig.points.push_back(point);
  }
  for (std::size_t m = 0; m < 6; ++m) {
    Luxmeter meter;
    meter.name = "meter-" + std::to_string(m + 1);
    meter.point = m;
    meter.position_world_m = rig.points[m].position_world_m;
    meter.tolerance = 0.04;
    meter.bus = 2;
    rig.luxmeters.push_back(meter);
  }
  rig.control.fade_s = 2;
  rig.control.correction_fade_s = 0.8;
  rig.safe.hold_s = 3;
  rig.safe.fade_s = 2;

  const Eigen::Index points = 36, meters = 6, fixtures = 12;
  Eigen::MatrixXd lux(points, fixtures);
  for (Eigen::Index p = 0; p < points; ++p) {
    for (Eigen::Index j = 0; j < fixtures; ++j) {
      const Vec3 away = rig.points[static_cast<std::size_t>(p)].position_world_m -
                        rig.fixtures[static_cast<std::size_t>(j)].world_from_mount.translation_m;
      const double off_axis = std::acos(-away.z() / away.norm());
      lux(p, j) = 1200 / away.squaredNorm() * std::exp(-3 * off_axis * off_axis) + 4;
    }
  }
  // Plausible levels. Where a work hangs, the level gives its goal.
  Eigen::VectorXd level(fixtures);
  for (Eigen::Index j = 0; j < fixtures; ++j) level[j] = 0.25 + 0.45 * unit();
  const Eigen::Index over_work[] = {0, 3, 5, 10};
  for (int round = 0; round < 20; ++round) {
    for (Eigen::Index w = 0; w < static_cast<Eigen::Index>(kWorks); ++w) {
      const double missing_lx = options.work_goal_lx - lux.row(w).dot(level);
      level[over_work[w]] = std::max(0.02, level[over_work[w]] + missing_lx / lux(w, over_work[w]));
    }
  }
  const Eigen::VectorXd goal = lux * level;
  for (std::size_t p = 0; p < rig.points.size(); ++p) {
    rig.points[p].goal_lx = p < kWorks ? options.work_goal_lx : goal[static_cast<Eigen::Index>(p)];
  }
  hall.model.point_lux_per_level = lux;
  hall.model.meter_lux_per_level = lux.topRows(meters);
  hall.plan.assign(level.data(), level.data() + level.size());
  hall.truth.resize(points + meters, fixtures);
  for (Eigen::Index p = 0; p < points; ++p) {
    for (Eigen::Index j = 0; j < fixtures; ++j) {
      hall.truth(p, j) = lux(p, j) * std::exp(options.model_error * normal());
    }
  }
  hall.truth.bottomRows(meters) = hall.truth.topRows(meters);
  return hall;
}

}  // namespace luxrig::scenarios
