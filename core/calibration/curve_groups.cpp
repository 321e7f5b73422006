#include "core/calibration/curve_groups.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A lamp is read together with others if its share is then known so well, or so many times as well as alone.
constexpr double kShareKnown = 0.008, kTimesAlone = 1.5;
/// Below, a meter's last digit is more than its noise.
constexpr double kLastDigit_lx = 0.02, kAboveLastDigit_lx = 2;
/// Of a meter that no lamp alone lights well.
constexpr double kUsualNoise = 0.01;
/// Weights follow from shares, and shares from weights; three times is enough for either.
constexpr int kPasses = 3;

/// Per luxmeter: standard error of a reading as a share of it, as its brighter readings have it.
VectorXd noise_of_meters(const LightAlone& alone) {
  VectorXd noise(alone.lux.rows());
  for (Index m = 0; m < noise.size(); ++m) {
    std::vector<double> shares;
    for (Index f = 0; f < alone.lux.cols(); ++f)
      if (alone.lux(m, f) > kAboveLastDigit_lx) shares.push_back(alone.standard_error_lx(m, f) / alone.lux(m, f));
    noise[m] = kUsualNoise;
    if (shares.empty()) continue;
    const auto middle = shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2);
    std::nth_element(shares.begin(), middle, shares.end());
    noise[m] = *middle;
  }
  return noise;
}

/// Rows of meters that have read all these lamps.
std::vector<Index> meters_of(const LightAlone& alone, std::span<const std::size_t> lamps) {
  std::vector<Index> meters;
  for (Index m = 0; m < alone.lux.rows(); ++m)
    if (std::all_of(lamps.begin(), lamps.end(),
                    [&](std::size_t f) { return std::isfinite(alone.lux(m, static_cast<Index>(f))); }))
      meters.push_back(m);
  return meters;
}

/// Light of these lamps at these meters over the meters' errors.
MatrixXd weighted(const LightAlone& alone, std::span<const std::size_t> lamps, const std::vector<Index>& meters,
                  const VectorXd& error_lx) {
  MatrixXd light(static_cast<Index>(meters.size()), static_cast<Index>(lamps.size()));
  for (Index m = 0; m < light.rows(); ++m)
    for (Index k = 0; k < light.cols(); ++k)
      light(m, k) =
          alone.lux(meters[static_cast<std::size_t>(m)], static_cast<Index>(lamps[static_cast<std::size_t>(k)])) /
          error_lx[m];
  return light;
}

/// Per lamp; infinite if the meters do not tell these lamps apart.
VectorXd errors_of_shares(const MatrixXd& light) {
  const Index lamps = light.cols();
  VectorXd errors = VectorXd::Constant(lamps, std::numeric_limits<double>::infinity());
  if (light.rows() < lamps) return errors;
  const Eigen::LDLT<MatrixXd> normal(light.transpose() * light);
  if (normal.info() != Eigen::Success || !(normal.rcond() > 1e-12)) return errors;
  const VectorXd variance = normal.solve(MatrixXd::Identity(lamps, lamps)).diagonal();
  for (Index k = 0; k < lamps; ++k)
    if (variance[k] > 0) errors[k] = std::sqrt(variance[k]);
  return errors;
}

/// Per lamp, the error of its share if all of these are lit as when alone.
VectorXd expected_errors(const LightAlone& alone, const VectorXd& noise, std::span<const std::size_t> lamps) {
  const std::vector<Index> meters = meters_of(alone, lamps);
  VectorXd error_lx(static_cast<Index>(meters.size()));
  for (Index m = 0; m < error_lx.size(); ++m) {
    const Index row = meters[static_cast<std::size_t>(m)];
    double lux = 0;
    for (const std::size_t f : lamps) lux += std::max(0.0, alone.lux(row, static_cast<Index>(f)));
    error_lx[m] = std::hypot(noise[row] * lux, kLastDigit_lx);
  }
  return errors_of_shares(weighted(alone, lamps, meters, error_lx));
}

}  // namespace

