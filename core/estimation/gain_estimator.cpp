#include "core/estimation/gain_estimator.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/check.h"
#include "core/output/output_program.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr double kMinLocalSd = 0.02;  ///< a lower bound, even if a rig trusts its model fully
/// A value that stays constant to the last bit while the light changes by this share is stuck. The share is no larger
/// than the noise of a reading that limits allow for, so that a value frozen during a fade cannot carry light past
/// them.
constexpr double kStuckChange = 0.01;
constexpr double kSameLevels = 0.005;     ///< evidence at levels closer than this share replaces the old
constexpr std::size_t kMaxEvidence = 6;   ///< per meter; older evidence is dropped

/// |ln(b/a)|, at most 1; 1 where one of them is 0.
double log_ratio(double a, double b) {
  if (a == b) return 0;
  return a > 0 && b > 0 ? std::min(1.0, std::abs(std::log(b / a))) : 1.0;
}

MatrixXd matrix_or_zero(const MatrixXd& matrix, Index rows, Index columns, const char* what) {
  if (matrix.size() == 0) return MatrixXd::Zero(rows, columns);
  LUXRIG_CHECK(matrix.rows() == rows && matrix.cols() == columns, "{} is {} × {}, the rig needs {} × {}", what,
               matrix.rows(), matrix.cols(), rows, columns);
  return matrix;
}

/// With one more column, unless it is not given at all.
MatrixXd joined(const MatrixXd& lit, const VectorXd& fixed, bool any_fixed, const char* what) {
  if (!any_fixed) return lit;
  MatrixXd all(lit.rows(), lit.cols() + 1);
  all << lit, matrix_or_zero(fixed, lit.rows(), 1, what);
  return all;
}

}  // namespace

GainEstimator::GainEstimator(const Rig& rig, const LightModel& model)
    : luxmeters_(rig.luxmeters),
      points_(rig.points),
      meter_of_point_(rig.points.size()),
      over_(rig.luxmeters.size()),
      meters_(rig.luxmeters.size()) {
  const auto fixtures = static_cast<Index>(rig.fixtures.size()), points = static_cast<Index>(points_.size()),
             meters = static_cast<Index>(luxmeters_.size());
  const bool fixed = model.point_fixed_lx.size() > 0 || model.meter_fixed_lx.size() > 0;
  point_ = joined(matrix_or_zero(model.point_lux_per_level, points, fixtures, "point_lux_per_level"),
                  model.point_fixed_lx, fixed, "point_fixed_lx");
  meter_ = joined(matrix_or_zero(model.meter_lux_per_level, meters, fixtures, "meter_lux_per_level"),
                  model.meter_fixed_lx, fixed, "meter_fixed_lx");
  const MatrixXd traced_error = matrix_or_zero(model.point_standard_error, points, fixtures, "point_standard_error"),
                 known_error = matrix_or_zero(model.point_known_error, points, fixtures, "point_known_error");
  point_error_ = joined((traced_error.cwiseAbs2() + known_error.cwiseAbs2()).cwiseSqrt(), model.point_fixed_error_lx,
                        fixed, "point_fixed_error_lx");
  meter_error_ = joined(matrix_or_zero(model.meter_standard_error, meters, fixtures, "meter_standard_error"),
                        model.meter_fixed_error_lx, fixed, "meter_fixed_error_lx");
  any_aim_ = model.any_aim_lux_per_level;
  LUXRIG_CHECK(any_aim_.size() == 0 || (any_aim_.rows() == points && any_aim_.cols() == fixtures),
               "any_aim_lux_per_level is {} × {}, the rig {} × {}", any_aim_.rows(), any_aim_.cols(), points, fixtures);
  max_level_.resize(fixtures);
  watts_.resize(fixtures);
  max_watts_ = rig.limits.max_watts.value_or(std::numeric_limits<double>::infinity());
  for (Index j = 0; j < fixtures; ++j) {
    const Fixture& fixture = rig.fixtures[static_cast<std::size_t>(j)];
    max_level_[j] = rig.max_level(fixture);
    watts_[j] = rig.limits.max_watts ? rig.luminaires[fixture.luminaire].watts.value_or(0) : 0;
    housing_.push_back(fixture.housing.value_or(static_cast<std::size_t>(j)));
    dimmers_.emplace_back(fixture.dimmer_curve, !fixture.measured_curve.empty());
    fixture_names_.push_back(fixture.name);
  }
  for (std::size_t i = 0; i < luxmeters_.size(); ++i)
    if (luxmeters_[i].point && !meter_of_point_[*luxmeters_[i].point]) meter_of_point_[*luxmeters_[i].point] = i;
  switched_ = switched_fixtures(rig);
  held_.assign(rig.fixtures.size(), 0);
  gain_min_ = rig.control.gain_min;
  gain_max_ = rig.control.gain_max;
  const double margin = std::clamp(rig.limits.open_loop_margin, 0.0, 0.9);
  local_ = 1 / (1 - margin);
  doubted_.setConstant(meters, meter_.cols(), false);
  prior_gain_ = std::clamp(1.0, gain_min_, gain_max_);
  prior_gain_sd_.setConstant(meter_.cols(), (gain_max_ - gain_min_) / 4);
  prior_local_sd_.setConstant(meter_.cols(), std::max(kMinLocalSd, margin / 3));
  const auto state = [&](const VectorXd& stated, RowVectorXd& sd, const char* what) {
    if (stated.size() == 0) return;
    LUXRIG_CHECK(stated.size() == fixtures, "{} of {} fixtures, the rig has {}", what, stated.size(), fixtures);
    for (Index j = 0; j < fixtures; ++j)
      if (std::isfinite(stated[j])) sd[j] = stated[j];
  };
  state(model.gain_sd, prior_gain_sd_, "gain_sd");
  state(model.local_sd, prior_local_sd_, "local_sd");
  estimate(Time{});
}

