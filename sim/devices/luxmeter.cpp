#include "sim/devices/luxmeter.h"

#include <algorithm>
#include <cmath>

#include "sim/devices/lag.h"
#include "sim/world/random.h"

namespace luxrig::sim {

double LuxmeterDevice::exposed_lx(double true_lx, double tick_s, std::uint64_t tick) const {
  const double hours = static_cast<double>(tick) * tick_s / 3600;
  return true_lx * truth_.gain * (1 + truth_.drift_per_hour * hours);
}

void LuxmeterDevice::rest(double true_lx, double tick_s, std::uint64_t tick) {
  sensor_lx_ = exposed_lx(true_lx, tick_s, tick);
  on_the_way_.clear();
}

void LuxmeterDevice::step(double true_lx, double dt_s, std::uint64_t tick) {
  if (dt_s != left_after_s_) {
    left_after_s_ = dt_s;
    left_ = share_left(dt_s, truth_.lag_s);
  }
  const double exposed = exposed_lx(true_lx, dt_s, tick);
  sensor_lx_ = exposed + (sensor_lx_ - exposed) * left_;
  const auto period = static_cast<std::uint64_t>(std::max(1, truth_.ticks_per_sample));
  if (tick % period == static_cast<std::uint64_t>(truth_.first_tick) % period) {
    const double noisy =
        sensor_lx_ * (1 + truth_.noise * random_normal(truth_.seed, Draw::meter_noise, truth_.index, tick));
    // The counter behind the display is a whole number and cannot pass full scale.
    const double full_scale_counts = std::floor(truth_.range_lx / truth_.lux_per_count);
    const double counts = std::clamp(std::round(noisy / truth_.lux_per_count), 0.0, full_scale_counts);
    on_the_way_.emplace_back(tick + static_cast<std::uint64_t>(truth_.latency_ticks), counts * truth_.lux_per_count);
  }
  while (!on_the_way_.empty() && on_the_way_.front().first <= tick) {
    reading_lx_ = on_the_way_.front().second;
    at_tick_ = tick;
    ++sample_;
    on_the_way_.pop_front();
  }
}

}  // namespace luxrig::sim
