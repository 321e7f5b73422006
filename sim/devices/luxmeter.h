#pragma once
/// What a luxmeter shows: gain error, first-order lag, noise, saturation and quantisation, in the order in which
/// a sensor has them, sampled a few times a second and held in between.
/// Not modelled: cosine error (the direction of the light is not known here) and drift.

#include <cstdint>

namespace luxrig::sim {

struct MeterTruth {
  double gain = 1;           ///< shown over true
  double noise = 0;          ///< standard deviation, fraction of reading
  double lag_s = 0;          ///< first-order
  double range_lx = 200000;  ///< saturates there
  double lux_per_count = 0.001;
  int ticks_per_sample = 20;  ///< of the world's 10 ms: 5 readings a second
  int first_tick = 0;         ///< 0…ticks_per_sample - 1: meters do not sample together
  std::uint64_t seed = 1;
  std::uint64_t index = 0;  ///< which meter, for its noise
};

class LuxmeterDevice {
 public:
  explicit LuxmeterDevice(const MeterTruth& truth) : truth_(truth) {}

  /// Lets `true_lx` fall on it for one step that ends at tick number `tick`.
  void step(double true_lx, double dt_s, std::uint64_t tick);

  [[nodiscard]] double reading_lx() const { return reading_lx_; }
  [[nodiscard]] std::uint64_t sample() const { return sample_; }            ///< how many it has taken
  [[nodiscard]] std::uint64_t sampled_at_tick() const { return at_tick_; }  ///< when the reading was taken
  [[nodiscard]] const MeterTruth& truth() const { return truth_; }

 private:
  MeterTruth truth_;
  double sensor_lx_ = 0, reading_lx_ = 0;
  std::uint64_t sample_ = 0, at_tick_ = 0;
};

}  // namespace luxrig::sim
