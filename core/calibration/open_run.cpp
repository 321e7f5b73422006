#include "core/calibration/open_run.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

#include "core/check.h"
#include "core/output/dimming.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A lamp counts as off below this level.
constexpr double kOff = 0.02;
/// A wire whose steps are smaller than this is taken to have none.
constexpr double kFineStep = 1e-6;
constexpr double kOfRounding = 1e-9;
/// Levels are the same within this share.
constexpr double kSameShare = 5e-4;
/// A step of the pattern leaves room for what a limit may take at the same time.
constexpr double kPatternStep = 0.8 * OpenRun::kLargestStep;
/// Of the light at a meter: what lamps give that are not the rig's.
constexpr double kOtherLightShare = 0.02;
/// Readings so many standard deviations off weigh less: somebody walks by.
constexpr double kOutlier = 2.5;
constexpr int kReweighted = 8;
/// Median of the distance from the mean of a normal deviate, over its standard deviation.
constexpr double kMedianOfNormal = 0.6745;
/// Fewer readings over unknowns tell nothing of their own scatter.
constexpr Index kSpare = 8;

/// For this change of the light, what of the drive is above the dead band may change by this share.
double share_of_drive(double light_share) { return std::pow(1 + light_share, 1 / OpenRun::kSteepest) - 1; }

/// Entry of Sylvester's Hadamard matrix: ±1.
double hadamard(std::size_t row, std::size_t column) { return std::popcount(row & column) % 2 == 0 ? 1 : -1; }

}  // namespace

/// The look's level and one below it, in steps of what is on the wire, which no dimmer's law sets farther apart than
/// kPatternStep. Nothing above the look: its limits may leave no room.
void OpenRun::choose_levels(std::size_t f) {
  const Fixture& fixture = rig_->fixtures[f];
  const double drive = drive_for(fixture, look_[f]), most = drive_for(fixture, rig_->max_level(fixture));
  // What is left of the lower drive above the dead band may change by this share.
  const double share = share_of_drive(kPatternStep), above = drive - kWidestDeadBand;
  const double step = smallest_drive_step(fixture);
  double lower = 0, upper = 0;
  if (step > kFineStep) {
    const double sent = std::round(drive / step), most_sent = std::floor(most / step + kOfRounding);
    for (double count = std::floor(share * above / step + 1); count >= 1 && !(upper > lower); --count) {
      const double high = std::min(sent, most_sent), low = high - count;
      if (count * step > share * (low * step - kWidestDeadBand)) continue;
      lower = low * step;
      upper = high * step;
    }
  } else if (above > 0) {
    upper = std::min(drive, most);
    lower = kWidestDeadBand + (upper - kWidestDeadBand) / (1 + share);
  }
  if (!(upper > lower)) {
    left_out_.push_back(
        {f, above > 0
                ? fmt::format("one step on its wire is {:.2g} of full drive; at {:.2g} that may change its light "
                              "by more than {:.0f} %; a fine channel would mend it",
                              step, drive, 100 * kLargestStep)
                : fmt::format("at a drive of {:.2g} it may be in its dimmer's dead band; a brighter look would mend it",
                              drive)});
    return;
  }
  part_.push_back(f);
  dimmer_.push_back(level_at(fixture, lower));
  brighter_.push_back(level_at(fixture, upper));
}

OpenRun::OpenRun(const Rig& rig, std::span<const double> look, int rounds)
    : rig_(&rig), look_(look.begin(), look.end()) {
  LUXRIG_CHECK(look.size() == rig.fixtures.size(), "levels of {} fixtures", look.size());
  for (std::size_t f = 0; f < look.size(); ++f)
    if (look[f] > kOff && !rig.fixtures[f].switched) choose_levels(f);
  if (part_.empty()) return;
  period_ = std::bit_ceil(part_.size() + 1);
  // In another order each round, so that light that drifts is in step with no lamp.
  std::vector<std::size_t> rows(period_);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::mt19937 order(1);
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t k = period_; k > 1; --k) std::swap(rows[k - 1], rows[order() % k]);
    for (const std::size_t row : rows) {
      std::vector<double> level = look_;
      for (std::size_t k = 0; k < part_.size(); ++k)
        level[part_[k]] = hadamard(row, k + 1) > 0 ? brighter_[k] : dimmer_[k];
      plan_.push_back(std::move(level));
    }
  }
}

