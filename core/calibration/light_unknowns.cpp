#include "core/calibration/light_unknowns.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kRounds = 12;
constexpr double kArrived = 1e-9;
/// Student's t with so many degrees of freedom: a reading 6 standard errors off weighs a ninth.
constexpr double kFreedom = 4;

/// Of a variance that is left, over that before: above, readings have told nothing.
constexpr double kSaysSomething = 0.9;

double weight_of(double surprise) { return std::min(1.0, (kFreedom + 1) / (kFreedom + surprise * surprise)); }

}  // namespace

LightUnknowns::LightUnknowns(LightSensitivity sensitivity, LightPriors priors)
    : light_(std::move(sensitivity)), priors_(std::move(priors)) {
  check(light_);
  VectorXd sd = VectorXd::Zero(unknowns());
  for (Index j = 0; j < fixtures(); ++j) {
    sd.segment(mount_at(j), 3).setConstant(priors_.position_m);
    sd.segment(mount_at(j) + 3, 3).setConstant(priors_.angle_rad);
  }
  sd.segment(paint_at(0), materials()).setConstant(priors_.reflectance);
  sd.segment(meter_at(0), meters()) = priors_.log_meter;
  sd.tail(priors_.stray.size()) = priors_.stray;
  prior_variance_ = sd.cwiseAbs2();
  take_output_priors();
  value_.setZero(unknowns());
  taken_at_.setZero(kMountUnknowns * fixtures());
  estimate();
}

void LightUnknowns::take_output_priors() {
  for (Index f = 0; f < fixtures(); ++f) {
    const double of_dimmer = priors_.read_at.size() > 0 ? priors_.dimmer_exponent * std::log(priors_.read_at[f]) : 0;
    prior_variance_[f] = priors_.log_output * priors_.log_output + of_dimmer * of_dimmer;
  }
}

void LightUnknowns::read_at(const VectorXd& level) {
  LUXRIG_CHECK(level.size() == fixtures() && readings_.empty(), "levels of {} of {} fixtures, {} readings",
               level.size(), fixtures(), readings_.size());
  priors_.read_at = level;
  take_output_priors();
  estimate();
}

void LightUnknowns::check(const LightSensitivity& sensitivity) const {
  LUXRIG_CHECK(static_cast<Index>(sensitivity.mount.size()) == fixtures(), "{} mounts of {} fixtures",
               sensitivity.mount.size(), fixtures());
  LUXRIG_CHECK(sensitivity.lux.rows() == light_.lux.rows() && sensitivity.lux.cols() == light_.lux.cols() &&
                   sensitivity.paint.size() == light_.paint.size(),
               "another rig's light");
  LUXRIG_CHECK(sensitivity.doubtful.size() == 0 || (sensitivity.doubtful.rows() == sensitivity.lux.rows() &&
                                                    sensitivity.doubtful.cols() == sensitivity.lux.cols()),
               "another rig's doubtful light");
  LUXRIG_CHECK(sensitivity.paint_taken_at.size() == 0 ||
                   sensitivity.paint_taken_at.size() == static_cast<Index>(sensitivity.paint.size()),
               "{} reflectances of {} materials", sensitivity.paint_taken_at.size(), sensitivity.paint.size());
  LUXRIG_CHECK(sensitivity.place.empty() || static_cast<Index>(sensitivity.place.size()) == light_.lux.rows(),
               "{} places of {} receivers", sensitivity.place.size(), light_.lux.rows());
}

void LightUnknowns::check(const Showing& showing) const {
  const auto known = [](std::size_t entry, Index count) { return static_cast<Index>(entry) < count; };
  bool fine = showing.of_lamp.empty() || static_cast<Index>(showing.of_lamp.size()) == fixtures();
  for (const std::size_t of : showing.of_lamp) fine = fine && known(of, meters());
  for (const Showing::Part& part : showing.factors) fine = fine && known(part.of, meters());
  for (const Showing::Part& part : showing.stray) fine = fine && known(part.of, priors_.stray.size());
  LUXRIG_CHECK(fine && (!showing.paint || known(*showing.paint, materials())),
               "a camera's parts are not of these priors: {} instruments, {} shares of stray light, {} materials",
               meters(), priors_.stray.size(), materials());
}

std::size_t LightUnknowns::place_of(std::size_t receiver) const {
  return light_.place.empty() ? receiver : light_.place[receiver];
}

