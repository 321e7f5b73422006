#pragma once
/// The reading of a luxmeter: gain error, first-order lag, noise, saturation and quantisation, in a real sensor's
/// order, sampled a few times a second and held in between.
/// Cosine error is in the light that it is given (World).

#include <cstdint>
#include <deque>
#include <utility>

namespace luxrig::sim {

struct MeterTruth {
  double gain = 1;           ///< reading over true
  double noise = 0;          ///< standard deviation, fraction of reading
  double lag_s = 0;          ///< first-order
  double drift_per_hour = 0;  ///< of the gain
  int latency_ticks = 0;      ///< of the world's 10 ms, from a sample to the reading that shows it
  double range_lx = 200000;  ///< saturates there
  double lux_per_count = 0.001;
  int ticks_per_sample = 20;  ///< of the world's 10 ms: 5 readings a second
  int first_tick = 0;         ///< 0…ticks_per_sample - 1: meters do not sample at the same time
  std::uint64_t seed = 1;
  std::uint64_t index = 0;  ///< of the meter, for its noise
};

class LuxmeterDevice {
 public:
  explicit LuxmeterDevice(const MeterTruth& truth) : truth_(truth) {}

  /// Exposes it to `true_lx` for one step that ends at tick number `tick`.
  void step(double true_lx, double dt_s, std::uint64_t tick);
  /// After a long time under this light, at tick number `tick`. It shows what it showed until its next sample arrives.
  void rest(double true_lx, double tick_s, std::uint64_t tick);

  [[nodiscard]] double reading_lx() const { return reading_lx_; }
  [[nodiscard]] std::uint64_t sample() const { return sample_; }            ///< number of samples so far
  /// Time at which the reading began to show: a meter does not tell its latency.
  [[nodiscard]] std::uint64_t sampled_at_tick() const { return at_tick_; }
  [[nodiscard]] const MeterTruth& truth() const { return truth_; }

 private:
  [[nodiscard]] double exposed_lx(double true_lx, double tick_s, std::uint64_t tick) const;

  MeterTruth truth_;
  double sensor_lx_ = 0, reading_lx_ = 0;
  double left_after_s_ = 0, left_ = 1;  ///< of a difference after one step: every step of a world is as long
  std::uint64_t sample_ = 0, at_tick_ = 0;
  std::deque<std::pair<std::uint64_t, double>> on_the_way_;  ///< tick at which it shows, reading
};

}  // namespace luxrig::sim
