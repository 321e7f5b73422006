#pragma once
/// What a luxmeter usually reads, over what the model states: a mean that follows slow changes, how certain it is, and
/// how much single readings scatter.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>

namespace luxrig {

struct MeanReading {
  double sum = 0;
  int samples = 0;
  void add(double value) {
    sum += value;
    ++samples;
  }
  [[nodiscard]] double mean() const { return samples > 0 ? sum / samples : 0; }
};

/// Samples come about once a second. A Kalman filter of a value and its slope.
class UsualReading {
 public:
  /// So much time has passed: it goes on as it went, and is less certain.
  void pass(double seconds);
  /// Learns the samples heard, as nothing is wrong. Those after a doubt wait until they would show a change.
  void learn();
  /// Levels have changed, and with them the ratio by an unknown amount of this standard error.
  void doubt(double by);
  /// Every sample, usual or not.
  void hear(double ratio);

  [[nodiscard]] bool known() const { return samples_ >= kKnown; }
  [[nodiscard]] double ratio() const { return ratio_; }
  [[nodiscard]] double variance() const { return variance_; }
  /// Of one sample, as a share.
  [[nodiscard]] double noise_share() const { return std::sqrt(noise_variance()) / ratio_; }
  /// The last samples are not as usual.
  [[nodiscard]] bool differs() const;
  /// The very last are not, perhaps.
  [[nodiscard]] bool may_differ() const;
  /// The last samples over what is usual are not as this mean of earlier ones, either.
  [[nodiscard]] bool differs_from(const MeanReading& mean) const;
  /// It read this mean for a while, over what is usual, and this sample is surely nearer to what is usual.
  [[nodiscard]] bool is_back_from(const MeanReading& mean, double ratio) const;
  /// What was heard last is of what is over.
  void forget_recent();

 private:
  /// Samples before it is known, and those over which a change is seen.
  static constexpr int kKnown = 20;
  static constexpr std::size_t kRecent = 5, kLonger = 15, kVeryLast = 3;
  [[nodiscard]] double noise_variance() const;
  [[nodiscard]] double recent(std::size_t samples) const;
  [[nodiscard]] bool is_off(std::size_t samples, double errors, double share) const;

  double ratio_ = 0, slope_ = 0;
  double variance_ = 0, covariance_ = 0, slope_variance_ = 0;
  int samples_ = 0;
  double squares_ = 0;  ///< of differences between neighbouring samples
  int differences_ = 0;
  std::deque<double> recent_;  ///< oldest first
  std::size_t unlearnt_ = 0;   ///< of them, the last
  void learn(double ratio);
  void scatters(double by);
};

}  // namespace luxrig
