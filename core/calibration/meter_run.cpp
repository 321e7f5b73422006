#include "core/calibration/meter_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/calibration/mount_place.h"
#include "core/check.h"
#include "core/output/dimming.h"
#include "core/tasks/rig_version.h"

namespace luxrig {
namespace {

using Eigen::Index;

/// The dark is measured anew after so many lights, as daylight and meters drift.
constexpr std::size_t kLightsPerDark = 8;
/// A level at which the best luxmeter would show less says nothing of a dimmer.
constexpr double kSeen_lx = 0.2;
/// A meter that shows so much less of a lamp than another would hardly tell more.
constexpr double kMatters = 0.3;
/// Light at half level is at most this share of that at the full one, for dimmers down to an exponent of 0.75.
constexpr double kMostAtHalf = 0.6;

/// So often a lamp may be tried brighter; less than this more is not worth a light.
constexpr int kTimesBrighter = 2;
constexpr double kBrighter = 1.1;
/// At a limit, a lamp may give so much more than where a meter shows it, over what is stated: its mount is off. At the
/// limit's own meter, only as much as the meter is off.
constexpr double kElsewhere = 1.35;
/// Light rises with at most this power of the level, for dimmers of the field; once two levels are read, with at most so
/// much more than between them.
constexpr double kSteepest = 2.5, kSteeper = 0.3;
/// What is sent is rounded by the wire.
constexpr double kSameLevel = 1e-3;
/// A reading that is less sure says nothing of how bright a lamp is.
constexpr double kSure = 0.05;

}  // namespace

MeterRun::MeterRun(const Rig& rig, std::span<const double> brightest, Eigen::MatrixXd stated_lux)
    : rig_(&rig),
      brightest_(brightest.begin(), brightest.end()),
      stated_lux_(std::move(stated_lux)),
      alone_at_(rig.fixtures.size()),
      curves_(rig.fixtures.size()) {
  LUXRIG_CHECK(brightest.size() == rig.fixtures.size(), "levels of {} fixtures", brightest.size());
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    if (!(brightest[f] > 0)) continue;
    add({{f, brightest[f]}});
    alone_at_[f] = {plan_.size() - 1};
  }
}

void MeterRun::add(std::vector<LampStep> lit) {
  const std::size_t recent = std::min(plan_.size(), kLightsPerDark);
  if (std::none_of(plan_.end() - static_cast<std::ptrdiff_t>(recent), plan_.end(),
                   [](const std::vector<LampStep>& light) { return light.empty(); }))
    plan_.emplace_back();
  plan_.push_back(std::move(lit));
}

void MeterRun::take(std::span<const double> sent, std::span<const std::optional<SteadyReading>> readings) {
  LUXRIG_CHECK(
      taken_.size() < plan_.size() && sent.size() == rig_->fixtures.size() && readings.size() == rig_->luxmeters.size(),
      "light {} of {}: {} levels, {} readings", taken_.size(), plan_.size(), sent.size(), readings.size());
  taken_.push_back({{sent.begin(), sent.end()}, {readings.begin(), readings.end()}});
  if (taken_.size() < plan_.size()) return;
  if (stage_ == Stage::alone) {
    stage_ = Stage::again;
    plan_again();
    if (taken_.size() < plan_.size()) return;
  }
  while (stage_ == Stage::again || stage_ == Stage::brighter) {
    if (stage_ == Stage::brighter) settle_brighter();
    stage_ = times_brighter_++ < kTimesBrighter ? Stage::brighter : Stage::dimmed;
    if (stage_ == Stage::brighter)
      plan_brighter();
    else
      plan_curves();
    if (taken_.size() < plan_.size()) return;
  }
  if (taken_.size() == plan_.size()) find_curves();
}