std::vector<std::vector<std::size_t>> curve_groups(const LightAlone& alone,
                                                   const std::function<bool(std::span<const std::size_t>)>& may) {
  const VectorXd noise = noise_of_meters(alone);
  const auto lamps = static_cast<std::size_t>(alone.lux.cols());
  std::vector<double> error_alone(lamps);
  std::vector<std::size_t> order;
  for (std::size_t f = 0; f < lamps; ++f) {
    error_alone[f] = expected_errors(alone, noise, std::span(&f, 1))[0];
    if (std::isfinite(error_alone[f])) order.push_back(f);
  }
  // Those that are seen best first: they disturb each other least.
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return error_alone[a] < error_alone[b]; });
  std::vector<std::vector<std::size_t>> groups;
  for (const std::size_t lamp : order) {
    const auto takes = [&](std::vector<std::size_t> group) {
      group.push_back(lamp);
      if (group.size() > static_cast<std::size_t>(alone.lux.rows()) || !may(group)) return false;
      const VectorXd errors = expected_errors(alone, noise, group);
      for (std::size_t k = 0; k < group.size(); ++k)
        if (!(errors[static_cast<Index>(k)] <= std::max(kShareKnown, kTimesAlone * error_alone[group[k]])))
          return false;
      return true;
    };
    const auto group = std::find_if(groups.begin(), groups.end(), takes);
    if (group == groups.end())
      groups.push_back({lamp});
    else
      group->push_back(lamp);
  }
  return groups;
}

std::vector<ShareOfAlone> shares_of(const LightAlone& alone, std::span<const std::size_t> lamps,
                                    std::span<const std::optional<SteadyReading>> above_dark) {
  LUXRIG_CHECK(static_cast<Index>(above_dark.size()) == alone.lux.rows(), "{} readings of {} luxmeters",
               above_dark.size(), alone.lux.rows());
  std::vector<Index> meters = meters_of(alone, lamps);
  std::erase_if(meters, [&](Index m) { return !above_dark[static_cast<std::size_t>(m)]; });
  const auto rows = static_cast<Index>(meters.size());
  const auto error_alone_lx = [&](Index m, Index k) {
    return alone.standard_error_lx(meters[static_cast<std::size_t>(m)],
                                   static_cast<Index>(lamps[static_cast<std::size_t>(k)]));
  };
  VectorXd lux(rows), error_lx(rows);
  for (Index m = 0; m < rows; ++m) {
    const SteadyReading& reading = *above_dark[static_cast<std::size_t>(meters[static_cast<std::size_t>(m)])];
    lux[m] = reading.lux;
    error_lx[m] = std::max(reading.standard_error_lx, 1e-6);
  }
  // What each lamp gives alone has an error too, which counts by its share. All are bright until they are known.
  VectorXd share = VectorXd::Ones(static_cast<Index>(lamps.size()));
  MatrixXd from;  // shares = from · lux
  for (int pass = 0; pass < kPasses; ++pass) {
    VectorXd error = error_lx;
    for (Index m = 0; m < rows; ++m)
      for (Index k = 0; k < share.size(); ++k) error[m] = std::hypot(error[m], share[k] * error_alone_lx(m, k));
    const MatrixXd light = weighted(alone, lamps, meters, error);
    if (!errors_of_shares(light).allFinite()) return {};
    from = (light.transpose() * light).ldlt().solve(light.transpose()) * error.cwiseInverse().asDiagonal();
    share = from * lux;
  }
  std::vector<ShareOfAlone> shares;
  for (Index k = 0; k < share.size(); ++k) {
    double variance = 0;
    for (Index m = 0; m < rows; ++m) {
      double error = error_lx[m];
      for (Index other = 0; other < share.size(); ++other)
        if (other != k) error = std::hypot(error, share[other] * error_alone_lx(m, other));
      variance += from(k, m) * from(k, m) * error * error;
    }
    shares.push_back({share[k], std::sqrt(variance)});
  }
  return shares;
}

}  // namespace luxrig