VectorXd GainEstimator::as_given(std::span<const double> level) const {
  LUXRIG_CHECK(static_cast<Index>(level.size()) == fixtures(), "{} levels, {} fixtures", level.size(), fixtures());
  VectorXd all = VectorXd::Ones(meter_.cols());
  all.head(fixtures()) = Eigen::Map<const VectorXd>(level.data(), fixtures());
  return all;
}

VectorXd GainEstimator::vector_of(std::span<const double> level) const {
  VectorXd all = as_given(level);
  for (std::size_t j = 0; j < lost_.size(); ++j)
    if (lost_[j]) all[static_cast<Index>(j)] = lost_[j]->level;
  return all;
}

GainEstimator::Row GainEstimator::row_of_meter(std::size_t luxmeter) const {
  const auto i = static_cast<Index>(luxmeter);
  return {meter_.row(i), meter_error_.row(i), factor_.row(i), factor_error_.row(i), luxmeter, 0};
}

GainEstimator::Row GainEstimator::row_of_point(std::size_t point) const {
  const auto i = static_cast<Index>(point);
  Row row;
  if (confirmed(point)) {
    row = row_of_meter(*meter_of_point_[point]);
  } else {
    const RowVectorXd error = (gain_error_.array().square().transpose() + prior_local_sd_.array().square()).sqrt();
    row = {point_.row(i), point_error_.row(i), gain_.transpose(), error, std::nullopt, 0};
  }
  row.unseen_lx = unseen_lux(point, row);
  return row;
}

const GainEstimator::Evidence* GainEstimator::latest(std::size_t luxmeter) const {
  for (auto it = evidence_.rbegin(); it != evidence_.rend(); ++it)
    if (it->luxmeter == luxmeter) return &*it;
  return nullptr;
}

bool GainEstimator::contradicted(std::size_t luxmeter) const {
  const std::optional<Evidence>& over = over_[luxmeter];
  const Evidence* lesson = latest(luxmeter);
  return over && !(lesson && lesson->taken > over->taken);
}

double GainEstimator::common_tolerance() const {
  double best = evidence_.empty() ? 0 : 1;
  for (const Evidence& e : evidence_) best = std::min(best, luxmeters_[e.luxmeter].tolerance);
  return best;
}

bool GainEstimator::confirmed(std::size_t point) const {
  return meter_of_point_[point] && latest(*meter_of_point_[point]) != nullptr;
}

/// Limits ask for these at every point, so they are worked out once for all that is known.
void GainEstimator::bound_gains() {
  upper_gain_ = (gain_ + 3 * gain_error_).cwiseMin(gain_max_);
  for (std::size_t m = 0; m < over_.size(); ++m) {
    const auto i = static_cast<Index>(m);
    const bool wrong = contradicted(m);
    for (Index j = 0; j < upper_gain_.size(); ++j)
      if (doubted_(i, j) || (wrong && meter_(i, j) > 0)) upper_gain_[j] = gain_max_;
  }
}