std::optional<SteadyReading> MeterRun::above_dark(std::size_t light, std::size_t luxmeter) const {
  const auto& lit = taken_[light].readings[luxmeter];
  for (std::size_t k = light; lit && k-- > 0;) {
    if (!plan_[k].empty()) continue;
    const auto& dark = taken_[k].readings[luxmeter];
    if (!dark) continue;
    return SteadyReading{lit->lux - dark->lux, std::hypot(lit->standard_error_lx, dark->standard_error_lx)};
  }
  return std::nullopt;
}

std::optional<SteadyReading> MeterRun::light_alone(std::size_t fixture, std::size_t luxmeter) const {
  const double level = level_alone(fixture);
  for (auto light = alone_at_[fixture].rbegin(); light != alone_at_[fixture].rend(); ++light) {
    if (taken_[*light].sent[fixture] < (1 - kSameLevel) * level) break;
    if (auto read = above_dark(*light, luxmeter)) return read;
  }
  return std::nullopt;
}

double MeterRun::level_alone(std::size_t fixture) const {
  return alone_at_[fixture].empty() ? 0 : taken_[alone_at_[fixture].back()].sent[fixture];
}

void MeterRun::plan_again() {
  std::vector<std::size_t> lamps;
  for (std::size_t m = 0; m < rig_->luxmeters.size(); ++m) {
    const auto reads = [&](const Taken& taken) { return taken.readings[m].has_value(); };
    // One that reads seldom will not read then.
    if (2 * static_cast<std::size_t>(std::count_if(taken_.begin(), taken_.end(), reads)) < taken_.size()) continue;
    for (std::size_t f = 0; f < rig_->fixtures.size(); ++f) {
      const auto of_meters = stated_lux_.col(static_cast<Index>(f)).tail(static_cast<Index>(rig_->luxmeters.size()));
      const bool matters = of_meters[static_cast<Index>(m)] >= kMatters * of_meters.maxCoeff();
      if (matters && level_alone(f) > 0 && !light_alone(f, m)) lamps.push_back(f);
    }
  }
  std::sort(lamps.begin(), lamps.end());
  lamps.erase(std::unique(lamps.begin(), lamps.end()), lamps.end());
  if (!lamps.empty()) plan_.emplace_back();
  for (const std::size_t f : lamps) {
    add({{f, brightest_[f]}});
    alone_at_[f].push_back(plan_.size() - 1);
  }
}

std::optional<std::size_t> MeterRun::best_meter(std::size_t fixture) const {
  std::optional<std::size_t> best;
  double least = kSure;
  for (std::size_t m = 0; m < rig_->luxmeters.size(); ++m) {
    const auto lit = light_alone(fixture, m);
    if (!lit || !(lit->standard_error_lx < least * lit->lux)) continue;
    least = lit->standard_error_lx / lit->lux;
    best = m;
  }
  return best;
}

std::optional<double> MeterRun::over_stated(std::size_t fixture) const {
  const auto meters = static_cast<Index>(rig_->luxmeters.size());
  const auto stated_lx = stated_lux_.col(static_cast<Index>(fixture)).tail(meters);
  double over = 0;
  for (Index m = 0; m < meters; ++m) {
    const auto lit = light_alone(fixture, static_cast<std::size_t>(m));
    const double share = 1 + rig_->luxmeters[static_cast<std::size_t>(m)].tolerance;
    if (lit && lit->standard_error_lx < kSure * lit->lux && stated_lx[m] >= kMatters * stated_lx.maxCoeff())
      over = std::max(over, share * lit->lux / (level_alone(fixture) * stated_lx[m]));
  }
  return over > 0 ? std::optional(over) : std::nullopt;
}

double MeterRun::most_lux(std::size_t point, std::size_t fixture) const {
  const double stated_lx = stated_lux_(static_cast<Index>(point), static_cast<Index>(fixture));
  const double level = level_alone(fixture);
  for (std::size_t m = 0; m < rig_->luxmeters.size(); ++m)
    if (const auto lit = light_alone(fixture, m); lit && rig_->luxmeters[m].point == point)
      return (lit->lux + 3 * lit->standard_error_lx) * (1 + rig_->luxmeters[m].tolerance);
  const auto over = over_stated(fixture);
  return over ? kElsewhere * *over * stated_lx * level : stated_lx * most_share(level);
}

