#include "sim/devices/dimmer.h"

#include <algorithm>
#include <cmath>

#include "core/output/output_program.h"
#include "sim/devices/lag.h"

namespace luxrig::sim {

void Dimmer::set_drive(double drive) {
  if (std::isnan(drive)) return;
  drive_ = std::clamp(drive, 0.0, 1.0);
  settled_level_ = std::pow(level_from_drive(nominal_, drive_), exponent_);
}

void Dimmer::set_out(bool out) { out_ = out; }

void Dimmer::step(double dt_s) {
  level_ = lagged(level_, settled_level(), dt_s, lag_s_);
  // An exponential never arrives. Below a billionth of full light it counts as arrived, so the world can stop
  // computing.
  if (std::abs(level_ - settled_level()) < 1e-9) level_ = settled_level();
}

}  // namespace luxrig::sim
