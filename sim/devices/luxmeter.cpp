#include "sim/devices/luxmeter.h"

#include <algorithm>
#include <cmath>

#include "sim/devices/lag.h"
#include "sim/world/random.h"

namespace luxrig::sim {

void LuxmeterDevice::step(double true_lx, double dt_s, std::uint64_t tick) {
  sensor_lx_ = lagged(sensor_lx_, true_lx * truth_.gain, dt_s, truth_.lag_s);
  const auto period = static_cast<std::uint64_t>(std::max(1, truth_.ticks_per_sample));
  if (tick % period != static_cast<std::uint64_t>(truth_.first_tick) % period) return;
  const double noisy =
      sensor_lx_ * (1 + truth_.noise * random_normal(truth_.seed, Draw::meter_noise, truth_.index, tick));
  // The counter behind the display is a whole number and cannot pass full scale.
  const double full_scale_counts = std::floor(truth_.range_lx / truth_.lux_per_count);
  const double counts = std::clamp(std::round(noisy / truth_.lux_per_count), 0.0, full_scale_counts);
  reading_lx_ = counts * truth_.lux_per_count;
  at_tick_ = tick;
  ++sample_;
}

}  // namespace luxrig::sim
