#include "core/calibration/meter_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"
#include "core/output/dimming.h"
#include "core/tasks/rig_version.h"

namespace luxrig {
namespace {

using Eigen::Index;

/// The dark is measured anew after so many lamps, as daylight and meters drift.
constexpr std::size_t kLampsPerDark = 4;
/// A level at which the best luxmeter would show less says nothing of a dimmer.
constexpr double kSeen_lx = 0.2;

}  // namespace

MeterRun::MeterRun(const Rig& rig, std::span<const double> brightest, const Eigen::MatrixXd& stated_lux)
    : rig_(&rig), curves_(rig.fixtures.size()) {
  LUXRIG_CHECK(brightest.size() == rig.fixtures.size(), "levels of {} fixtures", brightest.size());
  const auto meters = static_cast<Index>(rig.luxmeters.size());
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    if (f % kLampsPerDark == 0) plan_.push_back({0, 0});
    if (!(brightest[f] > 0)) continue;
    const double most_lx = meters > 0 ? stated_lux.col(static_cast<Index>(f)).tail(meters).maxCoeff() : 0;
    for (const double share : kCurveShares) {
      if (share < 1 && (rig.fixtures[f].switched || most_lx * brightest[f] * share < kSeen_lx)) break;
      plan_.push_back({f, share * brightest[f]});
    }
  }
}

void MeterRun::take(double level, std::span<const std::optional<SteadyReading>> readings) {
  LUXRIG_CHECK(taken_.size() < plan_.size() && readings.size() == rig_->luxmeters.size(), "step {} of {}: {} readings",
               taken_.size(), plan_.size(), readings.size());
  taken_.push_back({plan_[taken_.size()].level > 0 ? level : 0.0, {readings.begin(), readings.end()}});
  if (taken_.size() < plan_.size()) return;
  for (std::size_t first = 0; first < plan_.size();) {
    std::size_t end = first + 1;
    if (plan_[first].level > 0) {
      while (end < plan_.size() && plan_[end].level > 0 && plan_[end].fixture == plan_[first].fixture) ++end;
      curves_[plan_[first].fixture] = curve_of_steps(first, end);
    }
    first = end;
  }
}

std::optional<SteadyReading> MeterRun::above_dark(std::size_t step, std::size_t luxmeter) const {
  const auto& lit = taken_[step].readings[luxmeter];
  for (std::size_t k = step; lit && k-- > 0;) {
    if (plan_[k].level > 0) continue;
    const auto& dark = taken_[k].readings[luxmeter];
    if (!dark) continue;
    return SteadyReading{lit->lux - dark->lux, std::hypot(lit->standard_error_lx, dark->standard_error_lx)};
  }
  return std::nullopt;
}

LampCurve MeterRun::curve_of_steps(std::size_t first, std::size_t end) const {
  std::optional<std::size_t> best;
  double least = 1;
  for (std::size_t m = 0; m < rig_->luxmeters.size(); ++m) {
    const auto full = above_dark(first, m);
    if (!full || !(full->lux > 0) || full->standard_error_lx / full->lux > least) continue;
    least = full->standard_error_lx / full->lux;
    best = m;
  }
  std::vector<ReadAtLevel> read;
  for (std::size_t step = first; best && step < end; ++step)
    if (const auto lit = above_dark(step, *best)) read.push_back({taken_[step].level, *lit});
  return curve_of(read);
}

std::vector<LightReading> MeterRun::readings() const {
  LUXRIG_CHECK(taken_.size() == plan_.size(), "{} of {} steps are measured", taken_.size(), plan_.size());
  std::vector<LightReading> readings;
  for (std::size_t step = 0; step < plan_.size(); ++step) {
    const LampStep& asked = plan_[step];
    const bool brightest =
        asked.level > 0 && (step == 0 || plan_[step - 1].fixture != asked.fixture || !(plan_[step - 1].level > 0));
    if (!brightest || !(taken_[step].level > 0)) continue;
    for (std::size_t m = 0; m < rig_->luxmeters.size(); ++m) {
      const auto lit = above_dark(step, m);
      if (!lit) continue;
      LightReading reading;
      reading.receiver = rig_->points.size() + m;
      reading.meter = m;
      reading.lux = lit->lux;
      reading.standard_error_lx = std::max(lit->standard_error_lx, 1e-6);
      reading.level.setZero(static_cast<Index>(rig_->fixtures.size()));
      reading.level[static_cast<Index>(asked.fixture)] =
          share_at_level(curves_[asked.fixture].of_level, taken_[step].level);
      readings.push_back(std::move(reading));
    }
  }
  return readings;
}

Calibration calibration_of(const Session& session, const RigLight& light, std::span<const LampCurve> curves,
                           std::string made) {
  const Rig& rig = session.rig;
  LUXRIG_CHECK(curves.size() == rig.fixtures.size(), "curves of {} fixtures", curves.size());
  const LightUnknowns& known = light.known();
  Calibration calibration;
  calibration.rig = rig.name;
  calibration.made = std::move(made);
  calibration.made_for = version_of(rig, session.scene).light;
  const auto fixtures = static_cast<Index>(rig.fixtures.size());
  const auto deg = [](const Eigen::VectorXd& mount) -> Vec3 { return mount.tail<3>() * (180 / kPi); };
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    CalibratedFixture found;
    found.name = rig.fixtures[f].name;
    if (known.gain_is_measured(f)) found.output = {known.gain(f), known.gain_standard_error(f)};
    found.offset_m = known.mount(f).head<3>();
    found.offset_error_m = known.mount_standard_error(f).head<3>();
    found.turn_deg = deg(known.mount(f));
    found.turn_error_deg = deg(known.mount_standard_error(f));
    found.curve = curves[f].of_level;
    found.curve_error = curves[f].error;
    calibration.fixtures.push_back(std::move(found));
  }
  for (std::size_t m = 0; m < session.scene.materials.size(); ++m)
    calibration.materials.push_back({session.scene.materials[m].name, {known.paint(m), known.paint_standard_error(m)}});
  for (std::size_t m = 0; m < rig.luxmeters.size(); ++m)
    calibration.luxmeters.push_back({rig.luxmeters[m].name, {known.meter_gain(m), known.meter_gain_standard_error(m)}});
  for (std::size_t p = 0; p < rig.points.size(); ++p) {
    if (!rig.points[p].goal_lx && !rig.points[p].max_lx) continue;
    for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
      const LightEstimate lit = known.at(p, Eigen::VectorXd::Unit(fixtures, static_cast<Index>(f)));
      calibration.lights.push_back({rig.points[p].name, rig.fixtures[f].name, {lit.lux, lit.standard_error_lx}});
    }
  }
  return calibration;
}

}  // namespace luxrig