double MeterRun::room_below_limits(std::size_t fixture) const {
  double room = std::numeric_limits<double>::infinity();
  for (std::size_t p = 0; p < rig_->points.size(); ++p)
    if (const double most_lx = most_lux(p, fixture); rig_->points[p].max_lx && most_lx > 0)
      room = std::min(room, *rig_->points[p].max_lx / most_lx);
  return room;
}

std::optional<double> MeterRun::brighter_level(std::size_t fixture) const {
  if (!over_stated(fixture)) return std::nullopt;
  const double level = level_alone(fixture);
  double steepness = kSteepest;
  if (const auto first = alone_at_[fixture].front(); taken_[first].sent[fixture] < (1 - kSameLevel) * level)
    if (const auto meter = best_meter(fixture))
      if (const auto dim = above_dark(first, *meter); dim && dim->lux > 0)
        steepness = std::clamp(
            std::log(light_alone(fixture, *meter)->lux / dim->lux) / std::log(level / taken_[first].sent[fixture]) +
                kSteeper,
            1.0, kSteepest);
  return std::min(rig_->max_level(rig_->fixtures[fixture]),
                  level * std::pow(room_below_limits(fixture), 1 / steepness));
}

void MeterRun::plan_brighter() {
  for (std::size_t f = 0; f < rig_->fixtures.size(); ++f) {
    const double level = level_alone(f);
    if (rig_->fixtures[f].switched || !(level > 0) || level >= rig_->max_level(rig_->fixtures[f])) continue;
    // A lamp that was not worth a brighter light once is not the next time.
    if (times_brighter_ > 1 && level < (1 + kSameLevel) * taken_[alone_at_[f].front()].sent[f]) continue;
    const auto brighter = brighter_level(f);
    if (!brighter || *brighter < kBrighter * level) continue;
    add({{f, *brighter}});
    alone_at_[f].push_back(plan_.size() - 1);
  }
}

void MeterRun::settle_brighter() {
  for (std::size_t f = 0; f < rig_->fixtures.size(); ++f) {
    if (alone_at_[f].empty()) continue;
    const double first = taken_[alone_at_[f].front()].sent[f];
    while (level_alone(f) > first * (1 + kSameLevel) && !best_meter(f)) alone_at_[f].pop_back();
    if (level_alone(f) > first * (1 + kSameLevel)) brightest_[f] = level_alone(f);
  }
}

void MeterRun::plan_curves() {
  first_of_curves_ = plan_.size();
  const auto meters = static_cast<Index>(rig_->luxmeters.size()), fixtures = static_cast<Index>(rig_->fixtures.size());
  alone_.lux.setConstant(meters, fixtures, std::numeric_limits<double>::quiet_NaN());
  alone_.standard_error_lx = alone_.lux;
  for (std::size_t f = 0; f < rig_->fixtures.size(); ++f) {
    if (rig_->fixtures[f].switched || !(level_alone(f) > 0)) continue;
    for (std::size_t m = 0; m < rig_->luxmeters.size(); ++m) {
      const auto lit = light_alone(f, m);
      if (!lit) continue;
      alone_.lux(static_cast<Index>(m), static_cast<Index>(f)) = lit->lux;
      alone_.standard_error_lx(static_cast<Index>(m), static_cast<Index>(f)) = lit->standard_error_lx;
    }
  }
  const auto may = [&](std::span<const std::size_t> lamps) {
    for (std::size_t p = 0; p < rig_->points.size(); ++p) {
      double most_lx = 0;
      for (const std::size_t f : lamps) most_lx += rig_->points[p].max_lx ? kMostAtHalf * most_lux(p, f) : 0;
      if (rig_->points[p].max_lx && most_lx > *rig_->points[p].max_lx) return false;
    }
    return true;
  };
  for (const std::vector<std::size_t>& group : curve_groups(alone_, may)) {
    for (const double share : std::span(kCurveShares).subspan(1)) {
      std::vector<LampStep> lit;
      for (const std::size_t f : group) {
        // A meter that has not read it has NaN, which is not more.
        double most_lx = 0;
        for (Index m = 0; m < meters; ++m) most_lx = std::max(most_lx, alone_.lux(m, static_cast<Index>(f)));
        if (most_lx * share >= kSeen_lx) lit.push_back({f, share * brightest_[f]});
      }
      if (!lit.empty()) add(std::move(lit));
    }
  }
}