bool OpenRun::is_small_step(std::span<const double> before, std::span<const double> after) const {
  LUXRIG_CHECK(before.size() == look_.size() && after.size() == look_.size(), "levels of {} fixtures", after.size());
  for (std::size_t f = 0; f < look_.size(); ++f) {
    if (std::abs(after[f] - before[f]) <= kSameShare * before[f]) continue;
    const Fixture& fixture = rig_->fixtures[f];
    const double a = drive_for(fixture, before[f]), b = drive_for(fixture, after[f]);
    const double low = std::min(a, b) - kWidestDeadBand, high = std::max(a, b) - kWidestDeadBand;
    if (!(low > 0) || high - low > share_of_drive(kLargestStep) * low) return false;
  }
  return true;
}

void OpenRun::take(std::span<const double> sent, std::span<const std::optional<SteadyReading>> readings) {
  LUXRIG_CHECK(taken_.size() < plan_.size() && sent.size() == look_.size() && readings.size() == rig_->luxmeters.size(),
               "step {} of {}: {} levels, {} readings", taken_.size(), plan_.size(), sent.size(), readings.size());
  taken_.push_back({{sent.begin(), sent.end()}, {readings.begin(), readings.end()}});
}

std::optional<std::vector<LightEstimate>> OpenRun::lights_at(std::size_t luxmeter) const {
  // Shares of each lamp's light over that of the look, and the reading; both are taken without their mean and their trend over the round.
  const auto lamps = static_cast<Index>(part_.size());
  std::vector<std::size_t> steps;
  for (std::size_t step = 0; step < taken_.size(); ++step)
    if (taken_[step].readings[luxmeter]) steps.push_back(step);
  const auto count = static_cast<Index>(steps.size());
  MatrixXd share(count, lamps);
  VectorXd lux(count);
  for (Index k = 0; k < count; ++k) {
    const Taken& taken = taken_[steps[static_cast<std::size_t>(k)]];
    lux[k] = taken.readings[luxmeter]->lux;
    for (Index j = 0; j < lamps; ++j) {
      const std::size_t f = part_[static_cast<std::size_t>(j)];
      share(k, j) = taken.sent[f] / look_[f];
    }
  }
  std::vector<Index> ends;  // of rounds
  for (Index k = 0; k < count; ++k)
    if (k + 1 == count ||
        steps[static_cast<std::size_t>(k)] / period_ != steps[static_cast<std::size_t>(k) + 1] / period_)
      ends.push_back(k + 1);
  const auto drifts = 2 * static_cast<Index>(ends.size());
  const Index spare = count - lamps - drifts;
  if (spare < kSpare) return std::nullopt;

  VectorXd weight = VectorXd::Ones(count), light;
  MatrixXd covariance;
  for (int round = 0; round < kReweighted; ++round) {
    Index first = 0;
    for (const Index end : ends) {
      const VectorXd of_round = weight.segment(first, end - first);
      VectorXd time = VectorXd::LinSpaced(end - first, 0, 1);
      const auto without = [&](auto&& column, const VectorXd& shape) {
        const double square = of_round.dot(shape.cwiseAbs2());
        if (square > 0) column -= shape * (of_round.cwiseProduct(shape).dot(column) / square);
      };
      const VectorXd one = VectorXd::Ones(end - first);
      without(time, one);
      for (Index j = 0; j < lamps; ++j) {
        without(share.col(j).segment(first, end - first), one);
        without(share.col(j).segment(first, end - first), time);
      }
      without(lux.segment(first, end - first), one);
      without(lux.segment(first, end - first), time);
      first = end;
    }
    const MatrixXd normal = share.transpose() * weight.asDiagonal() * share;
    const Eigen::LDLT<MatrixXd> solver(normal);
    if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 0)) return std::nullopt;
    light = solver.solve(share.transpose() * weight.cwiseProduct(lux));
    const VectorXd off = lux - share * light;
    // The median of what is left is not moved by those who walk by.
    VectorXd sorted = off.cwiseAbs();
    std::nth_element(sorted.begin(), sorted.begin() + count / 2, sorted.end());
    const double deviation = std::max(1e-9, sorted[count / 2] / kMedianOfNormal);
    const double variance =
        weight.dot(off.cwiseAbs2()) / std::max(1.0, weight.sum() - static_cast<double>(lamps + drifts));
    covariance = solver.solve(MatrixXd::Identity(lamps, lamps)) * variance;
    weight = off.unaryExpr([&](double each) {
      return std::min(1.0, std::pow(kOutlier * deviation / std::max(1e-12, std::abs(each)), 2));
    });
  }
  std::vector<LightEstimate> lights;
  for (Index j = 0; j < lamps; ++j) lights.push_back({light[j], std::sqrt(std::max(0.0, covariance(j, j)))});
  return lights;
}