double LightUnknowns::shown_share(const Showing& showing) const {
  double log_share = 0;
  for (const Showing::Part& part : showing.factors)
    log_share += part.weight * value_[meter_at(static_cast<Index>(part.of))];
  return std::exp(log_share) * (showing.paint ? paint(*showing.paint) : 1);
}

double LightUnknowns::lamp_share(const Showing& showing, Index fixture) const {
  if (showing.of_lamp.empty()) return 1;
  return meter_gain(showing.of_lamp[static_cast<std::size_t>(fixture)]);
}

double LightUnknowns::light_and_slope(const LightQuery& query, double fixed_lx, VectorXd& slope) const {
  slope.setZero(unknowns());
  const Showing& showing = query.showing;
  const auto r = static_cast<Index>(query.receiver);
  double lux = 0;
  for (Index j = 0; j < fixtures(); ++j) {
    const double level = query.level[j];
    if (level == 0) continue;
    const auto mount = light_.mount[static_cast<std::size_t>(j)].row(r);
    double of_lamp = light_.lux(r, j) + mount.dot(value_.segment(mount_at(j), kMountUnknowns) -
                                                  taken_at_.segment(kMountUnknowns * j, kMountUnknowns));
    for (Index p = 0; p < materials(); ++p)
      of_lamp += light_.paint[static_cast<std::size_t>(p)](r, j) *
                 (value_[paint_at(p)] - (light_.paint_taken_at.size() > 0 ? light_.paint_taken_at[p] : 0.0));
    const double full = level * std::exp(value_[j]) * lamp_share(showing, j);
    lux += full * of_lamp;
    slope[j] = full * of_lamp;
    if (!showing.of_lamp.empty())
      slope[meter_at(static_cast<Index>(showing.of_lamp[static_cast<std::size_t>(j)]))] += full * of_lamp;
    slope.segment(mount_at(j), kMountUnknowns) = full * mount.transpose();
    for (Index p = 0; p < materials(); ++p)
      slope[paint_at(p)] += full * light_.paint[static_cast<std::size_t>(p)](r, j);
  }
  double gain = shown_share(showing);
  if (query.meter) gain *= meter_gain(*query.meter);
  slope *= gain;
  if (query.meter) slope[meter_at(static_cast<Index>(*query.meter))] += gain * lux;
  for (const Showing::Part& part : showing.factors)
    slope[meter_at(static_cast<Index>(part.of))] += part.weight * gain * lux;
  if (showing.paint) slope[paint_at(static_cast<Index>(*showing.paint))] += gain * lux / paint(*showing.paint);
  double shown = gain * lux + fixed_lx;
  for (const Showing::Part& part : showing.stray) {
    slope[stray_at(static_cast<Index>(part.of))] += part.weight;
    shown += part.weight * stray(part.of);
  }
  return shown;
}

double LightUnknowns::rest_covariance(const LightQuery& a, const LightQuery& b) const {
  if (place_of(a.receiver) != place_of(b.receiver)) return 0;
  const MatrixXd& lux = light_.doubtful.size() > 0 ? light_.doubtful : light_.lux;
  double sum_lx2 = 0;
  for (Index j = 0; j < fixtures(); ++j)
    if (a.level[j] != 0 && b.level[j] != 0)
      sum_lx2 += lux(static_cast<Index>(a.receiver), j) * lux(static_cast<Index>(b.receiver), j) * a.level[j] *
                 b.level[j] * lamp_share(a.showing, j) * lamp_share(b.showing, j);
  return sum_lx2 * shown_share(a.showing) * shown_share(b.showing) * priors_.rest_share * priors_.rest_share;
}

void LightUnknowns::learn(std::span<const LightReading> readings) {
  for (const LightReading& reading : readings) {
    LUXRIG_CHECK(reading.level.size() == fixtures() && static_cast<Index>(reading.meter) < meters() &&
                     static_cast<Index>(reading.receiver) < light_.lux.rows(),
                 "a reading of meter {} at receiver {} under {} levels", reading.meter, reading.receiver,
                 reading.level.size());
    LUXRIG_CHECK(reading.standard_error_lx > 0, "a reading with an error of {} lx", reading.standard_error_lx);
    readings_.push_back(reading);
    check(reading.showing);
    asked_.push_back({reading.receiver, reading.level, reading.meter, reading.showing});
  }
  estimate();
}

void LightUnknowns::relinearise(LightSensitivity sensitivity) {
  check(sensitivity);
  light_ = std::move(sensitivity);
  for (Index j = 0; j < fixtures(); ++j)
    taken_at_.segment(kMountUnknowns * j, kMountUnknowns) = value_.segment(mount_at(j), kMountUnknowns);
  estimate();
}