void MeterRun::find_curves() {
  std::vector<std::vector<ReadAtLevel>> read(rig_->fixtures.size());
  // Of full light, by the meter that knows it best.
  for (std::size_t f = 0; f < read.size(); ++f) {
    double least = 1;
    for (std::size_t m = 0; m < rig_->luxmeters.size(); ++m) {
      const double lux = alone_.lux(static_cast<Index>(m), static_cast<Index>(f));
      const double error_lx = alone_.standard_error_lx(static_cast<Index>(m), static_cast<Index>(f));
      if (!(lux > 0) || error_lx / lux > least) continue;
      least = error_lx / lux;
      read[f] = {{level_alone(f), {lux, error_lx}}};
    }
  }
  for (std::size_t light = first_of_curves_; light < plan_.size(); ++light) {
    std::vector<std::size_t> lamps;
    for (const LampStep& step : plan_[light]) lamps.push_back(step.fixture);
    if (lamps.empty()) continue;
    std::vector<std::optional<SteadyReading>> readings;
    for (std::size_t m = 0; m < rig_->luxmeters.size(); ++m) readings.push_back(above_dark(light, m));
    const std::vector<ShareOfAlone> shares = shares_of(alone_, lamps, readings);
    for (std::size_t k = 0; k < shares.size(); ++k) {
      std::vector<ReadAtLevel>& of_lamp = read[lamps[k]];
      if (of_lamp.empty()) continue;
      const double full_lx = of_lamp.front().light.lux;
      of_lamp.push_back(
          {taken_[light].sent[lamps[k]], {shares[k].value * full_lx, shares[k].standard_error * full_lx}});
    }
  }
  for (std::size_t f = 0; f < read.size(); ++f) curves_[f] = curve_of(read[f], room_below_limits(f));
}

std::vector<LightReading> MeterRun::readings() const {
  LUXRIG_CHECK(taken_.size() == plan_.size(), "{} of {} lights are measured", taken_.size(), plan_.size());
  std::vector<LightReading> readings;
  for (std::size_t f = 0; f < rig_->fixtures.size(); ++f) {
    if (!(level_alone(f) > 0)) continue;
    for (std::size_t m = 0; m < rig_->luxmeters.size(); ++m) {
      const auto lit = light_alone(f, m);
      if (!lit) continue;
      LightReading reading;
      reading.receiver = rig_->points.size() + m;
      reading.meter = m;
      reading.lux = lit->lux;
      reading.standard_error_lx = std::max(lit->standard_error_lx, 1e-6);
      reading.level.setZero(static_cast<Index>(rig_->fixtures.size()));
      reading.level[static_cast<Index>(f)] = share_at_level(curves_[f].of_level, level_alone(f));
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
    found.offset_m =
        offset_in_room(*session.rays, rig.fixtures[f].world_from_mount.translation_m, known.mount(f).head<3>());
    found.offset_error_m = known.mount_standard_error(f).head<3>();
    found.turn_deg = deg(known.mount(f));
    found.turn_error_deg = deg(known.mount_standard_error(f));
    found.curve = curves[f].of_level;
    found.curve_error = curves[f].error_in_use;
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
      // The estimate is linear: of a lamp that hardly reaches the point it may be below 0, within its error.
      calibration.lights.push_back(
          {rig.points[p].name, rig.fixtures[f].name, {std::max(0.0, lit.lux), lit.standard_error_lx}});
    }
  }
  return calibration;
}

}  // namespace luxrig