/// The median, which is not moved by those who walk by; under the mean of what was sent.
std::optional<LightEstimate> OpenRun::all_light_at(std::size_t luxmeter, VectorXd& sent) const {
  if (rig_->daylight) return std::nullopt;
  std::vector<double> lux, off;
  sent.setZero(static_cast<Index>(look_.size()));
  for (const Taken& taken : taken_) {
    if (!taken.readings[luxmeter]) continue;
    lux.push_back(taken.readings[luxmeter]->lux);
    sent += Eigen::Map<const VectorXd>(taken.sent.data(), sent.size());
  }
  if (static_cast<Index>(lux.size()) < kSpare) return std::nullopt;
  sent /= static_cast<double>(lux.size());
  const auto median = [](std::vector<double>& of) {
    const auto middle = of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2);
    std::nth_element(of.begin(), middle, of.end());
    return *middle;
  };
  const double middle = median(lux);
  for (const double each : lux) off.push_back(std::abs(each - middle));
  const double error = median(off) / kMedianOfNormal / std::sqrt(static_cast<double>(lux.size()));
  return LightEstimate{middle, std::hypot(error, kOtherLightShare * middle)};
}

std::vector<LightReading> OpenRun::readings(std::size_t first_slope) const {
  std::vector<LightReading> readings;
  const auto add = [&](std::size_t m, const LightEstimate& light, Eigen::VectorXd level) -> LightReading& {
    LightReading reading;
    reading.receiver = rig_->points.size() + m;
    reading.meter = m;
    reading.lux = light.lux;
    reading.standard_error_lx = std::max(light.standard_error_lx, 1e-6);
    reading.level = std::move(level);
    readings.push_back(std::move(reading));
    return readings.back();
  };
  std::vector<std::size_t> slopes(look_.size());
  std::iota(slopes.begin(), slopes.end(), first_slope);
  for (std::size_t m = 0; m < rig_->luxmeters.size(); ++m) {
    const auto lights = lights_at(m);
    if (!lights) continue;
    for (std::size_t k = 0; k < part_.size(); ++k) {
      VectorXd level = VectorXd::Zero(static_cast<Index>(look_.size()));
      level[static_cast<Index>(part_[k])] = look_[part_[k]];
      add(m, (*lights)[k], std::move(level)).showing.of_lamp = slopes;
    }
    VectorXd sent;
    if (const auto all = all_light_at(m, sent)) add(m, *all, sent);
  }
  return readings;
}

}  // namespace luxrig
