#include "tools/bench/loop/many_lamps.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "core/calibration/light_unknowns.h"
#include "core/calibration/meter_run.h"
#include "core/calibration/rig_light.h"
#include "core/output/dimming.h"
#include "tools/bench/loop/stepped_rig.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kAcross = 10, kAlong = 5;
constexpr double kApart_m = 2, kHigh_m = 4;
/// Straight below; it falls off as the fifth power of the cosine, and what is reflected is the same everywhere.
constexpr double kBelow_lx = 400, kBeam = 5, kReflected_lx = 1;
constexpr double kTolerance = 0.01;
/// Levels at which curves are judged.
constexpr double kLevels[] = {0.05, 0.1, 0.2, 0.4, 0.7, 1};
/// Darker light is not asked to be known to a share of itself.
constexpr double kDimmestShare = 0.005;

struct Hall {
  Rig rig;
  MatrixXd lux;  ///< luxmeters × fixtures
};

Hall hall_of_many_lamps() {
  Hall hall;
  hall.rig.name = "hall";
  hall.rig.buses.resize(2);
  hall.rig.buses[0].name = "lamps";
  hall.rig.buses[1].name = "meters";
  for (int k = 0; k < kAcross * kAlong; ++k) {
    Fixture fixture;
    fixture.name = fmt::format("lamp-{}", k + 1);
    fixture.world_from_mount.translation_m = Vec3(kApart_m * (k % kAcross), kApart_m * (k / kAcross), kHigh_m);
    hall.rig.fixtures.push_back(fixture);
  }
  for (int m = 0; m < 6; ++m) {
    Luxmeter meter;
    meter.name = fmt::format("meter-{}", m + 1);
    meter.position_world_m = Vec3(kApart_m * (1.4 + 3.1 * (m % 3)), kApart_m * (0.9 + 2.3 * (m / 3)), 0);
    meter.tolerance = kTolerance;
    meter.bus = 1;
    hall.rig.luxmeters.push_back(meter);
  }
  hall.lux.resize(static_cast<Index>(hall.rig.luxmeters.size()), static_cast<Index>(hall.rig.fixtures.size()));
  for (Index m = 0; m < hall.lux.rows(); ++m)
    for (Index f = 0; f < hall.lux.cols(); ++f) {
      const Vec3 to = hall.rig.luxmeters[static_cast<std::size_t>(m)].position_world_m -
                      hall.rig.fixtures[static_cast<std::size_t>(f)].world_from_mount.translation_m;
      const double cosine = -to.z() / to.norm();
      hall.lux(m, f) = kBelow_lx * std::pow(cosine, kBeam + 3) + kReflected_lx;
    }
  return hall;
}

/// As calibration does it, with mounts and paint as stated.
VectorXd gains_of(const Hall& hall, const MeterRun& run) {
  LightSensitivity light;
  light.lux = hall.lux;
  light.mount.assign(hall.rig.fixtures.size(), MatrixXd::Zero(hall.lux.rows(), kMountUnknowns));
  LightPriors priors = usual_priors(hall.rig);
  LightUnknowns known(std::move(light), std::move(priors));
  known.learn(run.readings());
  VectorXd gain(static_cast<Index>(hall.rig.fixtures.size()));
  for (std::size_t f = 0; f < hall.rig.fixtures.size(); ++f)
    gain[static_cast<Index>(f)] = known.gain_is_measured(f) ? known.gain(f) : 0;
  return gain;
}

double of_95_percent(std::vector<double> errors) {
  std::sort(errors.begin(), errors.end());
  return errors[std::min(errors.size() - 1, static_cast<std::size_t>(0.95 * static_cast<double>(errors.size())))];
}

}  // namespace

std::vector<BenchRow> many_lamps(const BenchOptions& options) {
  const Hall hall = hall_of_many_lamps();
  const std::size_t lamps = hall.rig.fixtures.size();
  const int seeds = options.seeds.value_or(options.quick ? 2 : 20);
  std::vector<double> of_gain, of_curve;
  double rig_s = 0;
  std::size_t lights = 0;
  const auto started = std::chrono::steady_clock::now();
  for (int s = 0; s < seeds; ++s) {
    sim::Deviations real = sim::Deviations::real();
    real.seed = static_cast<std::uint64_t>(options.first_seed + s);
    auto world = sim::World::make(hall.rig, real, hall.lux);
    if (!world) {
      std::fprintf(stderr, "%s\n", world.error().detail.c_str());
      return {};
    }
    SteppedRig stepped(**world, hall.rig);
    MeterRun run(hall.rig, std::vector<double>(lamps, 1.0), hall.lux);
    const double begun_s = stepped.seconds();
    stepped.measure(run, std::vector<double>(lamps, 0.2));
    rig_s += (stepped.seconds() - begun_s) / seeds;
    lights += run.plan().size() / static_cast<std::size_t>(seeds);
    const VectorXd gain = gains_of(hall, run);
    std::vector<std::vector<double>> truth;
    for (const double level : kLevels) truth.push_back(stepped.outputs(std::vector<double>(lamps, level)));
    for (std::size_t f = 0; f < lamps; ++f) {
      const double full = truth.back()[f];
      of_gain.push_back(std::abs(gain[static_cast<Index>(f)] / full - 1));
      const MeasuredCurve& curve = run.curves()[f].of_level;
      for (std::size_t k = 0; k + 1 < std::size(kLevels); ++k) {
        if (!(truth[k][f] > kDimmestShare * full)) continue;
        of_curve.push_back(curve.empty() ? 1 : std::abs(share_at_level(curve, kLevels[k]) / (truth[k][f] / full) - 1));
      }
    }
  }
  const auto row = [&](const char* method, double error, double target) {
    BenchRow row;
    row.case_name = "50 lamps, 6 meters";
    row.method = method;
    row.error = error;
    row.target_error = target;
    row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count() / seeds;
    row.further = {{"rig_seconds", fmt::format("{:.0f}", rig_s)}, {"lights", fmt::format("{}", lights)}};
    return row;
  };
  return {row("outputs", of_95_percent(of_gain), 0.015), row("curves, 5 to 100 %", of_95_percent(of_curve), 0.02)};
}

}  // namespace luxrig