void LightUnknowns::estimate() {
  const auto count = static_cast<Index>(readings_.size());
  surprise_.assign(readings_.size(), 0);
  slopes_.resize(count, unknowns());
  posterior_ = prior_variance_.asDiagonal();
  const VectorXd prior_sd = prior_variance_.cwiseSqrt();
  std::vector<std::size_t> places;
  for (const LightQuery& asked : asked_) places.push_back(place_of(asked.receiver));
  const auto rest = [this](Index a, Index b) {
    return rest_covariance(asked_[static_cast<std::size_t>(a)], asked_[static_cast<std::size_t>(b)]);
  };
  VectorXd slope, off(count), variance(count);
  for (int round = 0; round < kRounds && count > 0; ++round) {
    for (Index k = 0; k < count; ++k) {
      const LightReading& reading = readings_[static_cast<std::size_t>(k)];
      off[k] = reading.lux - light_and_slope(asked_[static_cast<std::size_t>(k)], reading.fixed_lx, slope);
      slopes_.row(k) = slope;
      variance[k] =
          reading.standard_error_lx * reading.standard_error_lx / weight_of(surprise_[static_cast<std::size_t>(k)]);
    }
    off += slopes_ * value_;
    noise_ = ReadingNoise(places, rest, variance);
    // In units of the prior: well scaled, and an unknown that is known beforehand has a row of 0.
    const MatrixXd scaled = slopes_ * prior_sd.asDiagonal(), weighed = noise_.solve(scaled);
    MatrixXd information = MatrixXd::Identity(unknowns(), unknowns());
    information.noalias() += scaled.transpose() * weighed;
    const MatrixXd inverse = information.llt().solve(MatrixXd::Identity(unknowns(), unknowns()));
    posterior_ = prior_sd.asDiagonal() * inverse * prior_sd.asDiagonal();
    const VectorXd found = prior_sd.cwiseProduct(inverse * (weighed.transpose() * off));
    left_ = noise_.solve(off - slopes_ * found);
    const VectorXd step = found - value_;
    // What of each reading is left to its noise.
    for (Index k = 0; k < count; ++k)
      surprise_[static_cast<std::size_t>(k)] =
          variance[k] * left_[k] / readings_[static_cast<std::size_t>(k)].standard_error_lx;
    // Gains are logarithms: a step of 1 is a factor of e, and the linear model says nothing there.
    value_ += step * std::min(1.0, 1 / std::max(1e-300, step.cwiseAbs().maxCoeff()));
    if (step.cwiseAbs().maxCoeff() < kArrived) break;
  }
}

VectorXd LightUnknowns::rest_with_readings(const LightQuery& query) const {
  VectorXd rest = VectorXd::Zero(static_cast<Index>(readings_.size()));
  for (const Index k : noise_.at(place_of(query.receiver)))
    rest[k] = rest_covariance(query, asked_[static_cast<std::size_t>(k)]);
  return rest;
}

MatrixXd LightUnknowns::covariance(std::span<const LightQuery> queries) const {
  const auto count = static_cast<Index>(queries.size());
  MatrixXd slopes(count, unknowns()), rest(static_cast<Index>(readings_.size()), count), covariance(count, count);
  VectorXd slope;
  for (Index q = 0; q < count; ++q) {
    const LightQuery& query = queries[static_cast<std::size_t>(q)];
    (void)light_and_slope(query, 0, slope);
    slopes.row(q) = slope;
    rest.col(q) = rest_with_readings(query);
    for (Index other = 0; other <= q; ++other)
      covariance(q, other) = covariance(other, q) = rest_covariance(query, queries[static_cast<std::size_t>(other)]);
  }
  if (!readings_.empty()) {
    // What readings at its place say of a query's rest, if the unknowns are as found; then, what these still may be.
    const MatrixXd told = noise_.solve(rest);
    covariance -= rest.transpose() * told;
    slopes -= told.transpose() * slopes_;
  }
  return covariance + slopes * posterior_ * slopes.transpose();
}

LightEstimate LightUnknowns::at(std::size_t receiver, const VectorXd& level) const {
  const LightQuery query{receiver, level, {}, {}};
  VectorXd slope;
  LightEstimate estimate;
  estimate.lux = light_and_slope(query, 0, slope);
  if (!readings_.empty()) estimate.lux += rest_with_readings(query).dot(left_);
  const auto [bent_lx, bent_variance] = of_bend(static_cast<Index>(receiver), level);
  estimate.lux += bent_lx;
  estimate.standard_error_lx = std::sqrt(std::max(0.0, covariance({&query, 1})(0, 0) + bent_variance));
  return estimate;
}