/// Prior covariance of the light at a row, at some levels, with the light behind a reading.
double GainEstimator::covariance(const Row& one, const VectorXd& one_level, const Evidence& other) const {
  const auto i = static_cast<Index>(other.luxmeter);
  const bool same = one.luxmeter == other.luxmeter;
  double sum = 0;
  for (Index j = 0; j < one_level.size(); ++j) {
    const double levels = one_level[j] * other.level[j], lux = one.lux_per_level[j] * meter_(i, j);
    sum += levels * lux * prior_gain_sd_[j] * prior_gain_sd_[j];
    if (same) sum += levels * (lux * prior_local_sd_[j] * prior_local_sd_[j] + one.standard_error[j] * one.standard_error[j]);
  }
  return sum;
}

void GainEstimator::knows_more() {
  static std::atomic<std::uint64_t> newest{0};  // of all estimators: one may replace another
  knowledge_ = ++newest;
}

VectorXd GainEstimator::contradiction_of_lessons(const MatrixXd& covariance, const VectorXd& stated_lux,
                                                 const VectorXd& surprise) const {
  VectorXd contradiction = VectorXd::Ones(meter_.rows());
  for (Index i = 0; i < contradiction.size(); ++i) {
    std::vector<Index> own;
    for (std::size_t k = 0; k < evidence_.size(); ++k)
      if (static_cast<Index>(evidence_[k].luxmeter) == i) own.push_back(static_cast<Index>(k));
    if (own.size() < 2) continue;
    const Eigen::LDLT<MatrixXd> block(covariance(own, own));
    const VectorXd of_meter = surprise(own), scale = stated_lux(own), weighted = block.solve(of_meter);
    const double explained = std::pow(scale.dot(weighted), 2) / scale.dot(block.solve(scale));
    const double chi_squared = of_meter.dot(weighted) - explained;
    contradiction[i] = std::sqrt(std::max(1.0, chi_squared / static_cast<double>(own.size() - 1)));
  }
  return contradiction;
}

void GainEstimator::estimate(Time now) {
  knows_more();
  const Index columns = meter_.cols(), meters = meter_.rows(), count = static_cast<Index>(evidence_.size());
  gain_ = VectorXd::Constant(columns, prior_gain_);
  gain_error_ = prior_gain_sd_.transpose();
  factor_ = MatrixXd::Constant(meters, columns, prior_gain_);
  unexplained_ = VectorXd::Zero(columns);
  factor_beyond_ = MatrixXd::Zero(meters, columns);
  MatrixXd local_variance = prior_local_sd_.cwiseAbs2().replicate(meters, 1);
  for (Index i = 0; i < meters; ++i)
    for (Index j = 0; j < columns; ++j)
      if (meter_(i, j) > 0) local_variance(i, j) += std::pow(meter_error_(i, j) / meter_(i, j), 2);
  factor_error_ = (local_variance.rowwise() + prior_gain_sd_.cwiseAbs2()).cwiseSqrt();
  if (count == 0) return bound_gains();

  MatrixXd light(count, columns);  // H: light of each fixture at each reading, at rated output
  VectorXd surprise(count);
  for (Index k = 0; k < count; ++k) {
    const Evidence& e = evidence_[static_cast<std::size_t>(k)];
    light.row(k) = meter_.row(static_cast<Index>(e.luxmeter)).cwiseProduct(e.level.transpose());
    surprise[k] = e.lux - prior_gain_ * light.row(k).sum();
  }
  MatrixXd total(count, count);
  for (Index k = 0; k < count; ++k) {
    const Evidence& e = evidence_[static_cast<std::size_t>(k)];
    Row row = row_of_meter(e.luxmeter);
    for (Index l = 0; l < count; ++l) total(k, l) = covariance(row, e.level, evidence_[static_cast<std::size_t>(l)]);
    const double expected = std::max(e.lux, prior_gain_ * light.row(k).sum());
    const double minutes = minutes_between(e.taken, now);
    double noise = std::pow(kRepeatability * expected, 2) + std::pow(kDriftPerMinute * minutes * expected, 2) +
                   std::pow(luxmeters_[e.luxmeter].patch.lux_per_count, 2) / 12;
    // At levels other than the present, the dimmer's true curve changes the gain.
    const VectorXd& present = latest(e.luxmeter)->level;
    for (Index j = 0; j < columns; ++j)
      noise += std::pow(light(k, j) * kCurveError * log_ratio(e.level[j], present[j]), 2);
    total(k, k) += std::max(noise, 1e-300);
  }
  innovation_.compute(total);
  const VectorXd weight = innovation_.solve(surprise);
  const VectorXd contradiction = contradiction_of_lessons(total, light.rowwise().sum(), surprise);
  for (Index j = 0; j < columns; ++j) {
    const double gain_variance = prior_gain_sd_[j] * prior_gain_sd_[j];
    const VectorXd with_gain = gain_variance * light.col(j);
    gain_[j] = std::clamp(prior_gain_ + with_gain.dot(weight), gain_min_, gain_max_);
    gain_error_[j] = std::sqrt(std::max(0.0, gain_variance - with_gain.dot(innovation_.solve(with_gain))));
    for (Index i = 0; i < meters; ++i) {
      VectorXd with_factor = with_gain;
      for (Index k = 0; k < count; ++k)
        if (static_cast<Index>(evidence_[static_cast<std::size_t>(k)].luxmeter) == i)
          with_factor[k] += local_variance(i, j) * light(k, j);
      const double factor = prior_gain_ + with_factor.dot(weight);
      factor_(i, j) = std::clamp(factor, gain_min_ / local_, gain_max_ * local_);
      factor_beyond_(i, j) = factor - factor_(i, j);
      const double variance = gain_variance + local_variance(i, j) - with_factor.dot(innovation_.solve(with_factor));
      factor_error_(i, j) = contradiction[i] * std::sqrt(std::max(0.0, variance));
    }
  }
  find_unexplained(local_variance);
  bound_gains();
}

