#include "core/show/usual_reading.h"

namespace luxrig {
namespace {

/// A change counts from so many standard errors and this share on.
constexpr double kDiffers = 6, kSmallestShare = 0.015, kMayDiffer = 3.5, kMayDifferShare = 0.01;
/// Beside noise: what people, clouds and the last digit do to a reading, as a share.
constexpr double kUnquietShare = 0.0025;
/// Lamps warm up, dust gathers, meters drift: standard deviations, as a share, of what a second adds to the value and
/// to its slope, and of the slope at first.
constexpr double kWalks = 2e-5, kSlopeWalks = 2e-6, kFirstSlope = 1.5e-4;
/// The longest time over which a slope says anything.
constexpr double kSlopeLasts_s = 120;
/// Scatter of a sample before any is known, as a share, and how many samples that counts for.
constexpr double kSupposedNoise = 0.01, kSupposed = 5;
/// A larger difference between two samples, in standard deviations, is a change and no scatter.
constexpr double kMostScatter = 4;
/// The scatter is of about as many samples.
constexpr int kScatterOf = 600;

}  // namespace

double UsualReading::noise_variance() const {
  const double supposed = std::pow(kSupposedNoise * ratio_, 2);
  return (squares_ / 2 + kSupposed * supposed) / (differences_ + kSupposed);
}

double UsualReading::recent(std::size_t samples) const {
  double sum = 0;
  for (std::size_t k = recent_.size() - samples; k < recent_.size(); ++k) sum += recent_[k];
  return sum / static_cast<double>(samples);
}

void UsualReading::hear(double ratio) {
  if (recent_.size() == kLonger) recent_.pop_front();
  recent_.push_back(ratio);
  unlearnt_ = std::min(unlearnt_ + 1, recent_.size());
}

void UsualReading::learn() {
  if (known() && recent_.size() < kRecent) return;
  for (std::size_t k = recent_.size() - unlearnt_; k < recent_.size(); ++k) {
    if (k > 0) scatters(recent_[k] - recent_[k - 1]);
    learn(recent_[k]);
  }
  unlearnt_ = 0;
}

void UsualReading::scatters(double by) {
  if (differences_ == kScatterOf) {
    squares_ /= 2;
    differences_ /= 2;
  }
  const double most = kMostScatter * std::sqrt(2 * noise_variance());
  by = std::clamp(by, -most, most);
  squares_ += by * by;
  ++differences_;
}

void UsualReading::learn(double ratio) {
  if (samples_++ == 0) {
    ratio_ = ratio;
    variance_ = std::pow(0.1 * ratio, 2);
    slope_variance_ = std::pow(kFirstSlope * ratio, 2);
    return;
  }
  const double innovation = ratio - ratio_, all = variance_ + noise_variance();
  const double weight = variance_ / all, slope_weight = covariance_ / all;
  ratio_ += weight * innovation;
  slope_ += slope_weight * innovation;
  slope_variance_ -= slope_weight * covariance_;
  covariance_ *= 1 - weight;
  variance_ *= 1 - weight;
}

void UsualReading::pass(double seconds) {
  if (samples_ == 0) return;
  if (seconds > kSlopeLasts_s) slope_ = 0;
  const double s = std::min(seconds, kSlopeLasts_s);
  ratio_ = std::max(ratio_ / 2, ratio_ + slope_ * s);
  variance_ += 2 * s * covariance_ + s * s * slope_variance_ + s * std::pow(kWalks * ratio_, 2);
  covariance_ += s * slope_variance_;
  slope_variance_ += s * std::pow(kSlopeWalks * ratio_, 2);
}

void UsualReading::doubt(double by) {
  variance_ += by * by;
  forget_recent();
}

void UsualReading::forget_recent() {
  recent_.clear();
  unlearnt_ = 0;
}

bool UsualReading::is_off(std::size_t samples, double errors, double share) const {
  if (!known() || recent_.size() < samples) return false;
  const double error =
      std::sqrt(noise_variance() / static_cast<double>(samples) + variance_ + std::pow(kUnquietShare * ratio_, 2));
  return std::abs(recent(samples) - ratio_) > std::max(errors * error, share * ratio_);
}

bool UsualReading::differs() const {
  return is_off(kRecent, kDiffers, kSmallestShare) || is_off(kLonger, kDiffers, kSmallestShare);
}

bool UsualReading::may_differ() const {
  return is_off(kVeryLast, kMayDiffer, kMayDifferShare) || is_off(1, kMayDiffer, kMayDifferShare);
}

bool UsualReading::differs_from(const MeanReading& mean) const {
  if (mean.samples <= static_cast<int>(kRecent) || recent_.size() < kRecent) return false;
  const double before = mean.mean() * ratio_;
  const double error = std::sqrt(noise_variance() * (1 / static_cast<double>(kRecent) + 1.0 / mean.samples) +
                                 std::pow(kUnquietShare * before, 2));
  return std::abs(recent(kRecent) - before) > std::max(kDiffers * error, kSmallestShare * before);
}

bool UsualReading::is_back_from(const MeanReading& mean, double ratio) const {
  const double half = std::abs(mean.mean() - 1) * ratio_ / 2;
  return kDiffers * std::sqrt(noise_variance()) < half && std::abs(ratio - ratio_) < half;
}

}  // namespace luxrig
