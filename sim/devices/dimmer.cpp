#include "sim/devices/dimmer.h"

#include <algorithm>
#include <cmath>

#include "core/output/dimming.h"
#include "core/output/output_program.h"
#include "sim/devices/lag.h"

namespace luxrig::sim {
namespace {

/// A lamp warms up and ages slowly, so its condition is looked at once a second only.
constexpr double kConditionEvery_s = 1;
/// 95 % of the way in ten minutes.
constexpr double kWarms_s = 200;

}  // namespace

void Dimmer::set_drive(double drive) {
  if (std::isnan(drive)) return;
  drive_ = std::clamp(drive, 0.0, 1.0);
  const double used = truth_.dead_band < 1 ? std::max(0.0, (drive_ - truth_.dead_band) / (1 - truth_.dead_band)) : 0;
  settled_level_ = std::pow(truth_.of_drive ? used : level_from_drive(truth_.nominal, used), truth_.exponent);
  if (settled_level_ > 0) settled_level_ = truth_.tail + (1 - truth_.tail) * settled_level_;
}

void Dimmer::set_out(bool out) { out_ = out; }

void Dimmer::step(double dt_s) {
  if (level_ != settled_level()) {
    level_ = lagged(level_, settled_level(), dt_s, truth_.lag_s);
    // An exponential never arrives. Below a billionth of full light it counts as arrived, so the world can stop
    // computing.
    if (std::abs(level_ - settled_level()) < 1e-9) level_ = settled_level();
  }
  if (truth_.warm_up_share == 0 && truth_.ageing_per_hour == 0) return;
  since_condition_s_ += dt_s;
  if (since_condition_s_ < kConditionEvery_s) return;
  warmth_ = lagged(warmth_, level_, since_condition_s_, kWarms_s);
  hours_ += level_ * since_condition_s_ / 3600;
  condition_ = (1 + truth_.warm_up_share * (1 - warmth_)) * std::exp(-truth_.ageing_per_hour * hours_);
  since_condition_s_ = 0;
}

}  // namespace luxrig::sim
