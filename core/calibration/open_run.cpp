#include "core/calibration/open_run.h"

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
/// Readings so many standard deviations off weigh less: somebody walks by.
constexpr double kOutlier = 2.5;
constexpr int kReweighted = 8;
/// Median of the distance from the mean of a normal deviate, over its standard deviation.
constexpr double kMedianOfNormal = 0.6745;
/// Fewer readings over unknowns tell nothing of their own scatter.
constexpr Index kSpare = 8;

/// Entry of Sylvester's Hadamard matrix: ±1.
double hadamard(std::size_t row, std::size_t column) { return std::popcount(row & column) % 2 == 0 ? 1 : -1; }

}  // namespace

OpenRun::OpenRun(const Rig& rig, std::span<const double> look, int rounds)
    : rig_(&rig), look_(look.begin(), look.end()) {
  LUXRIG_CHECK(look.size() == rig.fixtures.size(), "levels of {} fixtures", look.size());
  for (std::size_t f = 0; f < look.size(); ++f)
    if (look[f] > kOff && !rig.fixtures[f].switched) part_.push_back(f);
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
      for (std::size_t k = 0; k < part_.size(); ++k) {
        // From one extreme to the other is the largest step. What a limit leaves no room for goes down only.
        const double most = rig.max_level(rig.fixtures[part_[k]]);
        const double middle = std::min(look_[part_[k]], most / (1 + kLargestStep / 2));
        level[part_[k]] = middle * (1 + kLargestStep / 2 * hadamard(row, k + 1));
      }
      plan_.push_back(std::move(level));
    }
  }
}

void OpenRun::take(std::span<const double> sent, std::span<const std::optional<SteadyReading>> readings) {
  LUXRIG_CHECK(taken_.size() < plan_.size() && sent.size() == look_.size() && readings.size() == rig_->luxmeters.size(),
               "step {} of {}: {} levels, {} readings", taken_.size(), plan_.size(), sent.size(), readings.size());
  taken_.push_back({{sent.begin(), sent.end()}, {readings.begin(), readings.end()}});
}

std::optional<std::vector<LightEstimate>> OpenRun::lights_at(std::size_t luxmeter,
                                                             std::span<const LampCurve> curves) const {
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
      share(k, j) = share_at_level(curves[f].of_level, taken.sent[f]) / share_at_level(curves[f].of_level, look_[f]);
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

std::vector<LightReading> OpenRun::readings(std::span<const LampCurve> curves) const {
  LUXRIG_CHECK(curves.size() == look_.size(), "curves of {} fixtures", curves.size());
  std::vector<LightReading> readings;
  for (std::size_t m = 0; m < rig_->luxmeters.size(); ++m) {
    const auto lights = lights_at(m, curves);
    if (!lights) continue;
    for (std::size_t k = 0; k < part_.size(); ++k) {
      LightReading reading;
      reading.receiver = rig_->points.size() + m;
      reading.meter = m;
      reading.lux = (*lights)[k].lux;
      reading.standard_error_lx = std::max((*lights)[k].standard_error_lx, 1e-6);
      reading.level.setZero(static_cast<Index>(look_.size()));
      reading.level[static_cast<Index>(part_[k])] = share_at_level(curves[part_[k]].of_level, look_[part_[k]]);
      readings.push_back(std::move(reading));
    }
  }
  return readings;
}

}  // namespace luxrig
