/// GainEstimator: readings against the model as stated, ignoring everything learned.

#include <algorithm>
#include <cmath>

#include "core/estimation/gain_estimator.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

}  // namespace

double GainEstimator::stated_lux(std::size_t luxmeter, std::span<const double> level) const {
  return prior_gain_ * meter_.row(static_cast<Index>(luxmeter)).dot(as_given(level));
}

double GainEstimator::curve_error_at_meter(std::size_t luxmeter, std::span<const double> from,
                                           std::span<const double> to) const {
  const auto i = static_cast<Index>(luxmeter);
  const VectorXd begin = as_given(from), end = as_given(to);
  double lux = 0, uncertain_lx = 0;
  for (Index j = 0; j < end.size(); ++j) {
    const double given_lx = meter_(i, j) * std::max(begin[j], end[j]);
    lux += meter_(i, j) * end[j];
    if (j >= fixtures()) {
      uncertain_lx += given_lx;  // all daylight is uncertain
    } else if (begin[j] != end[j]) {
      uncertain_lx +=
          given_lx * kCurveError *
          (begin[j] > 0 && end[j] > 0 ? std::min(kFarthestStep, std::abs(std::log(end[j] / begin[j]))) : kFarthestStep);
    }
  }
  return lux > 0 ? uncertain_lx / lux : kFarthestStep;
}

std::optional<GainEstimator::CommonScale> GainEstimator::common_scale(std::span<const LuxReading> readings,
                                                                      std::span<const double> level) const {
  const VectorXd at = as_given(level);
  std::vector<double> log_ratio;
  MatrixXd share(static_cast<Index>(readings.size()), at.size());  // of each fixture in the model's light at each meter
  VectorXd alone(static_cast<Index>(readings.size()));             // variance that meters do not share
  for (const LuxReading& reading : readings) {
    const auto i = static_cast<Index>(reading.luxmeter);
    const double stated_lx = stated_lux(reading.luxmeter, level);
    if (!(stated_lx > 4 * kDark_lx) || !(reading.lux > 0)) continue;
    const auto k = static_cast<Index>(log_ratio.size());
    log_ratio.push_back(std::log(reading.lux / stated_lx));
    share.row(k) = meter_.row(i).cwiseProduct(at.transpose()) * prior_gain_ / stated_lx;
    const double tolerance = luxmeters_[reading.luxmeter].tolerance;
    alone[k] = tolerance * tolerance / 3 + kRepeatability * kRepeatability;  // evenly distributed over ± tolerance
    for (Index j = 0; j < at.size(); ++j) {
      if (!(meter_(i, j) > 0)) continue;
      const double transport = meter_error_(i, j) / meter_(i, j);
      const double curve =
          j < fixtures() && at[j] > 0 ? kCurveError / 2 * std::min(kFarthestStep, std::abs(std::log(at[j]))) : 0;
      alone[k] +=
          share(k, j) * share(k, j) * (prior_local_sd_[j] * prior_local_sd_[j] + transport * transport + curve * curve);
    }
  }
  const auto meters = static_cast<Index>(log_ratio.size());
  if (meters < 2) return std::nullopt;
  const VectorXd mean_share = share.topRows(meters).colwise().mean().transpose();
  const double shared = prior_gain_sd_.transpose().cwiseProduct(mean_share).squaredNorm();
  const double count = static_cast<double>(meters);
  // Variance of the mean, times π/2 for the median of normal errors.
  const double variance = 0.5 * static_cast<double>(EIGEN_PI) * (alone.head(meters).sum() / (count * count) + shared);
  std::sort(log_ratio.begin(), log_ratio.end());
  const std::size_t middle = log_ratio.size() / 2;
  const double median = log_ratio.size() % 2 ? log_ratio[middle] : 0.5 * (log_ratio[middle - 1] + log_ratio[middle]);
  return CommonScale{median, std::sqrt(variance)};
}

}  // namespace luxrig
