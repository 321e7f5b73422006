#include "core/calibration/meter_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"
#include "core/output/dimming.h"
#include "core/tasks/rig_version.h"

namespace luxrig {
namespace {

using Eigen::Index;

/// Of a lamp's brightest level. Few, since a dimmer is nearly a power between any two.
constexpr double kShares[] = {1, 0.5, 0.25, 0.1, 0.05};
/// Lamps may be this much stronger than stated, and a limit still holds.
constexpr double kStrongest = 1.35;
/// A share of a curve whose error is larger says nothing; less than this at the brightest step, and no curve is found.
constexpr double kMostCurveError = 0.05;
/// The dark is measured anew after so many lamps, as daylight and meters drift.
constexpr std::size_t kLampsPerDark = 4;

}  // namespace

MeterRun::MeterRun(const Rig& rig, const Eigen::MatrixXd& stated_lux) : rig_(&rig), curves_(rig.fixtures.size()) {
  LUXRIG_CHECK(stated_lux.cols() == static_cast<Index>(rig.fixtures.size()), "light of {} fixtures", stated_lux.cols());
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    if (f % kLampsPerDark == 0) plan_.push_back({0, 0});
    double most = rig.max_level(rig.fixtures[f]);
    for (std::size_t p = 0; p < rig.points.size(); ++p) {
      const double lux = kStrongest * stated_lux(static_cast<Index>(p), static_cast<Index>(f));
      if (rig.points[p].max_lx && lux * most > *rig.points[p].max_lx) most = *rig.points[p].max_lx / lux;
    }
    if (!(most > 0)) continue;
    if (rig.fixtures[f].switched) {
      if (most >= 1) plan_.push_back({f, 1});
      continue;
    }
    for (const double share : kShares) plan_.push_back({f, share * most});
  }
}

std::optional<MeterRun::Step> MeterRun::next() const {
  if (taken_.size() >= plan_.size()) return std::nullopt;
  const Asked& asked = plan_[taken_.size()];
  Step step;
  step.level.assign(rig_->fixtures.size(), 0.0);
  step.level[asked.fixture] = asked.level;
  step.what = asked.level > 0
                  ? fmt::format("\"{}\" alone at level {:.3g}", rig_->fixtures[asked.fixture].name, asked.level)
                  : std::string("every lamp dark");
  return step;
}

void MeterRun::take(std::span<const double> level, std::span<const std::optional<SteadyReading>> readings) {
  LUXRIG_CHECK(taken_.size() < plan_.size() && level.size() == rig_->fixtures.size() &&
                   readings.size() == rig_->luxmeters.size(),
               "step {} of {}: {} levels, {} readings", taken_.size(), plan_.size(), level.size(), readings.size());
  taken_.push_back(
      {plan_[taken_.size()].level > 0 ? level[plan_[taken_.size()].fixture] : 0.0, {readings.begin(), readings.end()}});
  if (taken_.size() == plan_.size()) find_curves();
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

void MeterRun::find_curves() {
  for (std::size_t first = 0; first < plan_.size();) {
    if (!(plan_[first].level > 0)) {
      ++first;
      continue;
    }
    std::size_t end = first;
    while (end < plan_.size() && plan_[end].level > 0 && plan_[end].fixture == plan_[first].fixture) ++end;
    // The meter that sees it best.
    std::optional<std::size_t> best;
    double least = kMostCurveError;
    for (std::size_t m = 0; m < rig_->luxmeters.size(); ++m) {
      const auto full = above_dark(first, m);
      if (!full || !(full->lux > 0) || full->standard_error_lx / full->lux > least) continue;
      least = full->standard_error_lx / full->lux;
      best = m;
    }
    Curve& curve = curves_[plan_[first].fixture];
    if (best && end - first > 1) {
      const SteadyReading full = *above_dark(first, *best);
      MeasuredCurve shares{{taken_[first].level, 1.0}};  // brightest first
      for (std::size_t step = first + 1; step < end; ++step) {
        const auto lit = above_dark(step, *best);
        if (!lit || !(lit->lux > 0)) continue;
        const double error = std::hypot(lit->standard_error_lx / lit->lux, least);
        const std::pair<double, double> entry{taken_[step].level, lit->lux / full.lux};
        if (error > kMostCurveError || !(entry.first < shares.back().first && entry.second < shares.back().second))
          continue;
        shares.push_back(entry);
        curve.error = std::max(curve.error, error);
      }
      if (shares.size() > 1) {
        std::reverse(shares.begin(), shares.end());
        // Above what a limit lets it reach, the maker's curve is all there is.
        const double top = shares.back().first;
        for (auto& entry : shares) entry.second *= top;
        if (top < 1) shares.emplace_back(1, 1);
        curve.of_level = std::move(shares);
      }
    }
    first = end;
  }
}

std::vector<LightReading> MeterRun::readings() const {
  LUXRIG_CHECK(taken_.size() == plan_.size(), "{} of {} steps are measured", taken_.size(), plan_.size());
  std::vector<LightReading> readings;
  for (std::size_t step = 0; step < plan_.size(); ++step) {
    const Asked& asked = plan_[step];
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
      reading.level[static_cast<Index>(asked.fixture)] = share_at_level(curve(asked.fixture), taken_[step].level);
      readings.push_back(std::move(reading));
    }
  }
  return readings;
}

Calibration calibration_of(const Session& session, const RigLight& light, const MeterRun& run, std::string made) {
  const Rig& rig = session.rig;
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
    found.output = {known.gain(f), known.gain_standard_error(f)};
    found.offset_m = known.mount(f).head<3>();
    found.offset_error_m = known.mount_standard_error(f).head<3>();
    found.turn_deg = deg(known.mount(f));
    found.turn_error_deg = deg(known.mount_standard_error(f));
    found.curve = run.curve(f);
    found.curve_error = run.curve_error(f);
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