LightBudget LightUnknowns::budget(std::size_t receiver, const VectorXd& level) const {
  const LightQuery query{receiver, level, {}, {}};
  VectorXd left;  // slope of the estimate's error by each unknown
  (void)light_and_slope(query, 0, left);
  LightBudget budget;
  budget.rest = rest_covariance(query, query);
  if (!readings_.empty()) {
    const VectorXd rest = rest_with_readings(query), told = noise_.solve(rest);
    // The estimate is this sum of the readings.
    const VectorXd weight = told + noise_.solve(slopes_ * (posterior_ * (left - slopes_.transpose() * told)));
    left -= slopes_.transpose() * weight;
    budget.noise = noise_.noise_variance(weight);
    budget.rest += noise_.rest_variance(weight) - 2 * weight.dot(rest);
  }
  const VectorXd variance = left.cwiseAbs2().cwiseProduct(prior_variance_);
  budget.output = variance.head(fixtures()).sum();
  budget.mount = variance.segment(mount_at(0), kMountUnknowns * fixtures()).sum();
  budget.paint = variance.segment(paint_at(0), materials()).sum();
  budget.instrument = variance.segment(meter_at(0), meters());
  budget.stray = variance.tail(priors_.stray.size());
  return budget;
}

std::pair<double, double> LightUnknowns::of_bend(Index receiver, const VectorXd& level) const {
  double lux = 0, variance = 0;
  if (light_.bend.empty()) return {lux, variance};
  for (Index j = 0; j < fixtures(); ++j) {
    if (level[j] == 0) continue;
    using Square = Eigen::Matrix<double, kMountUnknowns, kMountUnknowns, Eigen::RowMajor>;
    const Eigen::Matrix<double, 1, kMountUnknowns* kMountUnknowns> row =
        light_.bend[static_cast<std::size_t>(j)].row(receiver);
    const Index first = mount_at(j);
    const Square spread =
        Eigen::Map<const Square>(row.data()) * posterior_.block<kMountUnknowns, kMountUnknowns>(first, first);
    const double full = level[j] * std::exp(value_[j]);
    lux += 0.5 * full * spread.trace();
    variance += 0.5 * full * full * (spread * spread).trace();
  }
  return {lux, std::max(0.0, variance)};
}

double LightUnknowns::variance_of(Index unknown) const { return std::max(0.0, posterior_(unknown, unknown)); }

double LightUnknowns::gain(std::size_t fixture) const { return std::exp(value_[static_cast<Index>(fixture)]); }

double LightUnknowns::gain_standard_error(std::size_t fixture) const {
  return gain(fixture) * std::sqrt(variance_of(static_cast<Index>(fixture)));
}

double LightUnknowns::read_at(std::size_t fixture) const {
  return priors_.read_at.size() > 0 ? priors_.read_at[static_cast<Index>(fixture)] : 1;
}

bool LightUnknowns::gain_is_measured(std::size_t fixture) const {
  const auto f = static_cast<Index>(fixture);
  return variance_of(f) < kSaysSomething * prior_variance_[f];
}

VectorXd LightUnknowns::mount(std::size_t fixture) const {
  return value_.segment(mount_at(static_cast<Index>(fixture)), kMountUnknowns);
}

VectorXd LightUnknowns::mount_standard_error(std::size_t fixture) const {
  return posterior_.diagonal().segment(mount_at(static_cast<Index>(fixture)), kMountUnknowns).cwiseMax(0).cwiseSqrt();
}

double LightUnknowns::paint(std::size_t material) const { return 1 + value_[paint_at(static_cast<Index>(material))]; }

double LightUnknowns::paint_standard_error(std::size_t material) const {
  return std::sqrt(variance_of(paint_at(static_cast<Index>(material))));
}

double LightUnknowns::meter_gain(std::size_t meter) const {
  return std::exp(value_[meter_at(static_cast<Index>(meter))]);
}

double LightUnknowns::meter_gain_standard_error(std::size_t meter) const {
  return meter_gain(meter) * std::sqrt(variance_of(meter_at(static_cast<Index>(meter))));
}

double LightUnknowns::stray(std::size_t entry) const { return value_[stray_at(static_cast<Index>(entry))]; }

double LightUnknowns::stray_standard_error(std::size_t entry) const {
  return std::sqrt(variance_of(stray_at(static_cast<Index>(entry))));
}

}  // namespace luxrig