void GainEstimator::find_unexplained(const MatrixXd& local_variance) {
  constexpr double kMuchOfItsLight = 0.3, kErrors = 2;
  for (Index i = 0; i < meter_.rows(); ++i) {
    const Evidence* const lesson = latest(static_cast<std::size_t>(i));
    if (!lesson) continue;
    const RowVectorXd lux = meter_.row(i).cwiseProduct(lesson->level.transpose());
    for (Index j = 0; j < lux.size(); ++j)
      if (lux[j] > kMuchOfItsLight * lux.sum())
        unexplained_[j] = std::max(unexplained_[j], std::abs(factor_(i, j) + factor_beyond_(i, j) - gain_[j]) -
                                                        kErrors * std::sqrt(local_variance(i, j)));
  }
}

Prediction GainEstimator::predict(const Row& row, const VectorXd& level) const {
  Prediction prediction;
  prediction.lux = row.lux_per_level.cwiseProduct(row.factor).dot(level);
  double variance = 0;
  for (Index j = 0; j < level.size(); ++j)
    variance += level[j] * level[j] *
                (row.lux_per_level[j] * row.lux_per_level[j] *
                     (prior_gain_sd_[j] * prior_gain_sd_[j] + prior_local_sd_[j] * prior_local_sd_[j]) +
                 row.standard_error[j] * row.standard_error[j]);
  if (!evidence_.empty()) {
    VectorXd shared(static_cast<Index>(evidence_.size()));
    for (Index k = 0; k < shared.size(); ++k)
      shared[k] = covariance(row, level, evidence_[static_cast<std::size_t>(k)]);
    variance -= shared.dot(innovation_.solve(shared));
  }
  prediction.standard_error_lx = std::sqrt(std::max(0.0, variance));
  return prediction;
}

Prediction GainEstimator::at_point(std::size_t point, std::span<const double> level) const {
  const VectorXd given = as_given(level);
  Prediction prediction = predict(row_of_point(point), given);
  const auto p = static_cast<Index>(point);
  double beyond_lx = 0;
  if (confirmed(point)) {
    const auto i = static_cast<Index>(*meter_of_point_[point]);
    beyond_lx = meter_.row(i).cwiseProduct(factor_beyond_.row(i)).dot(given);
  } else {
    beyond_lx = point_.row(p).cwiseProduct(unexplained_.transpose()).dot(given);
  }
  prediction.standard_error_lx = std::hypot(prediction.standard_error_lx, beyond_lx);
  return prediction;
}

Prediction GainEstimator::at_meter(std::size_t luxmeter, std::span<const double> level) const {
  return predict(row_of_meter(luxmeter), vector_of(level));
}

double GainEstimator::smallest_jump_lx(const Prediction& expected) {
  return std::max({kJump * expected.lux, 4 * expected.standard_error_lx, kDark_lx});
}

Judgement GainEstimator::judge(const LuxReading& reading, std::span<const double> given_level) const {
  const VectorXd level = vector_of(given_level);
  const Luxmeter& luxmeter = luxmeters_.at(reading.luxmeter);
  const Meter& meter = meters_[reading.luxmeter];
  const Row row = row_of_meter(reading.luxmeter);
  Judgement judgement;
  judgement.luxmeter = reading.luxmeter;
  const Prediction expected = predict(row, level);
  judgement.predicted_lx = expected.lux;
  const double low = (row.lux_per_level - 3 * row.standard_error).cwiseMax(0).dot(level) * gain_min_ / local_;
  const double high = (row.lux_per_level + 3 * row.standard_error).dot(level) * gain_max_ * local_;
  judgement.lowest_lx = std::max(0.0, low * (1 - luxmeter.tolerance) - kDark_lx);
  judgement.highest_lx = high * (1 + luxmeter.tolerance) + kDark_lx;

  const auto reject = [&](std::string why) {
    judgement.why = std::move(why);
    return judgement;
  };
  if (!std::isfinite(reading.lux)) return reject("its reading is not a number");
  if (reading.lux < 0) return reject(fmt::format("it reads {:.4g} lx, less than nothing", reading.lux));
  if (reading.lux > luxmeter.range_lx)
    return reject(fmt::format("it reads {:.4g} lx, beyond its range of {:.4g} lx", reading.lux, luxmeter.range_lx));
  if (meter.lux == reading.lux) {
    // Both by the present estimate, since learning between them is not a change of light.
    const double former = predict(row, meter.level).lux;
    const double change = std::abs(expected.lux - former);
    const double visible =
        std::max({kStuckChange * std::max(expected.lux, former), kDark_lx, 3 * luxmeter.patch.lux_per_count});
    judgement.stuck = change > visible || !meter.stuck.empty();
    if (change > visible)
      return reject(fmt::format("it is stuck: still {:.4g} lx while the light there went from {:.4g} to {:.4g} lx",
                                reading.lux, former, expected.lux));
    if (judgement.stuck) return reject(meter.stuck);
  }
  if (reading.lux < judgement.lowest_lx || reading.lux > judgement.highest_lx)
    return reject(
        fmt::format("it reads {:.4g} lx where the model allows {:.4g} to {:.4g} lx: a covered or wrong meter, "
                    "a dead lamp or other light",
                    reading.lux, judgement.lowest_lx, judgement.highest_lx));
  if (latest(reading.luxmeter) != nullptr) {
    // The farther the levels are from those of the last reading, the less certain is a dimmer's true curve.
    double curve_lx = 0;
    const VectorXd& before = latest(reading.luxmeter)->level;
    for (Index j = 0; j < level.size(); ++j)
      if (level[j] > 0)
        curve_lx += row.lux_per_level[j] * row.factor[j] * level[j] * kCurveError *
                    (before[j] > 0 ? std::min(kFarthestStep, std::abs(std::log(level[j] / before[j]))) : kFarthestStep);
    const double allowed = judgement.allowed_lx = std::hypot(smallest_jump_lx(expected), curve_lx);
    if (std::abs(reading.lux - expected.lux) > allowed)
      return reject(fmt::format("it reads {:.4g} lx where {:.4g} ± {:.2g} lx are expected from what it read before",
                                reading.lux, expected.lux, allowed));
  }
  judgement.believed = true;
  return judgement;
}

void GainEstimator::learn(const LuxReading& reading, const VectorXd& level) {
  const auto i = static_cast<Index>(reading.luxmeter);
  const RowVectorXd light = meter_.row(i).cwiseProduct(level.transpose());
  const auto same = [&](const Evidence& e) {
    const RowVectorXd other = meter_.row(i).cwiseProduct(e.level.transpose());
    return e.luxmeter == reading.luxmeter && (other - light).norm() <= kSameLevels * light.norm();
  };
  std::erase_if(evidence_, same);
  const auto of_meter = [&](const Evidence& e) { return e.luxmeter == reading.luxmeter; };
  if (static_cast<std::size_t>(std::count_if(evidence_.begin(), evidence_.end(), of_meter)) >= kMaxEvidence)
    evidence_.erase(std::find_if(evidence_.begin(), evidence_.end(), of_meter));
  evidence_.push_back({reading.luxmeter, reading.lux, reading.taken, level});
}

void GainEstimator::shows(const LuxReading& reading, std::span<const double> level) {
  Meter& meter = meters_.at(reading.luxmeter);
  if (meter.lux == reading.lux) return;
  meter = {reading.lux, reading.taken, vector_of(level), ""};
}

void GainEstimator::doubt_lamps(const Judgement& judgement, bool showed_more, const VectorXd& level) {
  const auto i = static_cast<Index>(judgement.luxmeter);
  for (Index j = 0; j < level.size(); ++j) {
    const double most_more_lx = meter_(i, j) * level[j] * (gain_max_ * local_ - factor_(i, j));
    const bool would_show = most_more_lx > judgement.allowed_lx;
    if (judgement.stuck || (judgement.believed && would_show)) doubted_(i, j) = false;
    if (!judgement.stuck && showed_more && would_show) doubted_(i, j) = true;
  }
}

std::vector<Judgement> GainEstimator::update(Time now, std::span<const LuxReading> readings,
                                             std::span<const double> level) {
  const VectorXd at = vector_of(level);
  std::vector<Judgement> judgements;
  std::vector<const LuxReading*> believed;
  // All are judged by the knowledge before, so that their order does not matter.
  for (const LuxReading& reading : readings) {
    const Judgement& judgement = judgements.emplace_back(judge(reading, level));
    if (judgement.believed) believed.push_back(&reading);
    std::optional<Evidence>& over = over_[judgement.luxmeter];
    const bool more =
        !judgement.believed && reading.lux > judgement.predicted_lx && reading.lux <= judgement.highest_lx;
    if (judgement.stuck)
      over.reset();
    else if (more)
      over = Evidence{reading.luxmeter, reading.lux, reading.taken, at};
    doubt_lamps(judgement, more, at);
  }
  // Values of a stuck meter since it stopped changing cannot be trusted either, nor later ones that happen to match the
  // light at that time.
  for (const Judgement& judgement : judgements) {
    if (!judgement.stuck) continue;
    Meter& meter = meters_[judgement.luxmeter];
    meter.stuck = judgement.why;
    std::erase_if(evidence_,
                  [&](const Evidence& e) { return e.luxmeter == judgement.luxmeter && e.taken >= meter.since; });
  }
  for (const LuxReading* reading : believed)
    // In the dark, only the meter's offset could be learned.
    if (meter_.row(static_cast<Index>(reading->luxmeter)).dot(at) > 2 * kDark_lx) learn(*reading, at);
  estimate(now);
  return judgements;
}

void GainEstimator::set_points(std::span<const Point> points) {
  LUXRIG_CHECK(points.size() == points_.size(), "{} points for {}", points.size(), points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    points_[i].goal_lx = points[i].goal_lx;
    points_[i].weight = points[i].weight;
    points_[i].max_lx = points[i].max_lx;
  }
}

double GainEstimator::lux_per_level(std::size_t point, std::size_t fixture) const {
  const Row row = row_of_point(point);
  const auto j = static_cast<Index>(fixture);
  return row.lux_per_level[j] * row.factor[j];
}

Prediction GainEstimator::lux_per_level_at_meter(std::size_t luxmeter, std::size_t fixture) const {
  const auto i = static_cast<Index>(luxmeter), j = static_cast<Index>(fixture);
  return {meter_(i, j) * factor_(i, j), meter_(i, j) * factor_error_(i, j)};
}

void GainEstimator::forget(std::size_t luxmeter) {
  std::erase_if(evidence_, [&](const Evidence& e) { return e.luxmeter == luxmeter; });
  meters_.at(luxmeter) = Meter{};
  over_.at(luxmeter).reset();
  doubted_.row(static_cast<Index>(luxmeter)).setConstant(false);
  Time newest{};
  for (const Evidence& e : evidence_) newest = std::max(newest, e.taken);
  estimate(newest);
}

}  // namespace luxrig
